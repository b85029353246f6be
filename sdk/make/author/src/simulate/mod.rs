//! Simulated recordings of a finger sliding over one of five surfaces, in sweeps or free strokes.
//!
//! Use them for tests, examples and first steps without a recording rig. For five surfaces, the
//! paper's Results state which surfaces are stronger, and at which frequencies their energy lies.
//! The five simulated surfaces agree with this description. The simulation does not use
//! measurements of real surfaces. Every simulated file states that it is simulated.
//!
//! The hand's speed and force vary. A fixed relief gives the friction coefficient at each position
//! along the surface. The simulation reads the relief at the finger's position. Therefore the
//! frequencies of the spectrum are proportional to the speed, and the level of the spectrum is
//! proportional to the force. [`Departures`] can change both. The friction force then passes
//! through models of skin, rig and sensor.
//!
//! ```
//! use htex_author::simulate::{SimulationOptions, Surface, simulate};
//!
//! let options = SimulationOptions::new(Surface::Vinyl).with_duration_s(1.0);
//! let simulation = simulate(&options)?;
//! let mut csv = Vec::new();
//! simulation.write_csv(&mut csv)?;
//! assert!(csv.starts_with(b"# simulated recording"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod contact;
mod departures;
mod filters;
mod free;
mod hand;
mod relief;
mod surface;
mod track;
mod truth;
mod write;

use htex_dsp::grid::{Band, GRID_HZ};
use htex_dsp::normal::Normal;

pub use departures::Departures;
pub use surface::Surface;
pub use truth::Truth;

use crate::AuthorError;
use contact::{Contact, Force, Material, Rig, sense};
use departures::Course;
use free::FreeHand;
use hand::{Finger, Hand};
use htex_recording::SetupResponse;
use htex_recording::speed_mm_s;
use htex_recording::{Recording, RecordingError};
use relief::Relief;
use track::Track;
use write::{FORCE_DECIMALS, POSITION_DECIMALS, rounded};

/// Lowest sample rate of the physics, Hz.
const INNER_HZ: f64 = 20_000.0;
/// Largest number of samples in a simulation.
const MAX_SAMPLES: f64 = 2e7;

/// The motion of the simulated hand.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub enum Motion {
    /// Back-and-forth sweeps at one speed and one force, over one piece of the material.
    #[default]
    Sweeps,
    /// Strokes of random speed and force, over endless material.
    Free(FreeMotion),
}

/// A free motion: strokes of 0.6 to 1.6 s in both directions. Each stroke has its own mean speed
/// and force. Within a stroke, the speed and the force change slowly by up to 10 %. The logarithms
/// of speed and force are evenly distributed over their ranges.
///
/// The finger is always on material that it has not touched before, and the strength of contact
/// does not vary. The spectrum of a steady part is therefore a known function of speed and force:
/// see [`SimulationOptions::truth`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct FreeMotion {
    /// Lowest and highest speed in mm/s, within 1 to 500 mm/s.
    pub speed_mm_s: [f64; 2],
    /// Lowest and highest normal force in newtons, within 0.01 to 10 N.
    pub force_n: [f64; 2],
}

impl FreeMotion {
    /// Sets the lowest and highest speed, mm/s.
    #[must_use]
    pub const fn with_speed_mm_s(self, speed_mm_s: [f64; 2]) -> Self {
        Self { speed_mm_s, ..self }
    }

    /// Sets the lowest and highest normal force, newtons.
    #[must_use]
    pub const fn with_force_n(self, force_n: [f64; 2]) -> Self {
        Self { force_n, ..self }
    }
}

impl Default for FreeMotion {
    /// The ranges of a recording of a freely stroking bare finger: 36 to 280 mm/s, 0.15 to 3.8 N.
    fn default() -> Self {
        Self { speed_mm_s: [36.0, 280.0], force_n: [0.15, 3.8] }
    }
}

