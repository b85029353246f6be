//! Model of skin, rig and sensor: for a motion of the finger, computes the forces that the sensor
//! would measure.

use htex_dsp::biquad::{Biquad, Cascade};
use htex_dsp::normal::Normal;
use htex_dsp::spectrum::Complex;

use super::departures::Departures;
use super::filters::{low_pass, mode};
use super::hand::Finger;
use super::relief::{HALF_READ_MM, Relief};
use super::surface::Parameters;
use super::track::Track;
use htex_recording::SetupResponse;

/// Speed range over which Coulomb friction reverses, mm/s. The fingertip shears before it slides.
const TURN_MM_S: f64 = 5.0;
/// Extra friction near standstill (Stribeck): its fraction of the friction, and the speed over
/// which it decays, mm/s.
const STRIBECK: (f64, f64) = (0.15, 15.0);
/// Low-pass of the skin: frequency in Hz and quality factor, second order.
pub(super) const SKIN: (f64, f64) = (900.0, 0.6);
/// For the direction across the sweep: the fraction of the texture that acts, and the distance
/// ahead of the finger at which the texture is read, mm.
pub(super) const ACROSS: (f64, f64) = (0.25, 7.3);
/// Lateral mode of the rig: frequency in Hz, damping ratio, and the fraction of the force that
/// passes through it. The gain is about 5 dB at the peak and 1 far below it.
const MODE: (f64, f64, f64) = (620.0, 0.08, 0.25);
/// Quality factors of the anti-aliasing filter, a fourth-order Butterworth.
const ANTI_ALIAS: [f64; 2] = [0.541_196_1, 1.306_563];
/// White noise of each force channel at a sample rate of 20 kHz, newtons rms.
const NOISE_N: f64 = 0.2e-3;
/// Step of the converter, newtons: 16 bits over a range of 5 N.
const STEP_N: f64 = 5.0 / 65_536.0;

/// Force on the surface at one sample, newtons.
#[derive(Debug, Clone, Copy)]
pub(super) struct Force {
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) z: f64,
}

/// Contact of skin and relief: the friction of the finger, before the rig filters the force.
pub(super) struct Contact {
    friction: f64,
    material: Material,
    departures: Departures,
    step_s: f64,
    skin: [Cascade; 2],
}

/// The material of the surface, which determines where the texture is read.
pub(super) enum Material {
    /// One piece of material with its relief. The relief is read at the finger's position. If
    /// frequencies do not follow the speed ([`Departures`]), the relief is read along a separate
    /// path instead. The number is the length of this path, mm.
    Piece(Relief, f64),
    /// Endless material with one relief for each lateral axis. The reliefs are read along the
    /// finger's path.
    Endless(Box<[Track; 2]>),
}

impl Material {
    /// Moves the reading point on by `distance` mm, and returns the texture there, across and along
    /// the sweep. `as_it_lies` is true if the texture is read at the finger's own position.
    fn read(&mut self, finger: &Finger, distance: f64, as_it_lies: bool) -> [f64; 2] {
        match self {
            Self::Piece(relief, path) => {
                *path += distance;
                let along_mm = if as_it_lies { finger.along_mm } else { to_and_fro(*path) };
                [ACROSS.1, 0.0].map(|ahead| relief.height_at(along_mm + ahead, finger.across_mm))
            }
            Self::Endless(tracks) => {
                let [across, along] = &mut **tracks;
                [across.advance(distance), along.advance(distance)]
            }
        }
    }
}

/// Converts the length of a path to a position in mm. The path goes back and forth on a piece of
/// material; 0 is the middle.
fn to_and_fro(path_mm: f64) -> f64 {
    let length = 2.0 * HALF_READ_MM;
    let along = path_mm % (2.0 * length);
    along.min(2.0 * length - along) - HALF_READ_MM
}

impl Contact {
    pub(super) fn new(
        parameters: &Parameters,
        rate_hz: f64,
        material: Material,
        departures: Departures,
    ) -> Self {
        let skin = Cascade::new(&[low_pass(SKIN.1, SKIN.0, rate_hz)]);
        Self {
            friction: parameters.friction,
            material,
            departures,
            step_s: 1.0 / rate_hz,
            skin: [skin.clone(), skin],
        }
    }

