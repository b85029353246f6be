//! Friedman's test: whether conditions differ in rank.

use crate::StatisticsError;
use crate::distributions::chi_squared_sf;
use crate::table::Table;

const TEST: &str = "Friedman's test";

/// Friedman's test and Kendall's coefficient of concordance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Friedman {
    /// The statistic, corrected for ties.
    pub chi2: f64,
    /// Degrees of freedom.
    pub df: f64,
    /// p-value by chi-squared.
    pub p: f64,
    /// Kendall's W: 0 for no agreement between participants, 1 for the same order in all.
    pub kendall_w: f64,
}

/// Tests whether the conditions of `table` have the same ranks within participants. Tied values share the mean of their ranks.
///
/// # Errors
/// There are fewer than two participants or three conditions, or every participant rated all conditions alike.
pub fn friedman(table: &Table) -> Result<Friedman, StatisticsError> {
    let (count, levels) = (table.participants(), table.levels());
    if levels < 3 {
        return Err(StatisticsError::TooFewLevels {
            test: TEST,
            found: levels,
            needed: 3,
        });
    }
    if count < 2 {
        return Err(StatisticsError::TooFewParticipants {
            test: TEST,
            found: count,
            needed: 2,
        });
    }
    let ranked: Vec<(Vec<f64>, f64)> = table.rows().map(ranks).collect();
    let sum = |level: usize| ranked.iter().map(|(ranks, _)| ranks[level]).sum::<f64>();
    let (n, k) = (count as f64, levels as f64);
    let ties: f64 = ranked.iter().map(|(_, ties)| ties).sum();
    let correction = 1.0 - ties / (n * k * (k * k - 1.0));
    if correction <= 1e-12 {
        return Err(StatisticsError::AllTied);
    }
    let middle = n * (k + 1.0) / 2.0;
    let squares: f64 = (0..levels)
        .map(|l| (sum(l) - middle) * (sum(l) - middle))
        .sum();
    let chi2 = 12.0 * squares / (n * k * (k + 1.0)) / correction;
    let df = k - 1.0;
    Ok(Friedman {
        chi2,
        df,
        p: chi_squared_sf(chi2, df),
        kendall_w: (chi2 / (n * df)).min(1.0),
    })
}

/// Returns the ranks of `values` from 1, and the sum of t^3 - t over groups of t equal values. Values that differ by rounding are equal.
fn ranks(values: &[f64]) -> (Vec<f64>, f64) {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|a, b| values[*a].total_cmp(&values[*b]));
    let mut ranks = vec![0.0; values.len()];
    let (mut start, mut ties) = (0, 0.0);
    while start < order.len() {
        let same = |index: &&usize| same(values[**index], values[order[start]]);
        let group = order[start..].iter().take_while(same).count();
        let rank = start as f64 + (group as f64 + 1.0) / 2.0;
        order[start..start + group]
            .iter()
            .for_each(|i| ranks[*i] = rank);
        let size = group as f64;
        ties += size * size * size - size;
        start += group;
    }
    (ranks, ties)
}

/// Whether two means differ by no more than the rounding of their sums.
fn same(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-12 * a.abs().max(b.abs())
}
