//! Orthonormal contrasts: the differences between conditions that a factor makes.

use crate::table::Table;

/// Contrasts of one factor or of an interaction: orthonormal rows, each of which sums to 0.
pub(crate) struct Contrasts(Vec<Vec<f64>>);

impl Contrasts {
    /// Helmert's contrasts of `levels` conditions: each condition against the mean of those before it.
    pub(crate) fn helmert(levels: usize) -> Self {
        let row = |k: usize| {
            let norm = libm::sqrt((k * (k + 1)) as f64);
            let entry = |level: usize| match level {
                _ if level < k => 1.0 / norm,
                _ if level == k => -(k as f64) / norm,
                _ => 0.0,
            };
            (0..levels).map(entry).collect()
        };
        Self((1..levels).map(row).collect())
    }

    /// The interaction of two factors: products of their contrasts.
    pub(crate) fn interaction(&self, other: &Self) -> Self {
        let product = |a: &[f64], b: &[f64]| -> Vec<f64> {
            a.iter()
                .flat_map(|x| b.iter().map(move |y| x * y))
                .collect()
        };
        let rows = self
            .0
            .iter()
            .flat_map(|a| other.0.iter().map(|b| product(a, b)));
        Self(rows.collect())
    }

    /// Returns the value of each contrast for each participant.
    pub(crate) fn apply(&self, table: &Table) -> Scores {
        let value =
            |row: &[f64], contrast: &[f64]| row.iter().zip(contrast).map(|(v, c)| v * c).sum();
        let rows = table.rows();
        let all = rows.map(|row| self.0.iter().map(|c| value(row, c)).collect());
        let largest = table
            .values()
            .iter()
            .fold(0.0, |most: f64, v| most.max(v.abs()));
        Scores {
            rows: all.collect(),
            largest,
        }
    }
}

/// Values of contrasts: a row for each participant, a column for each degree of freedom.
pub(crate) struct Scores {
    rows: Vec<Vec<f64>>,
    /// Largest size of the values they were made of.
    pub(crate) largest: f64,
}

impl Scores {
    pub(crate) fn participants(&self) -> usize {
        self.rows.len()
    }

    /// Degrees of freedom of the effect.
    pub(crate) fn df(&self) -> usize {
        self.rows.first().map_or(0, Vec::len)
    }

    pub(crate) fn means(&self) -> Vec<f64> {
        let count = self.rows.len() as f64;
        let mean = |k: usize| self.rows.iter().map(|row| row[k]).sum::<f64>() / count;
        (0..self.df()).map(mean).collect()
    }

    /// Sums of products of the differences from the means, df x df: (n - 1) times the covariance.
    pub(crate) fn products(&self) -> Vec<Vec<f64>> {
        let means = self.means();
        let entry = |i: usize, j: usize| {
            let of = |row: &Vec<f64>| (row[i] - means[i]) * (row[j] - means[j]);
            self.rows.iter().map(of).sum()
        };
        let df = self.df();
        (0..df)
            .map(|i| (0..df).map(|j| entry(i, j)).collect())
            .collect()
    }
}
