//! The model under test, and operations that several checks share.

use std::path::{Path, PathBuf};
use std::time::Duration;

use htex_host::{Band, FitCondition, FitInput, HostError, LoadedModel, Status, Stream, WasmLimits};
use htex_model::Fit;

use crate::harness::Finding;
use crate::model::spectra::{REFERENCES, Reference};

/// Rate at which sounds are checked, hertz. It is the rate of the recordings.
pub(crate) const RATE_HZ: f64 = 20_000.0;

/// Total time that a WASM module may take in one check. It is long, because a check does far more
/// than a player does, and the runner ends a check that takes too long.
const MODULE_TOTAL: Duration = Duration::from_secs(600);

/// Returns the limits of WASM modules. They are the same as in a player, except for the total time.
fn limits() -> WasmLimits {
    let limits = WasmLimits::default();
    let all = limits.all.with_time(MODULE_TOTAL);
    limits.with_all(all).with_guards(true)
}

/// A loaded model and the checker's settings.
pub struct Case {
    pub(crate) file: PathBuf,
    pub(crate) model: LoadedModel,
    pub(crate) seed: u64,
    pub(crate) against: Option<PathBuf>,
    /// Duration of the check `fuzz`. If `None`, the check plays a fixed number of sequences.
    pub(crate) fuzz: Option<Duration>,
}

/// Settings of the checks.
#[derive(Debug, Clone, Copy, Default)]
pub struct Settings<'a> {
    /// Seed of the voices and of all random choices.
    pub seed: u64,
    /// The same model as a file of the other kind (native library or WASM module).
    pub against: Option<&'a Path>,
    /// Duration of the check `fuzz`. If `None`, the check runs a fixed number of random sequences
    /// of calls.
    pub fuzz: Option<Duration>,
}

/// Parameters fitted to a reference spectrum.
pub(crate) struct Fitted {
    pub(crate) reference: &'static str,
    pub(crate) parameters: Vec<f64>,
}

/// Two parameter sets.
pub(crate) type Pair = (Vec<f64>, Vec<f64>);

impl Case {
    pub(crate) fn load(file: &Path, settings: Settings<'_>) -> Result<Self, HostError> {
        Ok(Self {
            file: file.to_owned(),
            model: LoadedModel::from_file_within(file, &limits())?,
            seed: settings.seed,
            against: settings.against.map(Path::to_owned),
            fuzz: settings.fuzz,
        })
    }

    /// Fits a spectrum on the tactile grid, with default options.
    pub(crate) fn fit(&self, magnitude: &[f64]) -> Result<Fit, HostError> {
        self.fit_in(Band::TACTILE, &Band::TACTILE.grid_hz(), magnitude)
    }

    /// Fits a spectrum on another frequency grid.
    pub(crate) fn fit_in(&self, band: Band, grid: &[f64], m: &[f64]) -> Result<Fit, HostError> {
        self.fit_any((band, grid), (m, &[]), FitCondition::default())
    }

    /// Fits a reference spectrum of a recording at a motion.
    pub(crate) fn fit_at(
        &self,
        reference: &Reference,
        condition: FitCondition,
    ) -> Result<Fit, HostError> {
        let grid = Band::TACTILE.grid_hz();
        let spectrum: Vec<f64> = grid.iter().map(|&hz| (reference.curve)(hz)).collect();
        self.fit_any((Band::TACTILE, &grid), (&spectrum, &[]), condition)
    }

    /// Fits a reference spectrum together with its signal at [`RATE_HZ`].
    pub(crate) fn fit_signal(
        &self,
        reference: &Reference,
        signal: &[f64],
        condition: FitCondition,
    ) -> Result<Fit, HostError> {
        let grid = Band::TACTILE.grid_hz();
        let spectrum: Vec<f64> = grid.iter().map(|&hz| (reference.curve)(hz)).collect();
        self.fit_any((Band::TACTILE, &grid), (&spectrum, signal), condition)
    }

