//! Long runs: hours of a voice.
//!
//! A day of a voice is rendered in blocks. The run measures the power of each hour, and counts
//! samples that are not finite or subnormal and repeated blocks.

mod blocks;
mod phase;
mod power;

pub use blocks::Blocks;
pub use phase::phase_error_cycles;
pub use power::{Power, drift_db};

use htex_host::{Band, LoadedModel, ModelVoice};

use crate::seen::{fit, spectrum};
use crate::signals::friction;

/// Samples rendered at a time.
pub const BLOCK: usize = 4_096;
/// The requested sample rate, hertz. Each voice renders at its own rate, which is lower.
pub(crate) const WANTED_HZ: f64 = 20_000.0;

/// Results of running a voice.
#[derive(Debug, Clone)]
pub struct Run {
    /// The rate the voice renders at, hertz.
    pub rate_hz: f64,
    /// Samples rendered.
    pub samples: u64,
    /// Mean power of each part, such as an hour.
    pub power: Vec<f64>,
    /// Samples that are NaN, infinite or subnormal.
    pub broken: u64,
    /// Blocks of 64 samples that had been rendered before.
    pub repeated: u64,
    /// Nanoseconds per sample in the fastest blocks of the first minute, rendered again, and of the
    /// last minute.
    pub ns_per_sample: (f64, f64),
}

/// Parameters of a model fitted to friction noise.
pub fn parameters(model: &LoadedModel) -> Vec<f64> {
    fit(model, &spectrum(&friction())).unwrap().parameters
}

/// Renders `seconds` of a voice with `seed`, in parts of `part_s` seconds. `blocks` collects the
/// blocks, to find repetitions.
pub fn run(
    model: &LoadedModel,
    seed: u64,
    seconds: f64,
    part_s: f64,
    mut blocks: Option<&mut Blocks>,
) -> Run {
    let parameters = parameters(model);
    let band = Band::TACTILE;
    let rate_hz = model.voice_rate_hz(&parameters, band, WANTED_HZ).unwrap();
    let fresh = || model.voice(&parameters, band, rate_hz, seed).unwrap();
    let mut voice = fresh();
    let samples = (seconds * rate_hz) as u64;
    let mut power = Power::new((part_s * rate_hz) as u64);
    let last_minute = samples.saturating_sub((60.0 * rate_hz) as u64);
    let mut turns = None;
    let mut block = [0.0f32; BLOCK];
    let (mut broken, mut repeated, mut done) = (0, 0, 0);
    while done < samples {
        let out = &mut block[..(samples - done).min(BLOCK as u64) as usize];
        if done < last_minute {
            voice.render(out).unwrap();
        } else {
            turns.get_or_insert_with(|| Turns::new(fresh())).render(&mut voice, out);
        }
        broken += out.iter().filter(|x| !x.is_finite() || x.is_subnormal()).count() as u64;
        power.add(out);
        if let Some(blocks) = &mut blocks {
            repeated += blocks.add(out);
        }
        done += out.len() as u64;
    }
    Run {
        rate_hz,
        samples,
        power: power.parts,
        broken,
        repeated,
        ns_per_sample: turns.map_or((f64::NAN, f64::NAN), |turns| turns.fastest.into()),
    }
}

/// Times the last minute of a voice and the first, which a fresh voice renders again. It takes
/// turns and compares the fastest blocks, because the speed of a processor changes during a day.
struct Turns {
    fresh: ModelVoice,
    block: [f32; BLOCK],
    /// Nanoseconds per sample, of the fresh voice and of the old one.
    fastest: [f64; 2],
}

impl Turns {
    fn new(fresh: ModelVoice) -> Self {
        Self { fresh, block: [0.0; BLOCK], fastest: [f64::INFINITY; 2] }
    }

    fn render(&mut self, old: &mut ModelVoice, out: &mut [f32]) {
        let again = &mut self.block[..out.len()];
        let [young, late] = &mut self.fastest;
        for (voice, out, fastest) in [(&mut self.fresh, again, young), (old, out, late)] {
            let begun = std::time::Instant::now();
            voice.render(out).unwrap();
            let ns = begun.elapsed().as_nanos() as f64 / out.len() as f64;
            *fastest = fastest.min(ns);
        }
    }
}