#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct SimulationOptions {
    pub surface: Surface,
    /// Random seed. Equal options with an equal seed give equal samples. A different seed simulates
    /// a different piece of the same material and a different motion of the hand.
    pub seed: u64,
    /// Sample rate, 200 to 200 000 Hz.
    pub rate_hz: f64,
    /// Duration, 0.1 to 600 s.
    pub duration_s: f64,
    /// Sliding speed between the turns, 1 to 500 mm/s.
    pub speed_mm_s: f64,
    /// Normal force, 0.01 to 10 N.
    pub force_n: f64,
    /// The kind of motion. A free motion has its own ranges of speed and force, which replace
    /// `speed_mm_s` and `force_n`.
    pub motion: Motion,
    /// How the surface and the hand differ from the ideal case: a rigid relief and a steady hand.
    pub departures: Departures,
}

impl SimulationOptions {
    /// Returns options for the paper's recording condition (80 mm/s, 0.4 N), with a duration of 10
    /// s, a sample rate of 20 kHz and the seed 1.
    #[must_use]
    pub fn new(surface: Surface) -> Self {
        Self {
            surface,
            seed: 1,
            rate_hz: 20_000.0,
            duration_s: 10.0,
            speed_mm_s: 80.0,
            force_n: 0.4,
            motion: Motion::Sweeps,
            departures: Departures::default(),
        }
    }

    #[must_use]
    pub fn with_seed(mut self, seed: u64) -> Self {
        self.seed = seed;
        self
    }

    #[must_use]
    pub fn with_rate_hz(mut self, rate_hz: f64) -> Self {
        self.rate_hz = rate_hz;
        self
    }

    #[must_use]
    pub fn with_duration_s(mut self, duration_s: f64) -> Self {
        self.duration_s = duration_s;
        self
    }

    /// Sets the sliding speed between the turns, mm/s.
    #[must_use]
    pub fn with_speed_mm_s(mut self, speed_mm_s: f64) -> Self {
        self.speed_mm_s = speed_mm_s;
        self
    }

    #[must_use]
    pub fn with_force_n(mut self, force_n: f64) -> Self {
        self.force_n = force_n;
        self
    }

    /// Selects a free motion instead of sweeps.
    #[must_use]
    pub fn with_free_motion(mut self, free: FreeMotion) -> Self {
        self.motion = Motion::Free(free);
        self
    }

    /// Sets how the surface and the hand differ from the ideal case: a rigid relief and a steady
    /// hand.
    #[must_use]
    pub fn with_departures(mut self, departures: Departures) -> Self {
        self.departures = departures;
        self
    }

