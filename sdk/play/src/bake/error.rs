//! Errors of baking.

#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BakeError {
    /// The asset cannot be played.
    #[error(transparent)]
    Asset(#[from] crate::Error),
    /// The model returned an error.
    #[error(transparent)]
    Model(#[from] htex_host::HostError),
    /// An axis of the grid is invalid.
    #[error(
        "{axis} of the grid: {values:?}; they are 1 to {most} different numbers, each from {least} to {largest}"
    )]
    Axis { axis: &'static str, values: Vec<f64>, most: usize, least: f64, largest: f64 },
    /// The conditions are not all combinations of their speeds and forces.
    #[error(
        "no condition at {speed_mm_s} mm/s and {force_n} N: the conditions are all combinations of their speeds and \
         forces; add it, or give a grid"
    )]
    Incomplete {
        /// The speed of the missing condition.
        speed_mm_s: f64,
        /// The force of the missing condition.
        force_n: f64,
    },
    /// The rate is out of range.
    #[error(
        "{rate_hz} Hz: the rate is from {least_hz} to {most_hz} Hz for frequencies up to {top_hz} Hz"
    )]
    Rate {
        rate_hz: f64,
        least_hz: f64,
        most_hz: f64,
        /// The highest frequency of the texture.
        top_hz: f64,
    },
    /// The model follows the motion itself, which a block cannot do.
    #[error(
        "the model {model} follows the position of the finger itself; bake another representation"
    )]
    FollowsMotion { model: String },
    /// There are too many sinusoids.
    #[error(
        "the conditions have {count} sinusoids together, and a block at most {most}; bake fewer conditions"
    )]
    Tones { count: usize, most: usize },
    /// The representation has no energy at a condition.
    #[error("the texture is silent at {speed_mm_s} mm/s and {force_n} N; bake other conditions")]
    Silent { speed_mm_s: f64, force_n: f64 },
    /// The level cannot be stored.
    #[error(
        "the level at {speed_mm_s} mm/s and {force_n} N is {level}; a block stores at most {most}"
    )]
    Level {
        speed_mm_s: f64,
        force_n: f64,
        /// The level, in the asset's unit.
        level: f64,
        most: f64,
    },
    /// The player refused the block.
    #[error("the player refuses the block: {0}")]
    Refused(#[from] htex_player::OpenError),
}
