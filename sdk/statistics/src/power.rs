//! Power analysis of repeated measures: how many participants a study needs.

use crate::StatisticsError;
use crate::distributions::{f_critical, noncentral_f_sf};

/// Most participants that are tried.
const MOST: usize = 100_000;

/// A planned study: an F-test of repeated measures within factors, for one group.
///
/// As in G*Power 3.1: lambda = f^2 N m e / (1 - rho), with (m - 1) e and (N - 1) (m - 1) e degrees of freedom.
///
/// ```
/// use htex_statistics::Power;
/// let plan = Power::new(0.25, 25);
/// let found = plan.participants_for(0.8)?;
/// assert_eq!(found.participants, 8);
/// assert!((found.power - 0.8016).abs() < 1e-4);
/// # Ok::<(), htex_statistics::StatisticsError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Power {
    /// Cohen's effect size f, above 0 and at most 100.
    pub effect_f: f64,
    /// Number of measurements of each participant, 2 to 100000.
    pub measurements: usize,
    /// Significance level, above 0 and below 1.
    pub alpha: f64,
    /// Correlation among the measurements, -1 / (m - 1) to 1, both excluded.
    pub correlation: f64,
    /// Correction for nonsphericity, 1 / (m - 1) to 1.
    pub epsilon: f64,
}

/// The power of a study with a number of participants.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PowerResult {
    /// Number of participants.
    pub participants: usize,
    /// Probability of finding the effect, 0 to 1.
    pub power: f64,
    /// Noncentrality.
    pub lambda: f64,
    /// Degrees of freedom.
    pub df: [f64; 2],
    /// The F ratio above which the test is significant.
    pub critical_f: f64,
}

impl Power {
    /// A study with level 0.05, correlation 0.5 and sphericity: G*Power's defaults.
    pub fn new(effect_f: f64, measurements: usize) -> Self {
        Self {
            effect_f,
            measurements,
            alpha: 0.05,
            correlation: 0.5,
            epsilon: 1.0,
        }
    }

    /// Returns the power with `participants`.
    ///
    /// # Errors
    /// A setting is out of range, or there are fewer than two participants or more than 100000.
    pub fn with_participants(&self, participants: usize) -> Result<PowerResult, StatisticsError> {
        self.check()?;
        let value = participants as f64;
        within(
            "the number of participants",
            value,
            2.0..=MOST as f64,
            "it is 2 to 100000",
        )?;
        Ok(self.compute(participants))
    }

    /// Returns the least number of participants that reaches `power`.
    ///
    /// # Errors
    /// A setting is out of range, or 100000 participants are too few.
    pub fn participants_for(&self, power: f64) -> Result<PowerResult, StatisticsError> {
        self.check()?;
        open("the power", power, 0.0, 1.0, "it is above 0 and below 1")?;
        let (mut low, mut high) = (1, 2);
        while self.compute(high).power < power {
            if high == MOST {
                return Err(StatisticsError::PowerNotReached {
                    power,
                    participants: MOST,
                });
            }
            (low, high) = (high, (2 * high).min(MOST));
        }
        while high - low > 1 {
            let middle = low + (high - low) / 2;
            if self.compute(middle).power < power {
                low = middle;
            } else {
                high = middle;
            }
        }
        Ok(self.compute(high))
    }

    fn compute(&self, participants: usize) -> PowerResult {
        let (n, m) = (participants as f64, self.measurements as f64);
        let df = [m - 1.0, (n - 1.0) * (m - 1.0)].map(|df| df * self.epsilon);
        let effect = self.effect_f * self.effect_f;
        let lambda = effect * n * m * self.epsilon / (1.0 - self.correlation);
        let critical_f = f_critical(self.alpha, df);
        PowerResult {
            participants,
            power: noncentral_f_sf(critical_f, df, lambda),
            lambda,
            df,
            critical_f,
        }
    }

    fn check(&self) -> Result<(), StatisticsError> {
        let m = self.measurements as f64;
        within(
            "the number of measurements",
            m,
            2.0..=1e5,
            "it is 2 to 100000",
        )?;
        within(
            "the effect size f",
            self.effect_f,
            1e-6..=100.0,
            "it is 0.000001 to 100",
        )?;
        open(
            "alpha",
            self.alpha,
            1e-12,
            1.0,
            "it is above 1e-12 and below 1",
        )?;
        let least = -1.0 / (m - 1.0);
        let allowed = "it is above -1 / (measurements - 1) and below 1";
        open(
            "the correlation",
            self.correlation,
            least,
            1.0 - 1e-9,
            allowed,
        )?;
        let range = 1.0 / (m - 1.0) - 1e-9..=1.0;
        within(
            "epsilon",
            self.epsilon,
            range,
            "it is 1 / (measurements - 1) to 1",
        )
    }
}

fn within(
    name: &'static str,
    value: f64,
    range: std::ops::RangeInclusive<f64>,
    allowed: &'static str,
) -> Result<(), StatisticsError> {
    match range.contains(&value) {
        true => Ok(()),
        false => Err(StatisticsError::Setting {
            name,
            value,
            allowed,
        }),
    }
}

fn open(
    name: &'static str,
    value: f64,
    low: f64,
    high: f64,
    allowed: &'static str,
) -> Result<(), StatisticsError> {
    match low < value && value < high {
        true => Ok(()),
        false => Err(StatisticsError::Setting {
            name,
            value,
            allowed,
        }),
    }
}