    /// Computes Coulomb friction against the motion. The texture, multiplied by a factor, modulates
    /// it.
    pub(super) fn tick(&mut self, finger: &Finger, level: f64) -> Force {
        let speed = libm::hypot(finger.along_mm_s, finger.across_mm_s);
        // The sign function would jump at each turn, and the jump would excite all frequencies.
        let sliding = libm::tanh(finger.along_mm_s / TURN_MM_S);
        // At rest the direction of motion is undefined.
        let slope = if speed > 0.0 { finger.across_mm_s / speed } else { 0.0 };
        let slowness = speed / STRIBECK.1;
        let friction = self.friction * (1.0 + STRIBECK.0 * libm::exp(-slowness * slowness));
        let distance = self.departures.pace_mm_s(speed) * self.step_s;
        let as_it_lies = self.departures.frequency_speed == 1.0;
        let texture =
            self.material.read(finger, distance, as_it_lies).map(|x| finger.contact * level * x);
        let along = sliding * finger.normal_n * texture[1];
        let across = sliding * finger.normal_n * ACROSS.0 * texture[0];
        let steady = finger.normal_n * friction;
        Force {
            x: steady * slope * sliding.abs() + self.skin[0].tick(across),
            y: steady * sliding + self.skin[1].tick(along),
            z: finger.normal_n,
        }
    }
}

/// The recording rig: a resonance in both lateral axes, and an anti-aliasing filter for low sample
/// rates.
pub(super) struct Rig {
    /// Filter sections of a lateral axis.
    lateral: Vec<Biquad>,
    x: Cascade,
    y: Cascade,
    z: Cascade,
}

impl Rig {
    /// Creates the rig. `inner_hz` is the sample rate of the physics. `rate_hz` is the sample rate
    /// of the recording, and must not be higher than `inner_hz`.
    pub(super) fn new(inner_hz: f64, rate_hz: f64) -> Self {
        let (hz, damping, share) = MODE;
        let anti_alias: &[f64] = if inner_hz > rate_hz { &ANTI_ALIAS } else { &[] };
        let anti_alias: Vec<Biquad> =
            anti_alias.iter().map(|q| low_pass(*q, 0.4 * rate_hz, inner_hz)).collect();
        let mut lateral = vec![mode(share, damping, hz, inner_hz)];
        lateral.extend(&anti_alias);
        Self {
            x: Cascade::new(&lateral),
            y: Cascade::new(&lateral),
            z: Cascade::new(&anti_alias),
            lateral,
        }
    }

    /// Returns the filters of a lateral axis.
    pub(super) fn lateral(&self) -> &[Biquad] {
        &self.lateral
    }

    pub(super) fn tick(&mut self, force: Force) -> Force {
        Force { x: self.x.tick(force.x), y: self.y.tick(force.y), z: self.z.tick(force.z) }
    }

    /// Returns the rig's response to a lateral force at strictly increasing frequencies in hertz,
    /// for the sample rate with which the rig was created.
    pub(super) fn response(&self, frequency_hz: Vec<f64>, inner_hz: f64) -> SetupResponse {
        let at = |&hz: &f64| -> Complex<f64> {
            let sections = self.lateral.iter();
            sections.map(|section| section.response(hz, inner_hz)).product()
        };
        let values: Vec<Complex<f64>> = frequency_hz.iter().map(at).collect();
        SetupResponse {
            magnitude: values.iter().map(|h| libm::hypot(h.re, h.im)).collect(),
            phase_rad: values.iter().map(|h| libm::atan2(h.im, h.re)).collect(),
            frequency_hz,
        }
    }
}

/// Returns the one-sided power density of noise and quantisation for both lateral axes together,
/// newtons squared per hertz.
pub(super) fn noise_density(rate_hz: f64) -> f64 {
    let noise = NOISE_N * NOISE_N / 20_000.0;
    let quantisation = STEP_N * STEP_N / 12.0 / rate_hz;
    // One-sided instead of two-sided, and for two axes instead of one.
    4.0 * (noise + quantisation)
}

/// Adds the sensor's noise and quantisation to a force.
pub(super) fn sense(force: Force, rate_hz: f64, random: &mut Normal) -> Force {
    // The density stays the same at every rate, as a real sensor's does.
    let noise = NOISE_N * libm::sqrt(rate_hz / 20_000.0);
    let mut read =
        |force: f64| STEP_N * libm::round((force + noise * random.next_normal()) / STEP_N);
    Force { x: read(force.x), y: read(force.y), z: read(force.z) }
}
