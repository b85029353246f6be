//! Measures the run times of models and stages on this machine.

use std::collections::BTreeMap;
use std::hint::black_box;
use std::sync::Arc;
use std::time::Instant;

use htex_device::{Capabilities, Quantity, Rates};
use htex_dsp::fir::Fir;
use htex_dsp::resample::{Part, Resampler, UnusableRates};
use htex_format::{AtCondition, Condition, Contact, Fluctuation, Law};
use htex_host::{Band, FitCondition, FitInput, HostError, LoadedModel, Registry};
use htex_play::{Conditions, Motion};

use crate::cost::{Costs, FilterCost};
use crate::played::PlayedSurface;
use crate::render::Renderer;
use crate::requirements::{Requirements, Span};
use crate::stages::{Context, EFFECTS, Level, Stage, StagePlace};

const BLOCK: usize = 64;
/// Number of samples in one timed run. A run is so short that some runs are not interrupted.
const STRETCH: usize = 2_048;
const ROUNDS: usize = 400;
/// Number of samples that a resampler requests at a time, at the models' rates.
const PULLED: usize = 8;
/// Number of requested blocks in a control block.
const CONTROL: usize = 2;
/// Number of coefficients of the two filters that are measured.
const SHORT: usize = 201;
const LONG: usize = 801;
/// Single-stage converters with few and with many coefficients: input rate, output rate and highest
/// frequency, hertz.
const WHOLE: [[f64; 3]; 2] = [[4_000.0, 20_000.0, 1_000.0], [2_000.0, 6_000.0, 1_000.0]];
const RATIONAL: [[f64; 3]; 2] = [[4_000.0, 44_100.0, 1_000.0], [2_000.0, 2_500.0, 1_000.0]];

impl Costs {
    /// Measures all models in a registry and all stages. Takes about a second.
    ///
    /// # Errors
    /// Returns an error if a model cannot be fitted or played.
    pub fn measure(models: &Registry, machine: &str) -> Result<Self, HostError> {
        let mut costs = Self { machine: machine.to_owned(), ..Self::nothing() };
        for model in models.models() {
            let (sample_ns, retune_ns) = measure_model(model)?;
            costs.model_ns.insert(model.id().to_owned(), sample_ns);
            costs.retune_ns.insert(model.id().to_owned(), retune_ns);
        }
        costs.renderer_ns = [true, false].map(|constant| {
            let mut renderer = Renderer::silent(&example_required(), constant);
            least(|block| {
                // It has no model that could fail.
                let _ = renderer.render(block);
            })
        });
        costs.compensation = compensation();
        costs.whole = conversion(WHOLE)?;
        costs.rational = conversion(RATIONAL)?;
        (costs.stage_ns, costs.neutral_ns) = stages()?;
        Ok(costs)
    }
}

/// Returns the minimum time over many runs, nanoseconds per sample. The minimum is used because
/// interruptions lengthen the other runs.
fn least(mut run: impl FnMut(&mut [f32])) -> f64 {
    let mut block = [0.0f32; BLOCK];
    let mut stretch = || {
        let start = Instant::now();
        for _ in 0..STRETCH / BLOCK {
            run(black_box(&mut block));
        }
        start.elapsed().as_nanos() as f64 / STRETCH as f64
    };
    (0..ROUNDS).map(|_| stretch()).fold(f64::INFINITY, f64::min)
}

/// Returns the time per sample at the model's own rate, and the time to interpolate parameters and
/// retune, both in nanoseconds.
fn measure_model(model: &LoadedModel) -> Result<(f64, f64), HostError> {
    let (one, other) = (fitted(model, 200.0)?, fitted(model, 300.0)?);
    let rate_hz = model.voice_rate_hz(&one, Band::TACTILE, 20_000.0)?;
    let mut voice = model.voice(&one, Band::TACTILE, rate_hz, 1)?;
    let mut failed = Ok(());
    let steady = least(|block| {
        let pulls = block.chunks_mut(PULLED).map(|block| voice.render(block));
        failed = pulls.fold(Ok(()), Result::and);
    });
    failed?;
    let mut failed = Ok(());
    let mut turn = false;
    let retuned = least(|block| {
        turn = !turn;
        let weights = if turn { [0.25, 0.75] } else { [0.75, 0.25] };
        let mixed = model.interpolate(&[&one, &other], &weights);
        let pulls = block.chunks_mut(PULLED);
        failed = mixed
            .and_then(|mixed| voice.retune(&mixed))
            .and_then(|()| pulls.map(|block| voice.render(block)).fold(Ok(()), Result::and));
    });
    failed?;
    // `least` returns the time per sample, and each block was retuned once.
    Ok((steady, (retuned - steady).max(0.0) * BLOCK as f64))
}

