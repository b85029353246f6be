//! Why a scene cannot be planned or played.

use std::path::PathBuf;

/// An error of planning or playing a scene.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// A surface's asset, or its model, does not do.
    #[error("surface {surface} ({}): {source}", .asset.display())]
    Surface {
        /// Index of the surface.
        surface: usize,
        /// Its asset.
        asset: PathBuf,
        /// What is wrong.
        source: htex_play::Error,
    },
    /// A surface has no representation that can be played here.
    #[error(
        "surface {surface}: none of its representations ({there}) has a model here; \
         `htex plugin list` shows which there are"
    )]
    NoModel {
        /// Index of the surface.
        surface: usize,
        /// The models the asset names.
        there: String,
    },
    /// No representation is near enough.
    #[error(
        "surface {surface}: no representation comes within {wanted_db} dB; the nearest is {model} \
         at {nearest_db:.2} dB: raise budget.max_error_db"
    )]
    NotNearEnough {
        /// Index of the surface.
        surface: usize,
        /// The budget, decibels.
        wanted_db: f64,
        /// The nearest representation.
        model: String,
        /// Its error, decibels.
        nearest_db: f64,
    },
    /// No choice of representations is quick enough.
    #[error(
        "the quickest chain takes {quickest_ns:.1} ns a sample, and the budget is {wanted_ns} ns: \
         raise budget.ns_per_sample, or ask for a lower rate"
    )]
    TooSlow {
        /// The budget, nanoseconds.
        wanted_ns: f64,
        /// What the quickest chain takes, nanoseconds.
        quickest_ns: f64,
    },
    /// The quickest chain within the error budget takes too long.
    #[error(
        "within {wanted_db} dB the quickest chain takes {quickest_ns:.1} ns a sample, and the budget is \
         {wanted_ns} ns: raise one of the two"
    )]
    Budgets {
        /// The error budget, decibels.
        wanted_db: f64,
        /// The time budget, nanoseconds.
        wanted_ns: f64,
        /// What it takes, nanoseconds.
        quickest_ns: f64,
    },
    /// The device does not run at the scene's rate.
    #[error("the device does not run at {rate_hz} Hz; it runs at {rates}")]
    Rate {
        /// The scene's rate, hertz.
        rate_hz: f64,
        /// The device's rates.
        rates: String,
    },
    /// The loudest texture is so far above the level that has the drive that the drive would hold more samples than is
    /// allowed.
    #[error(
        "the loudest texture stands {above_db:.1} dB above the level that has the drive, so that {percent:.0} % of its \
         samples would be held there ({most_percent} % are allowed): raise drive_v, lower the surface's gain, or choose another \
         representation"
    )]
    Clamped {
        /// Of the loudest texture over the reference, decibels.
        above_db: f64,
        /// Part of the samples, percent.
        percent: f64,
        /// What is allowed, percent.
        most_percent: f64,
    },
    /// The device does not take what the assets hold.
    #[error("{sentence}")]
    Quantity {
        /// What to do.
        sentence: String,
    },
    /// An effect that the chain cannot do without is switched off.
    #[error("`{effect}` is off, and without it the scene cannot be played: {reason}")]
    Needed {
        /// The effect.
        effect: String,
        /// Why it is needed.
        reason: String,
    },
    /// The rate of a model cannot be converted to the device's.
    #[error(transparent)]
    Rates(#[from] htex_dsp::resample::UnusableRates),
    /// A motion that is no motion.
    #[error(
        "a motion of {speed_mm_s} mm/s at {force_n} N; both must be finite, and the force not negative"
    )]
    Motion {
        /// Scanning speed, mm/s.
        speed_mm_s: f64,
        /// Normal force, newtons.
        force_n: f64,
    },
}