    /// Returns the simulated rig's response to a lateral force: a resonance at 620 Hz and, for
    /// sample rates below 20 kHz, an anti-aliasing filter. The response has a value every 5 Hz from
    /// 0 to 1000 Hz, or to half the sample rate if that is less. Dividing the spectrum of a
    /// recording by this response gives the spectrum of the force at the finger.
    ///
    /// # Errors
    /// Returns an error if an option is out of range.
    ///
    /// ```
    /// use htex_author::simulate::{SimulationOptions, Surface};
    ///
    /// let response = SimulationOptions::new(Surface::Vinyl).setup_response()?;
    /// assert_eq!(response.frequency_hz[0], 0.0);
    /// assert!((response.magnitude[0] - 1.0).abs() < 1e-9);
    /// assert!((response.magnitude[124] - 1.73).abs() < 0.01, "at 620 Hz");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn setup_response(&self) -> Result<SetupResponse, AuthorError> {
        self.check()?;
        let top_hz = Band::TACTILE.high_hz.min(0.5 * self.rate_hz);
        let bins = (top_hz / GRID_HZ) as usize;
        let frequency_hz = (0..=bins).map(|bin| bin as f64 * GRID_HZ).collect();
        let rig = Rig::new(self.inner_hz(), self.rate_hz);
        Ok(rig.response(frequency_hz, self.inner_hz()))
    }

    /// Returns the number of physics steps per sample.
    fn inner_steps(&self) -> usize {
        libm::ceil(INNER_HZ / self.rate_hz) as usize
    }

    /// Returns the sample rate of the physics, hertz.
    fn inner_hz(&self) -> f64 {
        self.rate_hz * self.inner_steps() as f64
    }

    fn check(&self) -> Result<(), AuthorError> {
        let ranges = [
            ("rate_hz", self.rate_hz, 200.0, 200_000.0),
            ("duration_s", self.duration_s, 0.1, 600.0),
            ("speed_mm_s", self.speed_mm_s, 1.0, 500.0),
            ("force_n", self.force_n, 0.01, 10.0),
            ("rate_hz x duration_s", self.rate_hz * self.duration_s, 2.0, MAX_SAMPLES),
        ];
        for (option, value, low, high) in ranges {
            check_range(option, value, low, high)?;
        }
        self.departures.check()?;
        match &self.motion {
            Motion::Sweeps => Ok(()),
            Motion::Free(free) => free.check(),
        }
    }

    /// Creates the hand, at the sample rate of the physics.
    fn hand(&self, random: Normal) -> AnyHand {
        let rate_hz = self.inner_hz();
        match self.motion {
            Motion::Sweeps => {
                let hand = Hand::new(self.speed_mm_s, self.force_n, rate_hz, random);
                AnyHand::Sweeping(Box::new(hand))
            }
            Motion::Free(free) => {
                let hand = FreeHand::new(free.speed_mm_s, free.force_n, rate_hz, random);
                AnyHand::Free(Box::new(hand))
            }
        }
    }

    /// Creates the material; `stream` returns the random numbers for a part of it.
    fn material(&self, stream: impl Fn(u64) -> Normal) -> Material {
        let parameters = self.surface.parameters();
        match self.motion {
            Motion::Sweeps => Material::Piece(Relief::new(parameters, &mut stream(1)), 0.0),
            Motion::Free(_) => {
                // The second track must not repeat the first one, so it draws from a stream of its
                // own.
                let tracks = [1, 3].map(|part| Track::new(parameters, stream(part)));
                Material::Endless(Box::new(tracks))
            }
        }
    }
}

impl FreeMotion {
    fn check(&self) -> Result<(), AuthorError> {
        let [slowest, fastest] = self.speed_mm_s;
        let [lightest, firmest] = self.force_n;
        check_range("lowest speed_mm_s", slowest, 1.0, 500.0)?;
        check_range("highest speed_mm_s", fastest, slowest, 500.0)?;
        check_range("lowest force_n", lightest, 0.01, 10.0)?;
        check_range("highest force_n", firmest, lightest, 10.0)
    }
}

enum AnyHand {
    Sweeping(Box<Hand>),
    Free(Box<FreeHand>),
}

impl AnyHand {
    fn tick(&mut self) -> Finger {
        match self {
            Self::Sweeping(hand) => hand.tick(),
            Self::Free(hand) => hand.tick(),
        }
    }
}

fn check_range(option: &'static str, value: f64, low: f64, high: f64) -> Result<(), AuthorError> {
    if (low..=high).contains(&value) {
        return Ok(());
    }
    Err(AuthorError::SimulationRange { option, value, low, high })
}

/// A simulated recording; all signals have the same length.
#[derive(Debug, Clone, PartialEq)]
pub struct Simulation {
    pub options: SimulationOptions,
    /// Time, seconds, starting at 0.
    pub t_s: Vec<f64>,
    /// Force across the sweeps, newtons.
    pub fx_n: Vec<f64>,
    /// Force along the sweeps, newtons.
    pub fy_n: Vec<f64>,
    /// Normal force, newtons; positive when pressing.
    pub fz_n: Vec<f64>,
    /// Finger position across the sweeps, mm; 0 is the middle.
    pub x_mm: Vec<f64>,
    /// Finger position along the sweeps, mm; 0 is the middle.
    pub y_mm: Vec<f64>,
    /// Sample rate, hertz.
    pub rate_hz: f64,
}