/// Returns parameters for a noise-like spectrum that falls above `corner_hz`.
fn fitted(model: &LoadedModel, corner_hz: f64) -> Result<Vec<f64>, HostError> {
    let band = Band::TACTILE;
    let grid = band.grid_hz();
    let shape = |f: &f64| (1.2 + libm::sin(f / 17.0)) / (1.0 + (f / corner_hz).powi(2));
    let magnitude: Vec<f64> = grid.iter().map(shape).collect();
    let request = FitInput {
        band,
        frequency_hz: &grid,
        magnitude: &magnitude,
        signal: &[],
        signal_rate_hz: 20_000.0,
        options: &model.descriptor().default_options(),
        condition: FitCondition::default(),
    };
    Ok(model.fit(&request)?.parameters)
}

/// Derives the cost of a filter from the work and the time of a short and a long filter.
fn filter_cost([(few, short_ns), (many, long_ns)]: [(Part, f64); 2]) -> FilterCost {
    let per_sample = |part: Part| part.macs / part.samples;
    let [short_ns, long_ns] = [short_ns / few.samples, long_ns / many.samples];
    let mac_ns = (long_ns - short_ns).max(0.0) / (per_sample(many) - per_sample(few));
    FilterCost { sample_ns: (short_ns - per_sample(few) * mac_ns).max(0.0), mac_ns }
}

/// Measures filters of two lengths, in blocks as short as a resampler requests them.
fn compensation() -> FilterCost {
    let source_ns = least(signal());
    filter_cost([SHORT, LONG].map(|taps| {
        let mut fir = Fir::with_magnitude(taps, 2_000.0, |hz| 1.0 / (1.0 + hz));
        let mut source = signal();
        let ns = least(|block| {
            source(block);
            block.chunks_mut(PULLED).for_each(|block| fir.process(block));
        });
        let (samples, macs) = (1.0, taps as f64);
        (Part { samples, macs }, ns - source_ns)
    }))
}

/// Measures two single-stage converters: input rate, output rate and highest frequency, hertz.
fn conversion(rates_hz: [[f64; 3]; 2]) -> Result<FilterCost, UnusableRates> {
    let one = |[from_hz, to_hz, top_hz]: [f64; 3]| {
        let work = Resampler::work(from_hz, to_hz, top_hz, false)?.unwrap_or_default();
        let mut source = signal();
        let source_ns = least(&mut source) * from_hz / to_hz;
        let ns = match Resampler::new(from_hz, to_hz, top_hz)? {
            Some(mut resampler) => least(|block| resampler.process(block, &mut source)),
            None => source_ns,
        };
        let part = if work.whole.samples > 0.0 { work.whole } else { work.rational };
        Ok((part, ns - source_ns))
    };
    let [short, long] = rates_hz.map(one);
    Ok(filter_cost([short?, long?]))
}

/// Time of each stage.
type Times = BTreeMap<String, f64>;

/// Returns the time per sample of each stage except filters, at the stage's own rate, nanoseconds.
/// The first map holds the times where a stage is needed, the second where it changes nothing.
fn stages() -> Result<(Times, Times), UnusableRates> {
    let (required, played) = (example_required(), example_surface());
    let (mut needed, mut neutral) = (BTreeMap::new(), BTreeMap::new());
    let level = measure_stage(&mut Level::new(&played, 0.1), PULLED, false);
    needed.insert("level".to_owned(), level);
    for entry in EFFECTS {
        for (costs, is_neutral) in [(&mut needed, false), (&mut neutral, true)] {
            // A resampler requests short blocks from the stages before it.
            let (mut stage, block) = match &entry.place {
                StagePlace::Surface { build: None, .. } => continue,
                StagePlace::Surface { build: Some(build), .. } => {
                    (build(&required, &played, is_neutral), PULLED)
                }
                StagePlace::Mix { .. } if !is_neutral => continue,
                StagePlace::Mix { build, .. } => (build(&required, &played, true)?, PULLED),
                StagePlace::Device { build, .. } => (build(&required, is_neutral), BLOCK),
            };
            costs.insert(entry.name.to_owned(), measure_stage(&mut *stage, block, !is_neutral));
        }
    }
    Ok((needed, neutral))
}

