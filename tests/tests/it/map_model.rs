//! A model that is a map of a surface. What it plays depends on the place of the finger, also
//! across the direction of its path.

use std::f64::consts::TAU;

use crate::common::scenes;
use htex::{Registry, Texture, VoiceOptions};
use htex_author::by_hand::{ByHand, make};
use htex_host::Band;
use htex_model::{
    Error, Fit, FitInput, Model, Motion, MotionVoice, Numbers, StaticDescriptor, StaticField,
    Values, Voice, mix,
};

const RATE_HZ: f64 = 20_000.0;
const HUM_HZ: f64 = 200.0;
const SPEED_MM_S: f64 = 80.0;
const FORCE_N: f64 = 0.4;
/// Samples between two motions.
const CONTROL: usize = 64;

/// A hum over stripes along x. It is silent at the edges of each stripe, at multiples of `width_mm`
/// across, and has RMS 1 in the middle.
struct Stripes;

struct StripesVoice {
    width_mm: f64,
    step: f64,
    angle: f64,
    gain: f64,
    goal: f64,
}

impl Model for Stripes {
    type Voice = StripesVoice;

    const DESCRIPTOR: StaticDescriptor =
        StaticDescriptor::new("org.example.stripes", "Stripes", "1.0.0", "A hum over stripes.")
            .fields(&[StaticField::scalar("width_mm", "mm", (0.1, 100.0), "Width of a stripe.")]);

    fn fit(_: &FitInput<'_>) -> Result<Fit, Error> {
        Err(Error::cannot_fit("a spectrum has no places"))
    }

    fn magnitude(
        _: &Values<'_>,
        _: Band,
        frequency_hz: &[f64],
        magnitude: &mut [f64],
    ) -> Result<(), Error> {
        for (m, f) in magnitude.iter_mut().zip(frequency_hz) {
            *m = f64::from((f - HUM_HZ).abs() < 1.0);
        }
        Ok(())
    }

    fn interpolate(
        sets: &[Values<'_>],
        weights: &[f64],
        mixed: &mut Numbers<'_>,
    ) -> Result<(), Error> {
        mix::linear(sets, weights, mixed)
    }

    fn voice(
        parameters: &Values<'_>,
        _: Band,
        rate_hz: f64,
        _: u64,
    ) -> Result<StripesVoice, Error> {
        Ok(StripesVoice {
            width_mm: parameters.scalar(0),
            step: TAU * HUM_HZ / rate_hz,
            angle: 0.0,
            gain: 1.0,
            goal: 1.0,
        })
    }
}

impl Voice for StripesVoice {
    fn render(&mut self, out: &mut [f32]) {
        for x in out {
            self.gain += 0.01 * (self.goal - self.gain);
            self.angle += self.step;
            *x = (2.0f64.sqrt() * self.gain * self.angle.sin()) as f32;
        }
    }

    fn retune(&mut self, parameters: &Values<'_>) -> Result<(), Error> {
        self.width_mm = parameters.scalar(0);
        Ok(())
    }
}

impl MotionVoice for StripesVoice {
    fn set_motion(&mut self, motion: Motion) {
        self.goal = (TAU / 2.0 * motion.y_mm / self.width_mm).sin().abs();
    }
}

/// Stripes 4 mm wide with 0.1 N.
fn stripes() -> Texture {
    let mut registry = Registry::builtin();
    registry.add_motion_model::<Stripes>().unwrap();
    let texture = ByHand::new("Stripes", 0.1, "test").with("width_mm", [4.0]);
    let model = registry.find("stripes").unwrap().clone();
    Texture::with_registry(make(&model, &texture).unwrap(), registry)
}

/// A second of a voice whose finger moves along x at a distance across, if its place is known.
fn played(y_mm: Option<f64>) -> Vec<f32> {
    let options = VoiceOptions::default().with_rate_hz(RATE_HZ);
    let mut voice = stripes().voice(&options).unwrap();
    let mut out = vec![0.0; RATE_HZ as usize];
    for (i, block) in out.chunks_mut(CONTROL).enumerate() {
        let x_mm = SPEED_MM_S * (i * CONTROL) as f64 / RATE_HZ;
        let motion = htex::Motion::new(SPEED_MM_S, FORCE_N).with_position_mm(x_mm);
        let motion = y_mm.map_or(motion, |y_mm| motion.with_place_mm([x_mm, y_mm]));
        voice.set_motion(motion).unwrap();
        voice.render(block).unwrap();
    }
    out
}

fn rendered(y_mm: f64) -> Vec<f32> {
    let scene = scenes::traced(&stripes(), scenes::trace(1.0, FORCE_N, |t| [SPEED_MM_S * t, y_mm]));
    scenes::rendered(&scene, &scenes::planned(&scene, RATE_HZ))
}

/// RMS in the middle, after all fades.
fn rms(samples: &[f32]) -> f64 {
    let middle = &samples[samples.len() / 4..samples.len() / 2];
    let power: f64 = middle.iter().map(|x| f64::from(*x).powi(2)).sum();
    (power / middle.len() as f64).sqrt()
}

/// Paths with the same x: over the middle of a stripe, over the edge between two, and a sixth of
/// the width from an edge.
#[test]
fn two_paths_beside_each_other_differ() {
    type Path = fn(f64) -> Vec<f32>;
    let through: [(&str, Path); 2] = [("voice", |y| played(Some(y))), ("scene", rendered)];
    for (name, path) in through {
        let [middle, edge, between, next] = [2.0, 4.0, 2.0 / 3.0, -2.0].map(|y| rms(&path(y)));
        println!("{name}: {middle} N in the middle, {edge} N at the edge, {between} N between");
        assert!((middle - 0.1).abs() < 2e-3, "{name}: {middle}");
        assert!(edge < 1e-4, "{name}: {edge}");
        assert!((between / middle - 0.5).abs() < 0.01, "{name}: {between}");
        assert!((next / middle - 1.0).abs() < 1e-3, "{name}: {next}");
    }
}

/// A path whose place is unknown goes along x at 0.
#[test]
fn an_unknown_place_lies_on_the_x_axis() {
    assert_eq!(played(None), played(Some(0.0)));
    assert!(rms(&played(None)) < 1e-4);
}
