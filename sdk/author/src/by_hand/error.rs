//! Errors of making textures without recordings.

use htex_host::HostError;

/// Why a texture cannot be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ByHandError {
    /// The model has no such field.
    #[error("{model} has no parameter {name:?}; it has {there}")]
    Unknown {
        model: String,
        name: String,
        /// Its fields, with units and ranges.
        there: String,
    },
    /// A field has no value.
    #[error("{model} needs a value for {missing}")]
    Missing {
        model: String,
        /// The fields, with units and ranges.
        missing: String,
    },
    /// A value is out of its field's range, or there are too many.
    #[error("{name} = {value}: {problem}")]
    Value {
        name: String,
        value: String,
        /// What is allowed.
        problem: String,
    },
    /// The level is not one.
    #[error("a level of {level_rms} {unit}: it is from 0 to {most}")]
    Level {
        /// The level, in the quantity's unit.
        level_rms: f64,
        unit: &'static str,
        /// The largest level of the quantity.
        most: f64,
    },
    /// A model's parameters are not the level, and no level is given.
    #[error(
        "{model} needs a level: the RMS of the texture in the band, in the unit of its quantity"
    )]
    NoLevel { model: String },
    /// The band is not one.
    #[error("the band is {low_hz} to {high_hz} Hz; its edges ascend, above 0 and up to 20,000 Hz")]
    Band { low_hz: f64, high_hz: f64 },
    /// There is no model, or no condition.
    #[error(
        "the texture has no model, or none has parameters at a condition; give one of each at least"
    )]
    Empty,
    /// Speed or force is known of some conditions alone.
    #[error(
        "the speed or the force of some conditions alone is known; give both of all, or of none"
    )]
    Conditions,
    /// The textures cannot be mixed.
    #[error("{a} and {b} cannot be mixed: {problem}")]
    Different {
        a: String,
        b: String,
        /// What differs.
        problem: String,
    },
    /// The weight is not one.
    #[error(
        "a weight of {weight}: it is from 0, all of the first texture, to 1, all of the second"
    )]
    Weight { weight: f64 },
    /// A representation cannot be read.
    #[error(transparent)]
    Play(#[from] htex_play::Error),
    /// A model refuses the parameters.
    #[error(transparent)]
    Model(#[from] HostError),
    /// The parameters cannot be stored.
    #[error(transparent)]
    Write(#[from] htex_format::WriteError),
}
