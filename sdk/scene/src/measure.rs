//! Measurement of the run times of models and stages on this machine.

use std::collections::BTreeMap;
use std::hint::black_box;
use std::sync::Arc;
use std::time::Instant;

use htex_device::{Capabilities, Quantity, Rates};
use htex_dsp::fir::Fir;
use htex_dsp::resample::UnusableRates;
use htex_host::{Band, FitRequest, HostError, LoadedModel, Registry};
use htex_play::{AtCondition, Condition, Contact, Law, Motions};

use crate::cost::Costs;
use crate::motion::Finger;
use crate::played::PlayedSurface;
use crate::requirements::{Requirements, Span};
use crate::stages::{Context, EFFECTS, Level, Stage, StagePlace, resampling_macs};

const BLOCK: usize = 64;
/// Samples per timed run: short enough that some runs are not interrupted.
const STRETCH: usize = 2_048;
const ROUNDS: usize = 60;

impl Costs {
    /// Measures all models of a registry and all stages; takes about a second.
    ///
    /// # Errors
    /// If a model cannot be fitted or played.
    pub fn measure(models: &Registry, machine: &str) -> Result<Self, HostError> {
        let mut costs = Self {
            machine: machine.to_owned(),
            ..Self::nothing()
        };
        for model in models.models() {
            let (sample_ns, retune_ns) = measure_model(model)?;
            costs.model_ns.insert(model.id().to_owned(), sample_ns);
            costs.retune_ns.insert(model.id().to_owned(), retune_ns);
        }
        costs.mac_ns = mac_ns();
        costs.stage_ns = stages(costs.mac_ns)?;
        Ok(costs)
    }
}

/// Minimum time over many runs, nanoseconds per sample; longer times are caused by interruptions.
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

/// Time per sample at the model's own rate, and time of interpolating parameters and retuning, both in
/// nanoseconds.
fn measure_model(model: &LoadedModel) -> Result<(f64, f64), HostError> {
    let (one, other) = (fitted(model, 200.0)?, fitted(model, 300.0)?);
    let rate_hz = model.voice_rate_hz(&one, Band::TACTILE, 20_000.0)?;
    let mut voice = model.voice(&one, Band::TACTILE, rate_hz, 1)?;
    let mut failed = Ok(());
    let steady = least(|block| failed = voice.render(block));
    failed?;
    let mut failed = Ok(());
    let mut turn = false;
    let retuned = least(|block| {
        turn = !turn;
        let weights = if turn { [0.25, 0.75] } else { [0.75, 0.25] };
        let mixed = model.interpolate(&[&one, &other], &weights);
        failed = mixed
            .and_then(|mixed| voice.retune(&mixed))
            .and_then(|()| voice.render(block));
    });
    failed?;
    Ok((steady, (retuned - steady).max(0.0) * BLOCK as f64))
}

/// Parameters of a noise-like spectrum that falls above `corner_hz`.
fn fitted(model: &LoadedModel, corner_hz: f64) -> Result<Vec<f64>, HostError> {
    let band = Band::TACTILE;
    let grid = band.grid_hz();
    let shape = |f: &f64| (1.2 + libm::sin(f / 17.0)) / (1.0 + (f / corner_hz).powi(2));
    let magnitude: Vec<f64> = grid.iter().map(shape).collect();
    let request = FitRequest {
        band,
        frequency_hz: &grid,
        magnitude: &magnitude,
        signal: &[],
        signal_rate_hz: 20_000.0,
        options: &model.descriptor().default_options(),
    };
    Ok(model.fit(&request)?.parameters)
}

fn mac_ns() -> f64 {
    let taps = 400;
    let mut fir = Fir::with_magnitude(taps, 2_000.0, |hz| 1.0 / (1.0 + hz));
    least(|block| fir.process(block)) / taps as f64
}

/// Time per sample of each stage at its own rate, nanoseconds, without the multiplications of filters.
fn stages(mac_ns: f64) -> Result<BTreeMap<String, f64>, UnusableRates> {
    let (required, played) = (example_required(), example_surface());
    let mut costs = BTreeMap::new();
    let mut note = |name: &str, mut stage: Box<dyn Stage>, macs: f64| {
        let ns = measure_stage(&mut *stage) - macs * mac_ns;
        costs.insert(name.to_owned(), ns.max(0.0));
    };
    note("level", Box::new(Level::new(&played, 0.1)), 0.0);
    for entry in EFFECTS {
        match &entry.place {
            StagePlace::Surface { build: None, .. } => {}
            StagePlace::Surface {
                build: Some(build), ..
            } => note(entry.name, build(&required, &played, false), 0.0),
            StagePlace::Mix { build, .. } => {
                let macs = resampling_macs(&required, &played)?.unwrap_or(0.0);
                note(entry.name, build(&required, &played, false)?, macs);
            }
            StagePlace::Device { build, .. } => note(entry.name, build(&required, false), 0.0),
        }
    }
    Ok(costs)
}

fn measure_stage(stage: &mut dyn Stage) -> f64 {
    let mut at = 0;
    let input: Vec<f32> = (0..4 * BLOCK)
        .map(|n| libm::sinf(n as f32 * 0.7) * 0.1)
        .collect();
    let mut source = move |block: &mut [f32]| {
        for piece in block.chunks_mut(BLOCK) {
            at = (at + BLOCK) % (3 * BLOCK);
            piece.copy_from_slice(&input[at..at + piece.len()]);
        }
    };
    stage.follow(&Context {
        finger: Finger {
            speed_mm_s: 100.0,
            force_n: 0.5,
            at_mm: None,
        },
        level_rms: 0.1,
        ends_in: None,
    });
    let alone = least(&mut source);
    (least(|block| stage.render(block, &mut source)) - alone).max(0.0)
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
        touches: Vec::new(),
    }
}

/// One condition, with the law of a finger.
fn example_motions() -> Motions {
    let condition = Condition {
        speed_mm_s: Some(80.0),
        force_n: Some(0.4),
        ..Condition::default()
    };
    let at = AtCondition {
        condition: 0,
        level_rms: 0.1,
        quality: None,
        left_out: None,
    };
    let law = Law::assumed(htex_format::Quantity::LateralForce, Contact::Finger);
    Motions::new(&[at], &[condition], law)
}

fn example_surface() -> PlayedSurface {
    PlayedSurface {
        surface: 0,
        model: String::new(),
        error_db: 0.0,
        known: 1,
        follows_motion: false,
        motions: Arc::new(example_motions()),
        frequency: Span::ANY,
        level: Span::ANY,
        speed_mm_s: Span::ANY,
        force_n: Span::ANY,
        always_touched: false,
        share: 1.0,
        start: None,
        rate_hz: 2_000.0,
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
