//! What models cost, measured side by side.

use std::time::Instant;

use htex_host::{Band, HostError, LoadedModel, ModelVoice};
use serde::Serialize;

use crate::case::{Case, RATE_HZ};
use crate::finding::Finding;

/// Block sizes that are timed, samples.
pub const BLOCKS: [usize; 4] = [16, 64, 256, 1024];
/// Rounds of all models and block sizes; the first warms up and is left out.
const ROUNDS: usize = 32;
/// Samples rendered a round, model and block size.
const SAMPLES: usize = 8_192;
/// Calls timed a round for the cost of a call.
const CALLS: usize = 2_000;

/// Median and spread of the rounds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Timing {
    /// Median, ns.
    pub median_ns: f64,
    /// Half the distance between the quartiles, ns.
    pub spread_ns: f64,
}

/// What one model costs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Cost {
    /// What was asked for: an id or a file.
    pub model: String,
    /// Rate at which the model renders, hertz.
    pub rate_hz: f64,
    /// Cost of a sample in blocks of [`BLOCKS`].
    pub per_sample: [Timing; 4],
    /// Cost of a call that renders one sample: an empty one need not reach the model.
    pub per_call: Timing,
}

struct Runner {
    voice: ModelVoice,
    rate_hz: f64,
    /// Nanoseconds of each round: a sample in each block size, and a call.
    rounds: [Vec<f64>; 5],
}

/// Times models in one interleaved run, so that what else the machine does falls on all alike. Each
/// plays parameters fitted to a reference spectrum.
///
/// # Errors
/// When a model cannot be fitted or fails to render.
pub fn bench(models: &[(String, LoadedModel)]) -> Result<Vec<Cost>, String> {
    let mut runners = Vec::new();
    for (name, model) in models {
        let runner =
            Runner::new(model).map_err(|finding| format!("{name}: {}", finding.message))?;
        runners.push(runner);
    }
    for _ in 0..ROUNDS {
        for ((name, _), runner) in models.iter().zip(&mut runners) {
            runner.round().map_err(|error| format!("{name}: {error}"))?;
        }
    }
    let named = models.iter().zip(runners);
    Ok(named.map(|((name, _), runner)| runner.cost(name)).collect())
}

impl Runner {
    fn new(model: &LoadedModel) -> Result<Self, Finding> {
        let case = Case {
            file: Default::default(),
            model: model.clone(),
            seed: 1,
            against: None,
        };
        let parameters = case.parameters()?;
        Ok(Self {
            voice: case.voice(&parameters, case.seed)?,
            rate_hz: model.voice_rate_hz(&parameters, Band::TACTILE, RATE_HZ)?,
            rounds: Default::default(),
        })
    }

    fn round(&mut self) -> Result<(), HostError> {
        let mut out = [0.0; 1024];
        for (block, times) in BLOCKS.into_iter().zip(&mut self.rounds) {
            let start = Instant::now();
            for _ in 0..SAMPLES / block {
                self.voice.render(&mut out[..block])?;
            }
            times.push(start.elapsed().as_secs_f64() * 1e9 / SAMPLES as f64);
        }
        let start = Instant::now();
        for _ in 0..CALLS {
            self.voice.render(&mut out[..1])?;
        }
        self.rounds[4].push(start.elapsed().as_secs_f64() * 1e9 / CALLS as f64);
        Ok(())
    }

    fn cost(self, name: &str) -> Cost {
        let [a, b, c, d, call] = self.rounds.map(timing);
        Cost {
            model: name.to_owned(),
            rate_hz: self.rate_hz,
            per_sample: [a, b, c, d],
            per_call: call,
        }
    }
}

fn timing(mut rounds: Vec<f64>) -> Timing {
    let warm = &mut rounds[1..];
    warm.sort_by(f64::total_cmp);
    let at = |share: f64| warm[(share * (warm.len() - 1) as f64) as usize];
    Timing {
        median_ns: at(0.5),
        spread_ns: 0.5 * (at(0.75) - at(0.25)),
    }
}
