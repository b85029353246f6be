//! Errors of making textures without recordings.

use htex_host::HostError;

/// Why a texture cannot be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ByHandError {
    /// The model has no field of this name.
    #[error("{model} has no parameter {name:?}; it has {there}")]
    Unknown {
        model: String,
        name: String,
        /// The model's fields, with units and ranges.
        there: String,
    },
    /// A field has no value.
    #[error("{model} needs a value for {missing}")]
    Missing {
        model: String,
        /// The fields without a value, with units and ranges.
        missing: String,
    },
    /// A value is outside its field's range, or the field has too many values.
    #[error("{name} = {value}: {problem}")]
    Value {
        name: String,
        value: String,
        /// What is allowed.
        problem: String,
    },
    /// The level is not a valid number for its quantity.
    #[error("a level of {level_rms} {unit}: it is from 0 to {most}")]
    Level {
        /// The level, in the quantity's unit.
        level_rms: f64,
        unit: &'static str,
        /// The largest level allowed for the quantity.
        most: f64,
    },
    /// The model's parameters do not include the level, and no level is given.
    #[error(
        "{model} needs a level: the RMS of the texture in the band, in the unit of its quantity"
    )]
    NoLevel { model: String },
    /// The band is invalid.
    #[error("the band is {low_hz} to {high_hz} Hz; its edges ascend, above 0 and up to 20,000 Hz")]
    Band { low_hz: f64, high_hz: f64 },
    /// The texture has no model, or a model has no condition.
    #[error(
        "the texture has no model, or none has parameters at a condition; give one of each at least"
    )]
    Empty,
    /// Only some conditions have a speed or a force.
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
    /// The weight is not between 0 and 1.
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
