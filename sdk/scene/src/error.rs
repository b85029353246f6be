//! Errors from planning and playing a scene.

use std::path::PathBuf;

use crate::load::LoadedScene;

/// An error from planning or playing a scene.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// A surface's asset, or its model, cannot be used.
    #[error("surface {surface} ({}): {source}", .asset.display())]
    Surface {
        /// Index of the surface.
        surface: usize,
        asset: PathBuf,
        source: htex_play::Error,
    },
    /// No model of a surface's representations is available.
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
        /// The representation with the smallest error, and its largest error over the conditions,
        /// decibels. `None` if the asset states no error by this measure.
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
    /// The loudest texture exceeds the reference level so much that the drive voltage would clip
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
    /// The scene switches off an effect that it requires.
    #[error("`{effect}` is off, but the scene cannot be played without it: {reason}")]
    Needed {
        effect: String,
        /// Why the scene requires it.
        reason: String,
    },
    /// The model's sample rate cannot be converted to the device's.
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

impl SceneError {
    /// Adds the surface to an error from its asset or its model.
    pub(crate) fn of_surface<E: Into<htex_play::Error>>(
        surface: usize,
        scene: &LoadedScene,
    ) -> impl FnOnce(E) -> Self {
        move |source| Self::Surface {
            surface,
            asset: scene.scene.surfaces[surface].asset.clone(),
            source: source.into(),
        }
    }
}
