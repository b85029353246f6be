//! Errors: data or settings for which a statistic is not defined.

use thiserror::Error;

/// Why a statistic cannot be computed.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum StatisticsError {
    /// The number of values differs from that of the cells.
    #[error(
        "the table has {found} values for {participants} participants and {levels} conditions; give one value for each cell"
    )]
    Shape {
        /// Number of values.
        found: usize,
        /// Number of rows.
        participants: usize,
        /// Number of columns.
        levels: usize,
    },
    /// A value is NaN or infinite.
    #[error("value {index} is not a finite number; leave its participant out or measure it again")]
    NotFinite {
        /// Index of the value, from 0.
        index: usize,
    },
    /// Too few participants.
    #[error("{found} participants are too few: {test} needs at least {needed}")]
    TooFewParticipants {
        /// The test.
        test: &'static str,
        /// Number of participants.
        found: usize,
        /// Least number of them.
        needed: usize,
    },
    /// Too few conditions.
    #[error("{found} conditions are too few: {test} compares at least {needed}")]
    TooFewLevels {
        /// The test.
        test: &'static str,
        /// Number of conditions.
        found: usize,
        /// Least number of them.
        needed: usize,
    },
    /// Too few values.
    #[error("{found} values are too few: {test} needs at least {needed}")]
    TooFewValues {
        /// The statistic.
        test: &'static str,
        /// Number of values.
        found: usize,
        /// Least number of them.
        needed: usize,
    },
    /// More values than the approximation is valid for.
    #[error(
        "{found} values are too many: {test} is valid for at most {limit}; use another test of normality"
    )]
    TooManyValues {
        /// The test.
        test: &'static str,
        /// Number of values.
        found: usize,
        /// Largest number of them.
        limit: usize,
    },
    /// All values are equal.
    #[error("all values are equal, so {test} is not defined")]
    Constant {
        /// The statistic.
        test: &'static str,
    },
    /// Every participant has the same difference between the conditions.
    #[error(
        "every participant has the same differences between the conditions: there is no error variance, so {test} is not defined"
    )]
    NoErrorVariance {
        /// The statistic.
        test: &'static str,
    },
    /// Every participant rated all conditions alike.
    #[error("every participant rated all conditions alike, so there are no ranks to compare")]
    AllTied,
    /// Mauchly's test needs a regular covariance matrix.
    #[error(
        "Mauchly's test is not defined for {participants} participants and {differences} differences between conditions: it needs more participants than differences, and none that depends on the others; use the corrected p-values"
    )]
    SphericityUndefined {
        /// Number of participants.
        participants: usize,
        /// Degrees of freedom of the effect.
        differences: usize,
    },
    /// Two conditions are always spherical.
    #[error("there is one difference between the conditions, so that sphericity always holds")]
    SphericityTrivial,
    /// The predictors explain the values exactly, or as many coefficients as values are fitted.
    #[error(
        "{rows} values are too few for a regression with {coefficients} coefficients, which needs more values than coefficients"
    )]
    TooFewRows {
        /// Number of values.
        rows: usize,
        /// Number of coefficients.
        coefficients: usize,
    },
    /// The predictors are all constant.
    #[error("no predictor varies, so that there is nothing to regress on")]
    NoPredictor,
    /// The residuals are all zero.
    #[error(
        "the predictors explain the values exactly: without residuals F, AIC and BIC are not defined"
    )]
    PerfectFit,
    /// A setting is out of range.
    #[error("{name} is {value}; {allowed}")]
    Setting {
        /// Name of the setting.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What is allowed.
        allowed: &'static str,
    },
    /// The power cannot be reached.
    #[error(
        "a power of {power} is not reached with {participants} participants; expect a larger effect or ask for less power"
    )]
    PowerNotReached {
        /// The power that was asked for.
        power: f64,
        /// The largest number of participants that was tried.
        participants: usize,
    },
}

impl StatisticsError {
    /// Returns the name of the error, stable between versions: `TOO_FEW_PARTICIPANTS`.
    pub fn code(&self) -> &'static str {
        match self {
            Self::Shape { .. } => "SHAPE",
            Self::NotFinite { .. } => "NOT_FINITE",
            Self::TooFewParticipants { .. } => "TOO_FEW_PARTICIPANTS",
            Self::TooFewLevels { .. } => "TOO_FEW_LEVELS",
            Self::TooFewValues { .. } => "TOO_FEW_VALUES",
            Self::TooManyValues { .. } => "TOO_MANY_VALUES",
            Self::Constant { .. } => "CONSTANT",
            Self::NoErrorVariance { .. } => "NO_ERROR_VARIANCE",
            Self::AllTied => "ALL_TIED",
            Self::SphericityUndefined { .. } => "SPHERICITY_UNDEFINED",
            Self::SphericityTrivial => "SPHERICITY_TRIVIAL",
            Self::TooFewRows { .. } => "TOO_FEW_ROWS",
            Self::NoPredictor => "NO_PREDICTOR",
            Self::PerfectFit => "PERFECT_FIT",
            Self::Setting { .. } => "SETTING",
            Self::PowerNotReached { .. } => "POWER_NOT_REACHED",
        }
    }
}
