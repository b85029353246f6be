//! Files of other formats as recordings, and as assets.
//!
//! None of them knows newtons, a speed or a force: a signal within ±1 becomes a recording by the full scale that is given, at the condition that is
//! given. A signal that is shorter than some seconds is repeated, since a texture lasts.

use htex_author::settings::{FitSettings, Metadata, ReadingSettings, SettingsError};
use htex_author::{Averaging, Exploration, FittedAsset, Recording, SegmentChoice, Take, fit_asset};
use htex_format::Quantity;

use crate::error::{ExchangeError, Missing};
use crate::formats::{Context, Format};
use crate::profile::Profile;

/// Rate of signals, hertz.
pub const RATE_HZ: f64 = 8_000.0;
/// A signal is repeated until it is this long, seconds.
const LEAST_S: f64 = 4.0;

/// What a format does not say.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Physical {
    /// The quantity's unit at ±1: newtons of a lateral force.
    pub full_scale: Option<f64>,
    pub quantity: Quantity,
    /// Speed of the finger, mm/s.
    pub speed_mm_s: Option<f64>,
    /// Its normal force, newtons.
    pub force_n: Option<f64>,
}

const FULL_SCALE: Missing = Missing {
    setting: "full_scale",
    words: "how strong 1 is",
};
const SPEED: Missing = Missing {
    setting: "speed",
    words: "at which speed it is felt",
};
const FORCE: Missing = Missing {
    setting: "force",
    words: "at which force",
};

/// Reads a file as a recording; `file` is its name, by whose extension the format is found. Frequencies that are positions in an actuator's range
/// are those of the profile, else of the format's own.
///
/// # Errors
/// When no format has the extension, something that it does not say is not given, or the file is not what it says; with the place.
///
/// ```
/// use htex_exchange::{Physical, recording_of};
/// let file = br#"{"version": {"major": 1}, "signals": {"continuous": {"envelopes": {
///     "amplitude": [{"time": 0, "amplitude": 0.5}, {"time": 1, "amplitude": 0.5}]}}}}"#;
/// let error = recording_of("buzz.haptic", file, &Physical::default(), None).unwrap_err();
/// assert!(error.to_string().contains("`full_scale`"));
/// let physical = Physical { full_scale: Some(0.2), speed_mm_s: Some(80.0), force_n: Some(0.5), ..Physical::default() };
/// assert_eq!(recording_of("buzz.haptic", file, &physical, None)?.rate_hz, 8000.0);
/// # Ok::<(), htex_exchange::ExchangeError>(())
/// ```
pub fn recording_of(
    file: &str,
    bytes: &[u8],
    physical: &Physical,
    profile: Option<&Profile>,
) -> Result<Recording, ExchangeError> {
    let format = Format::of_file(file)?;
    let in_file = |fault| ExchangeError::File {
        file: file.to_owned(),
        fault,
    };
    let Some(reads) = format.reads else {
        return Err(in_file(crate::Fault::whole("it is not read")));
    };
    let (full_scale, speed_mm_s) = physical.checked(format)?;
    let profile = match profile {
        Some(profile) => profile,
        None => Profile::find(format.profile)?,
    };
    let context = Context {
        profile,
        rate_hz: RATE_HZ,
        speed_mm_s,
    };
    let signal = reads(bytes, &context).map_err(in_file)?;
    let mut samples: Vec<f64> = signal.samples.iter().map(|x| full_scale * x).collect();
    let mut warnings = signal.left_out;
    if !samples.iter().any(|x| *x != 0.0) {
        return Err(in_file(crate::Fault::whole(
            "it is silent, and nothing can be fitted to it",
        )));
    }
    let least = (LEAST_S * RATE_HZ) as usize;
    if samples.len() < least {
        let times = least.div_ceil(samples.len().max(1));
        warnings.push(format!(
            "Its {:.3} s are repeated {times} times.",
            samples.len() as f64 / RATE_HZ
        ));
        samples = samples.repeat(times);
    }
    let mut recording = Recording::of(physical.quantity, file, RATE_HZ, vec![samples])?;
    recording.blake3 = Some(blake3::hash(bytes).to_hex().to_string());
    recording.warnings = warnings.into_iter().map(Into::into).collect();
    Ok(recording)
}

impl Physical {
    /// Returns full scale and speed.
    fn checked(&self, format: &Format) -> Result<(f64, f64), ExchangeError> {
        let all = [
            (FULL_SCALE, self.full_scale),
            (SPEED, self.speed_mm_s),
            (FORCE, self.force_n),
        ];
        let missing: Vec<Missing> = all
            .iter()
            .filter(|(_, given)| given.is_none())
            .map(|(missing, _)| *missing)
            .collect();
        let (Some(full_scale), Some(speed_mm_s), Some(_)) =
            (self.full_scale, self.speed_mm_s, self.force_n)
        else {
            return Err(ExchangeError::Missing {
                format: format.title,
                missing,
            });
        };
        let refuse = |name, value, range| Err(ExchangeError::OutOfRange { name, value, range });
        if !(full_scale > 0.0 && full_scale <= 1e6) {
            return refuse("full_scale", full_scale, "more than 0, at most 1e6");
        }
        if !(speed_mm_s > 0.0 && speed_mm_s <= Exploration::MOST_SPEED_MM_S) {
            return refuse("speed", speed_mm_s, "more than 0 mm/s, at most 10,000 mm/s");
        }
        Ok((full_scale, speed_mm_s))
    }
}

/// How an imported recording is fitted.
#[derive(Debug, Clone, Default)]
pub struct Fitting {
    pub settings: FitSettings,
    pub metadata: Metadata,
    /// Program and version, for the provenance.
    pub tool: String,
}

/// Fits an asset to a recording of [`recording_of`]; `name` is the asset's.
///
/// # Errors
/// When a setting is not known, the metadata are not valid, or no model can be fitted.
pub fn imported_asset(
    recording: Recording,
    physical: &Physical,
    name: &str,
    fitting: &Fitting,
    registry: &htex_play::Registry,
) -> Result<FittedAsset, ImportError> {
    let reading = ReadingSettings::default();
    let mut request = fitting
        .settings
        .request(registry, &reading, name, &fitting.tool)?;
    request.spectrum = request
        .spectrum
        .with_segments(SegmentChoice::Windows)
        .with_averaging(Averaging::Rms);
    if let Some(full_scale) = physical.full_scale {
        request
            .recorded_options
            .insert("full-scale".to_owned(), full_scale.to_string());
    }
    let given = Exploration {
        speed_mm_s: physical.speed_mm_s,
        force_n: physical.force_n,
    };
    let mut fitted = fit_asset(&[Take { recording, given }], &request)?;
    fitting.metadata.apply(&mut fitted.asset.manifest);
    Ok(fitted)
}

/// Why nothing was fitted.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ImportError {
    #[error(transparent)]
    Settings(#[from] SettingsError),
    #[error(transparent)]
    Author(#[from] htex_author::AuthorError),
}