/// A source of samples.
fn signal() -> impl FnMut(&mut [f32]) {
    let mut at = 0;
    let input: Vec<f32> = (0..4 * BLOCK).map(|n| libm::sinf(n as f32 * 0.7) * 0.1).collect();
    move |block: &mut [f32]| {
        for piece in block.chunks_mut(BLOCK) {
            at = (at + BLOCK) % (3 * BLOCK);
            piece.copy_from_slice(&input[at..at + piece.len()]);
        }
    }
}

/// Returns the time per sample of a stage that renders blocks of `pulled` samples. If `moves`, the
/// motion changes at every control block. A control block has the length of two such blocks.
fn measure_stage(stage: &mut dyn Stage, pulled: usize, moves: bool) -> f64 {
    let mut source = signal();
    let context = |turn: bool| Context {
        finger: if turn { Motion::new(100.0, 0.5) } else { Motion::new(110.0, 0.55) },
        level_rms: 0.1,
        ends_in: None,
    };
    stage.follow(&context(true));
    let alone = least(|block| block.chunks_mut(pulled).for_each(&mut source));
    let mut turn = false;
    let both = least(|block| {
        for control in block.chunks_mut(CONTROL * pulled) {
            if moves {
                turn = !turn;
                stage.follow(&context(turn));
            }
            let pulls = control.chunks_mut(pulled);
            pulls.for_each(|block| stage.render(block, &mut source));
        }
    });
    (both - alone).max(0.0)
}

/// A scene on an electrovibration display, in which every stage is active.
fn example_required() -> Requirements {
    Requirements {
        device: Capabilities {
            quantity: Quantity::DisplayVoltage,
            rates: Rates::List(vec![20_000.0]),
            default_rate_hz: 20_000.0,
            limit: Some(150.0),
            step: Some(0.015),
            carrier_hz: Some(7_000.0),
            paced: true,
            block_frames: 256,
        },
        rate_hz: 20_000.0,
        control: BLOCK,
        frames: None,
        live: true,
        turns_round: true,
        breaks_contact: true,
        quantity: htex_format::Quantity::LateralForce,
        quantity_gain: 1.0,
        level_rms: 0.1,
        drive_v: 100.0,
        gain_db: 0.0,
        level_dbfs: -18.0,
        pitch: 1.0,
        seed: 0,
        compensation: None,
        fluctuation: true,
        touches: Vec::new(),
    }
}

/// Returns a single condition with the scaling law assumed for a finger.
fn example_conditions() -> Conditions {
    let condition =
        Condition { speed_mm_s: Some(80.0), force_n: Some(0.4), ..Condition::default() };
    let at = AtCondition { condition: 0, level_rms: 0.1, quality: None, left_out: None };
    let law = Law::assumed(htex_format::Quantity::LateralForce, Contact::Finger);
    Conditions::new(&[at], &[condition], law)
}

fn example_surface() -> PlayedSurface {
    PlayedSurface {
        surface: 0,
        model: String::new(),
        error_db: None,
        largest_error_db: None,
        known: 1,
        follows_motion: false,
        fluctuation: Fluctuation::from_db([4.0, 3.0]),
        conditions: Arc::new(example_conditions()),
        frequency: Span::ANY,
        level: Span::ANY,
        speed_mm_s: Span::ANY,
        force_n: Span::ANY,
        always_touched: false,
        share: 1.0,
        start: None,
        rate_hz: 2_000.0,
        own_rate: false,
        oversampling: 2.0,
        mix_rate_hz: 4_000.0,
        voice_top_hz: 1_000.0,
        top_hz: 2_000.0,
        fixed_ratio: 1.0,
        fixed_gain: 1.0,
        gain: 1.0,
        level_rms: 0.1,
    }
}
