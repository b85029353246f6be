//! Complete tables of a repeated-measures study.

use crate::StatisticsError;

/// A value for each participant and condition, all of them finite.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    participants: usize,
    levels: usize,
    values: Vec<f64>,
}

impl Table {
    /// Creates a table of `participants` rows and `levels` columns out of `values` by row.
    ///
    /// # Errors
    /// There is not one value for each cell, a value is not finite, or a dimension is 0.
    pub fn new(
        participants: usize,
        levels: usize,
        values: Vec<f64>,
    ) -> Result<Self, StatisticsError> {
        let cells = participants.checked_mul(levels);
        if cells != Some(values.len()) || values.is_empty() {
            return Err(StatisticsError::Shape {
                found: values.len(),
                participants,
                levels,
            });
        }
        check_finite(&values)?;
        Ok(Self {
            participants,
            levels,
            values,
        })
    }

    /// Number of participants.
    pub fn participants(&self) -> usize {
        self.participants
    }

    /// Number of conditions.
    pub fn levels(&self) -> usize {
        self.levels
    }

    /// All values by row.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The rows: the values of one participant each.
    pub fn rows(&self) -> impl Iterator<Item = &[f64]> {
        self.values.chunks_exact(self.levels)
    }

    /// The values of condition `level`, by participant.
    ///
    /// # Panics
    /// There is no such condition.
    pub fn column(&self, level: usize) -> Vec<f64> {
        self.rows().map(|row| row[level]).collect()
    }
}

/// A value for each participant and each combination of two factors, all of them finite.
#[derive(Debug, Clone, PartialEq)]
pub struct TwoFactors {
    pub(crate) table: Table,
    pub(crate) levels: [usize; 2],
}

impl TwoFactors {
    /// Creates a table out of `values` by participant, then by level of the first factor, then by level of the second.
    ///
    /// # Errors
    /// As of [`Table::new`].
    pub fn new(
        participants: usize,
        levels: [usize; 2],
        values: Vec<f64>,
    ) -> Result<Self, StatisticsError> {
        let cells = levels[0].saturating_mul(levels[1]);
        let table = Table::new(participants, cells, values)?;
        Ok(Self { table, levels })
    }

    /// Returns the means over the other factor; `factor` is 0 for the first and 1 for the second.
    ///
    /// # Errors
    /// A mean is not finite, because the values are too large.
    pub fn marginal(&self, factor: usize) -> Result<Table, StatisticsError> {
        let [a, b] = self.levels;
        let (kept, other) = if factor == 0 { (a, b) } else { (b, a) };
        let mean = |row: &[f64], level: usize| {
            let at = |k: usize| match factor {
                0 => row[level * b + k],
                _ => row[k * b + level],
            };
            (0..other).map(at).sum::<f64>() / other as f64
        };
        let rows = self.table.rows();
        let values = rows.flat_map(|row| (0..kept).map(move |level| mean(row, level)));
        Table::new(self.table.participants, kept, values.collect())
    }
}

pub(crate) fn check_finite(values: &[f64]) -> Result<(), StatisticsError> {
    // Sums of squares of larger values are not finite.
    match values.iter().position(|v| v.is_nan() || v.abs() > 1e100) {
        Some(index) => Err(StatisticsError::NotFinite { index }),
        None => Ok(()),
    }
}
