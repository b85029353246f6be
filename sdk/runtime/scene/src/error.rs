//! Errors from opening, planning and playing a scene.

use std::io;
use std::path::PathBuf;

use htex_base::finding::Finding;
use htex_format::parse_json;
use htex_format::signing::SignatureError;

use crate::load::Scene;

/// An error from opening, planning or playing a scene. [`Self::kind`] returns the kind of the
/// error, without details.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// The file cannot be read.
    #[error("cannot read {}: {error}", .path.display())]
    Io {
        path: PathBuf,
        #[source]
        error: io::Error,
    },
    /// The scene, or a file that it names, is invalid.
    #[error("invalid scene: {}", htex_base::finding::summary(.findings))]
    Invalid {
        /// All findings, including those that are not errors.
        findings: Vec<Finding>,
    },
    /// An asset is not signed as the program requires ([`crate::Surroundings::signers`]).
    #[error("{}: {}", .asset.display(), htex_format::ReadError::Signature(.error.clone()))]
    Unsigned {
        asset: PathBuf,
        #[source]
        error: SignatureError,
    },
    /// A surface's asset, or its model, cannot be used.
    #[error("surface {surface} ({}): {source}", .asset.display())]
    Surface {
        /// Index of the surface.
        surface: usize,
        asset: PathBuf,
        source: htex_play::Error,
    },
    /// No model is available for any of a surface's representations.
    #[error(
        "surface {surface}: no model of its representations ({there}) is available; \
         `htex plugin list` shows the available ones"
    )]
    NoModel {
        /// Index of the surface.
        surface: usize,
        /// The models that the asset has representations for.
        there: String,
    },
    /// No representation is within the error budget.
    #[error(
        "surface {surface}: no representation comes within {wanted_db} dB; {}", nearest_of(.nearest)
    )]
    NotNearEnough {
        /// Index of the surface.
        surface: usize,
        /// The budget, decibels.
        wanted_db: f64,
        /// The model of the representation with the smallest error, and its largest error over the
        /// conditions, decibels. `None` if the asset states no error by this measure.
        nearest: Option<(String, f64)>,
    },
    /// No choice of representations meets the time budget.
    #[error(
        "the quickest chain takes {quickest_ns:.1} ns a sample, and the budget is {wanted_ns} ns: \
         raise budget.ns_per_sample, or ask for a lower rate"
    )]
    TooSlow {
        /// The budget, nanoseconds.
        wanted_ns: f64,
        /// Time of the fastest chain, nanoseconds.
        quickest_ns: f64,
    },
    /// The fastest chain within the error budget exceeds the time budget.
    #[error(
        "within {wanted_db} dB the quickest chain takes {quickest_ns:.1} ns a sample, and the budget is \
         {wanted_ns} ns: raise one of the two"
    )]
    Budgets {
        /// The error budget, decibels.
        wanted_db: f64,
        /// The time budget, nanoseconds.
        wanted_ns: f64,
        /// Time of the fastest chain within the error budget, nanoseconds.
        quickest_ns: f64,
    },
    /// The device does not support the scene's sample rate.
    #[error("the device does not run at {rate_hz} Hz; it runs at {rates}")]
    Rate {
        /// The scene's rate, hertz.
        rate_hz: f64,
        rates: String,
    },
    /// The loudest texture is so far above the reference level that the drive voltage would clip
    /// more samples than allowed.
    #[error(
        "the loudest texture is {above_db:.1} dB above the reference level of the drive, so that {percent:.0} % of its \
         samples would be clipped ({most_percent} % are allowed): raise drive_v, lower the surface's gain, or choose another \
         representation"
    )]
    Clamped {
        /// Level of the loudest texture relative to the reference level, decibels.
        above_db: f64,
        /// Clipped samples, percent.
        percent: f64,
        /// Maximum allowed, percent.
        most_percent: f64,
    },
    /// The device cannot play the assets' quantity.
    #[error("{sentence}")]
    Quantity {
        /// The problem, and how to correct it.
        sentence: String,
    },
    /// The scene switches off an effect without which it cannot be played.
    #[error("`{effect}` is off, but the scene cannot be played without it: {reason}")]
    Needed {
        effect: String,
        /// Why the scene requires it.
        reason: String,
    },
    /// The model's sample rate cannot be converted to the device's sample rate.
    #[error(transparent)]
    Rates(#[from] htex_dsp::resample::UnusableRates),
    /// The motion is invalid: a number is not finite, or the force is negative.
    #[error(
        "invalid motion: {speed_mm_s} mm/s at {force_n} N; both must be finite, and the force not negative"
    )]
    Motion {
        /// Scanning speed, mm/s.
        speed_mm_s: f64,
        /// Normal force, newtons.
        force_n: f64,
    },
}

fn nearest_of(nearest: &Option<(String, f64)>) -> String {
    match nearest {
        Some((model, db)) => {
            format!("the nearest is {model} at {db:.2} dB: raise budget.max_error_db")
        }
        None => {
            "its asset states no such error: name a representation, or remove budget.max_error_db"
                .to_owned()
        }
    }
}

/// The kind of a [`SceneError`], without details. [`SceneError::kind`] returns it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum SceneErrorKind {
    /// A file cannot be read.
    Io,
    /// The scene is invalid, or cannot be planned for its device, rate or budget.
    InvalidScene,
    /// None of the accepted keys signed a texture.
    Signature,
    /// No model is available for any of a surface's representations.
    NoModel,
    /// A texture or its model failed.
    Model,
    /// The motion is invalid.
    Motion,
}

impl SceneError {
    /// Returns the kind of the error, for programs that react to it.
    pub fn kind(&self) -> SceneErrorKind {
        match self {
            Self::Io { .. } => SceneErrorKind::Io,
            Self::Unsigned { .. } => SceneErrorKind::Signature,
            Self::Surface { .. } => SceneErrorKind::Model,
            Self::NoModel { .. } => SceneErrorKind::NoModel,
            Self::Motion { .. } => SceneErrorKind::Motion,
            Self::Invalid { .. }
            | Self::NotNearEnough { .. }
            | Self::TooSlow { .. }
            | Self::Budgets { .. }
            | Self::Rate { .. }
            | Self::Clamped { .. }
            | Self::Quantity { .. }
            | Self::Needed { .. }
            | Self::Rates(_) => SceneErrorKind::InvalidScene,
        }
    }

    /// Shortens each pointer to a missing key until it refers to a value that exists in the file.
    pub(crate) fn pointing_into(mut self, bytes: &[u8]) -> Self {
        if let (Self::Invalid { findings }, Ok(document)) = (&mut self, parse_json(bytes)) {
            for Finding { pointer, .. } in findings {
                // The empty pointer means the whole document, so this ends.
                while document.pointer(pointer).is_none() {
                    pointer.truncate(pointer.rfind('/').unwrap_or_default());
                }
            }
        }
        self
    }

    /// Returns a function that adds the surface to an error from its asset or its model.
    pub(crate) fn for_surface<E: Into<htex_play::Error>>(
        surface: usize,
        scene: &Scene,
    ) -> impl FnOnce(E) -> Self {
        move |source| Self::Surface {
            surface,
            asset: scene.file.surfaces[surface].asset.clone(),
            source: source.into(),
        }
    }
}
