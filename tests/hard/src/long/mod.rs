//! Long runs: what a voice does in hours.
//!
//! A day of a voice is rendered in blocks, and everything asked of it is counted on the way: power by
//! the hour, samples that are not finite or subnormal, blocks that were there before.

mod blocks;
mod phase;
mod power;

pub use blocks::Blocks;
pub use phase::phase_error_cycles;
pub use power::{Power, drift_db};

use htex_host::{Band, LoadedModel};

use crate::seen::{fit, spectrum};
use crate::signals::friction;

/// Samples rendered at a time.
pub const BLOCK: usize = 4_096;
/// The rate at which voices are wanted, hertz; each renders at its own, which is lower.
pub const WANTED_HZ: f64 = 20_000.0;

/// What was found in a run of a voice.
#[derive(Debug, Clone)]
pub struct Run {
    /// The rate the voice renders at, hertz.
    pub rate_hz: f64,
    /// Samples rendered.
    pub samples: u64,
    /// Mean power of each hour, or whatever part was asked for.
    pub power: Vec<f64>,
    /// Samples that are NaN, infinite or subnormal.
    pub broken: u64,
    /// Blocks of 64 samples that had been rendered before.
    pub repeated: u64,
    /// Nanoseconds a sample in the fastest blocks of the first and of the last minute.
    pub ns_per_sample: (f64, f64),
}

/// Parameters of a model fitted to friction noise.
pub fn parameters(model: &LoadedModel) -> Vec<f64> {
    fit(model, &spectrum(&friction())).unwrap().parameters
}

/// Renders `seconds` of a voice of `seed`, in parts of `part_s` seconds. `blocks` remembers what was
/// rendered, if repetitions are looked for.
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
    let mut voice = model.voice(&parameters, band, rate_hz, seed).unwrap();
    let samples = (seconds * rate_hz) as u64;
    let mut power = Power::new((part_s * rate_hz) as u64);
    let mut clock = Clock::new(rate_hz, samples);
    let mut block = [0.0f32; BLOCK];
    let (mut broken, mut repeated, mut done) = (0, 0, 0);
    while done < samples {
        let out = &mut block[..(samples - done).min(BLOCK as u64) as usize];
        clock.before(done);
        voice.render(out).unwrap();
        clock.after(done, out.len());
        broken += out
            .iter()
            .filter(|x| !x.is_finite() || x.is_subnormal())
            .count() as u64;
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
        ns_per_sample: clock.ns_per_sample(),
    }
}

/// Times the first minute and the last, by their fastest blocks: others may want the processor too.
struct Clock {
    minute: u64,
    samples: u64,
    start: Option<std::time::Instant>,
    /// Nanoseconds a sample of the fastest block of both.
    fastest: [f64; 2],
}

impl Clock {
    fn new(rate_hz: f64, samples: u64) -> Self {
        Self {
            minute: (60.0 * rate_hz) as u64,
            samples,
            start: None,
            fastest: [f64::INFINITY; 2],
        }
    }

    /// Which of the two a block belongs to.
    fn which(&self, done: u64) -> Option<usize> {
        match done {
            _ if done < self.minute => Some(0),
            _ if done + self.minute >= self.samples => Some(1),
            _ => None,
        }
    }

    fn before(&mut self, done: u64) {
        self.start = self.which(done).map(|_| std::time::Instant::now());
    }

    fn after(&mut self, done: u64, samples: usize) {
        if let (Some(start), Some(which)) = (self.start, self.which(done)) {
            let ns = start.elapsed().as_nanos() as f64 / samples as f64;
            self.fastest[which] = self.fastest[which].min(ns);
        }
    }

    fn ns_per_sample(&self) -> (f64, f64) {
        (self.fastest[0], self.fastest[1])
    }
}