    fn fit_any(
        &self,
        (band, frequency_hz): (Band, &[f64]),
        (magnitude, signal): (&[f64], &[f64]),
        condition: FitCondition,
    ) -> Result<Fit, HostError> {
        let request = FitInput {
            band,
            frequency_hz,
            magnitude,
            signal,
            signal_rate_hz: RATE_HZ,
            options: &self.model.descriptor().default_options(),
            condition,
        };
        self.model.fit(&request)
    }

    /// Returns parameters for every reference spectrum that the model can describe; at least one.
    pub(crate) fn fitted(&self) -> Result<Vec<Fitted>, Finding> {
        let mut fitted = Vec::new();
        for Reference { name, curve } in REFERENCES {
            let spectrum: Vec<f64> = Band::TACTILE.grid_hz().into_iter().map(curve).collect();
            match self.fit(&spectrum) {
                Ok(fit) => fitted.push(Fitted { reference: name, parameters: fit.parameters }),
                Err(error) if is_cannot_fit(&error) => {}
                Err(error) => return Err(Finding::failed(format!("spectrum `{name}`: {error}"))),
            }
        }
        if fitted.is_empty() {
            return Err(Finding::failed("the model cannot be fitted to any reference spectrum"));
        }
        Ok(fitted)
    }

    /// Returns parameters for the first reference spectrum that can be fitted.
    pub(crate) fn parameters(&self) -> Result<Vec<f64>, Finding> {
        let first = self.fitted()?.into_iter().next();
        first
            .map(|fitted| fitted.parameters)
            .ok_or_else(|| Finding::failed("there are no parameters"))
    }

    /// Returns two different parameter sets, or `None` if all fits returned the same set.
    pub(crate) fn two_sets(&self) -> Result<Option<Pair>, Finding> {
        let mut fitted = self.fitted()?.into_iter().map(|f| f.parameters);
        let Some(first) = fitted.next() else {
            return Ok(None);
        };
        let other = fitted.find(|set| *set != first);
        Ok(other.map(|other| (first, other)))
    }

    /// Creates a stream at [`RATE_HZ`].
    pub(crate) fn stream(&self, parameters: &[f64], seed: u64) -> Result<Stream, HostError> {
        Stream::new(&self.model, parameters, Band::TACTILE, RATE_HZ, seed)
    }

    /// Renders samples of a new voice at the model's own rate, in blocks.
    pub(crate) fn samples(
        &self,
        parameters: &[f64],
        seed: u64,
        len: usize,
        block: usize,
    ) -> Result<Vec<f32>, HostError> {
        let mut voice = self.voice(parameters, seed)?;
        let mut out = vec![0.0; len];
        for part in out.chunks_mut(block) {
            voice.render(part)?;
        }
        Ok(out)
    }

    /// Creates a voice at the rate that the model returns for [`RATE_HZ`].
    pub(crate) fn voice(
        &self,
        parameters: &[f64],
        seed: u64,
    ) -> Result<htex_host::ModelVoice, HostError> {
        let band = Band::TACTILE;
        let rate_hz = self.model.voice_rate_hz(parameters, band, RATE_HZ)?;
        self.model.voice(parameters, band, rate_hz, seed)
    }

    /// Returns the magnitude on the tactile grid.
    pub(crate) fn magnitude(&self, parameters: &[f64]) -> Result<Vec<f64>, HostError> {
        let grid = Band::TACTILE.grid_hz();
        self.model.magnitude(parameters, Band::TACTILE, &grid)
    }
}

/// Returns whether an error states that the model cannot be fitted to this spectrum.
pub(crate) fn is_cannot_fit(error: &HostError) -> bool {
    matches!(error, HostError::Call { status: Status::CannotFit, .. })
}

/// Returns whether an error means that the model refused a call. Statuses of a failed model or of a
/// trapped WASM module are no refusals.
pub(crate) fn is_refusal(error: &HostError) -> bool {
    matches!(error, HostError::Call { status, .. } if !matches!(status, Status::Panicked | Status::Failed))
}