impl Simulation {
    fn new(options: &SimulationOptions, samples: usize) -> Self {
        let signal = || Vec::with_capacity(samples);
        Self {
            options: options.clone(),
            t_s: signal(),
            fx_n: signal(),
            fy_n: signal(),
            fz_n: signal(),
            x_mm: signal(),
            y_mm: signal(),
            rate_hz: options.rate_hz,
        }
    }

    fn push(&mut self, force: Force, finger: &Finger) {
        self.t_s.push(self.t_s.len() as f64 / self.rate_hz);
        // Rounded here in the same way as in the written file, so that the simulation and the file
        // give the same recording.
        self.fx_n.push(rounded(force.x, FORCE_DECIMALS));
        self.fy_n.push(rounded(force.y, FORCE_DECIMALS));
        self.fz_n.push(rounded(force.z, FORCE_DECIMALS));
        self.x_mm.push(rounded(finger.across_mm, POSITION_DECIMALS));
        self.y_mm.push(rounded(finger.along_mm, POSITION_DECIMALS));
    }

    /// Converts the simulation to a recording. Reading the CSV that [`Self::write_csv`] writes
    /// gives an equal recording. `source` is the file name.
    ///
    /// # Errors
    /// Returns no error if the simulation comes from [`simulate`].
    pub fn to_recording(&self, source: &str) -> Result<Recording, RecordingError> {
        let lateral = vec![self.fx_n.clone(), self.fy_n.clone()];
        let speed = speed_mm_s(&[&self.x_mm, &self.y_mm], self.rate_hz);
        let mut recording = Recording::new(source, self.rate_hz, lateral)?
            .with_normal(self.fz_n.clone())?
            .with_speed(speed)?;
        recording.simulated = true;
        Ok(recording)
    }
}

/// Simulates a recording. Equal options give equal samples on every machine.
///
/// # Errors
/// Returns an error if an option is out of range.
pub fn simulate(options: &SimulationOptions) -> Result<Simulation, AuthorError> {
    options.check()?;
    let parameters = options.surface.parameters();
    let samples = libm::round(options.rate_hz * options.duration_s) as usize;
    let (inner_steps, inner_hz) = (options.inner_steps(), options.inner_hz());
    // Each part draws from its own stream. So if an option makes one part draw more numbers, the
    // other parts do not change.
    let stream = |part: u64| stream(options.seed, 16 * parameters.label + part);
    let mut hand = options.hand(stream(0));
    let material = options.material(stream);
    let mut contact = Contact::new(parameters, inner_hz, material, options.departures);
    let mut course = Course::new(options.departures, inner_hz, stream(4));
    let mut rig = Rig::new(inner_hz, options.rate_hz);
    let mut noise = stream(2);
    let mut simulation = Simulation::new(options, samples);
    for step in 0..samples * inner_steps {
        let mut finger = hand.tick();
        // Called after the hand and before the contact, because a lift changes the force from which
        // the contact is computed.
        let level = course.tick(&mut finger);
        let force = rig.tick(contact.tick(&finger, level));
        // The rig's anti-aliasing filter ran at the inner rate, so the samples in between may be
        // dropped.
        if step % inner_steps == 0 {
            simulation.push(sense(force, options.rate_hz, &mut noise), &finger);
        }
    }
    Ok(simulation)
}

/// Returns a stream of random numbers. Streams with the same seed and different labels are
/// independent.
fn stream(seed: u64, label: u64) -> Normal {
    // Multiplying by an odd factor spreads small labels over all bits. The generator mixes further
    // when it is seeded.
    Normal::new(seed ^ label.wrapping_mul(0x9E37_79B9_7F4A_7C15))
}
