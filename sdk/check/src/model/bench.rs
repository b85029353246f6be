//! Measures the rendering times of several models in one run.

use std::time::Instant;

use htex_host::{Band, HostError, LoadedModel, ModelVoice};
use serde::Serialize;

use crate::harness::{CheckError, Finding};
use crate::model::case::{Case, RATE_HZ};
use crate::model::start::{Start, start};

/// Block sizes, in samples, for which the benchmark measures times.
pub const BLOCKS: [usize; 4] = [16, 64, 256, 1024];
/// Number of rounds over all models and block sizes. The first is a warm-up and is not counted.
const ROUNDS: usize = 64;
/// Samples rendered per round, model and block size.
const SAMPLES: usize = 8_192;

/// A model to measure, and the way in which it was loaded.
#[derive(Debug, Clone)]
pub struct Subject {
    /// The model's short name. If the benchmark measures several subjects with the same name, it
    /// compares each of them with the first.
    pub model: String,
    /// How the model was loaded.
    pub way: String,
    pub loaded: LoadedModel,
}

/// Minimum, median and spread of the times over the rounds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Timing {
    /// The fastest round, ns. This is the round that other load on the machine disturbed least.
    pub min_ns: f64,
    pub median_ns: f64,
    /// Half the distance between the quartiles, ns.
    pub spread_ns: f64,
}

/// The time per sample in blocks of one size.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct BlockCost {
    /// Samples per block.
    pub block: usize,
    pub per_sample: Timing,
    /// The minimum time divided by the minimum time of the first subject with the same model.
    pub ratio: f64,
}

/// The times of one subject.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Cost {
    pub model: String,
    /// How the model was loaded.
    pub way: String,
    /// The model's origin.
    pub origin: String,
    /// Rate at which the model renders, hertz.
    pub rate_hz: f64,
    /// Times in blocks of [`BLOCKS`].
    pub blocks: Vec<BlockCost>,
    /// Overhead of a call, ns: the minimum time of a call that renders one sample, minus the
    /// minimum time per sample in a large block.
    pub per_call_ns: f64,
    /// Time to the first sample, measured only for WASM modules.
    pub start: Option<Start>,
}

struct Runner {
    voice: ModelVoice,
    rate_hz: f64,
    start: Option<Start>,
    /// Nanoseconds per sample in each round, for each block size and for single samples.
    rounds: [Vec<f64>; 5],
}

/// Measures the models in one run that alternates between them, so that other load on the machine
/// affects all models equally. Each model renders with parameters that were fitted to a reference
/// spectrum.
///
/// # Errors
/// Returns [`CheckError::Model`] when a model cannot be fitted or fails to render.
pub fn bench(subjects: &[Subject]) -> Result<Vec<Cost>, CheckError> {
    let mut runners = Vec::new();
    for subject in subjects {
        let runner =
            Runner::new(&subject.loaded).map_err(|finding| subject.failed(finding.message))?;
        runners.push(runner);
    }
    for _ in 0..ROUNDS {
        for (subject, runner) in subjects.iter().zip(&mut runners) {
            runner.round().map_err(|error| subject.failed(error))?;
        }
    }
    let mut costs: Vec<Cost> = Vec::new();
    for (subject, runner) in subjects.iter().zip(runners) {
        let mut cost = runner.cost(subject);
        if let Some(first) = costs.iter().find(|c| c.model == cost.model) {
            cost.compare(first);
        }
        costs.push(cost);
    }
    Ok(costs)
}

impl Subject {
    fn failed(&self, what: impl std::fmt::Display) -> CheckError {
        CheckError::Model {
            model: self.model.clone(),
            way: self.way.clone(),
            what: what.to_string(),
        }
    }
}

impl Runner {
    fn new(model: &LoadedModel) -> Result<Self, Finding> {
        let case = Case {
            file: Default::default(),
            model: model.clone(),
            seed: 1,
            against: None,
            fuzz: None,
        };
        let parameters = case.parameters()?;
        Ok(Self {
            voice: case.voice(&parameters, case.seed)?,
            rate_hz: model.voice_rate_hz(&parameters, Band::TACTILE, RATE_HZ)?,
            start: start(model, &parameters)?,
            rounds: Default::default(),
        })
    }

    fn round(&mut self) -> Result<(), HostError> {
        let mut out = [0.0; 1024];
        for (block, times) in BLOCKS.into_iter().chain([1]).zip(&mut self.rounds) {
            let start = Instant::now();
            // Every block size divides the number of samples.
            for _ in 0..SAMPLES / block {
                self.voice.render(&mut out[..block])?;
            }
            times.push(start.elapsed().as_secs_f64() * 1e9 / SAMPLES as f64);
        }
        Ok(())
    }

    fn cost(self, subject: &Subject) -> Cost {
        let timings = self.rounds.map(timing);
        let [.., large, single] = timings;
        let block = |(block, per_sample)| BlockCost { block, per_sample, ratio: 1.0 };
        Cost {
            model: subject.model.clone(),
            way: subject.way.clone(),
            origin: subject.loaded.origin().to_string(),
            rate_hz: self.rate_hz,
            blocks: BLOCKS.into_iter().zip(timings).map(block).collect(),
            per_call_ns: single.min_ns - large.min_ns,
            start: self.start,
        }
    }
}

impl Cost {
    fn compare(&mut self, first: &Self) {
        for (own, other) in self.blocks.iter_mut().zip(&first.blocks) {
            own.ratio = own.per_sample.min_ns / other.per_sample.min_ns;
        }
    }
}

fn timing(mut rounds: Vec<f64>) -> Timing {
    let warm = &mut rounds[1..];
    warm.sort_by(f64::total_cmp);
    let at = |share: f64| warm[(share * (warm.len() - 1) as f64) as usize];
    Timing { min_ns: at(0.0), median_ns: at(0.5), spread_ns: 0.5 * (at(0.75) - at(0.25)) }
}
