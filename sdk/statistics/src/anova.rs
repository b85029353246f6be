//! Analysis of variance with repeated measures, for one and for two factors.

use crate::StatisticsError;
use crate::contrasts::{Contrasts, Scores};
use crate::describe::negligible;
use crate::distributions::f_sf;
use crate::sphericity::{Sphericity, greenhouse_geisser, huynh_feldt, mauchly};
use crate::table::{Table, TwoFactors};

const TEST: &str = "a repeated-measures ANOVA";

/// The test of one effect.
#[derive(Debug, Clone, PartialEq)]
pub struct Anova {
    /// The F ratio.
    pub f: f64,
    /// Degrees of freedom of the effect and of its error, uncorrected.
    pub df: [f64; 2],
    /// p-value, uncorrected: valid under sphericity.
    pub p: f64,
    /// p-value with both degrees of freedom times `eps_gg`.
    pub p_gg: f64,
    /// p-value with both degrees of freedom times `eps_hf`.
    pub p_hf: f64,
    /// Greenhouse and Geisser's epsilon, 1 / df to 1.
    pub eps_gg: f64,
    /// Huynh and Feldt's epsilon, at most 1.
    pub eps_hf: f64,
    /// Partial eta squared: SS effect / (SS effect + SS error).
    pub partial_eta_squared: f64,
    /// Sum of squares of the effect.
    pub ss_effect: f64,
    /// Sum of squares of its error: the interaction with participants.
    pub ss_error: f64,
    /// Mauchly's test, or why there is none.
    pub sphericity: Result<Sphericity, StatisticsError>,
}

/// The tests of two factors and of their interaction.
#[derive(Debug, Clone, PartialEq)]
pub struct TwoWayAnova {
    /// The effect of the first factor.
    pub first: Anova,
    /// The effect of the second factor.
    pub second: Anova,
    /// Their interaction. Its epsilons are of the interaction's own contrasts.
    pub interaction: Anova,
}

/// Tests whether the conditions of `table` have the same mean.
///
/// ```
/// use htex_statistics::{StatisticsError, Table, anova};
/// let alone = Table::new(1, 3, vec![1.0, 2.0, 4.0])?;
/// assert!(matches!(anova(&alone), Err(StatisticsError::TooFewParticipants { found: 1, .. })));
/// # Ok::<(), StatisticsError>(())
/// ```
///
/// # Errors
/// There are fewer than two participants or conditions, or no error variance.
pub fn anova(table: &Table) -> Result<Anova, StatisticsError> {
    check(table.participants(), table.levels())?;
    effect(&Contrasts::helmert(table.levels()).apply(table), 1)
}

impl TwoFactors {
    /// Tests both factors and their interaction.
    ///
    /// # Errors
    /// There are fewer than two participants or levels of a factor, or an effect has no error variance.
    pub fn anova(&self) -> Result<TwoWayAnova, StatisticsError> {
        let [a, b] = self.levels;
        check(self.table.participants(), a.min(b))?;
        let contrasts = [a, b].map(Contrasts::helmert);
        let of = |factor: usize, other: usize| {
            effect(&contrasts[factor].apply(&self.marginal(factor)?), other)
        };
        let interaction = contrasts[0].interaction(&contrasts[1]).apply(&self.table);
        Ok(TwoWayAnova {
            first: of(0, b)?,
            second: of(1, a)?,
            interaction: effect(&interaction, 1)?,
        })
    }
}

fn check(participants: usize, levels: usize) -> Result<(), StatisticsError> {
    if levels < 2 {
        return Err(StatisticsError::TooFewLevels {
            test: TEST,
            found: levels,
            needed: 2,
        });
    }
    if participants < 2 {
        return Err(StatisticsError::TooFewParticipants {
            test: TEST,
            found: participants,
            needed: 2,
        });
    }
    Ok(())
}

/// Tests the effect whose contrasts have `scores`, means of `averaged` values each.
fn effect(scores: &Scores, averaged: usize) -> Result<Anova, StatisticsError> {
    let participants = scores.participants() as f64;
    let products = scores.products();
    let weight = averaged as f64;
    let ss_effect = weight * participants * scores.means().iter().map(|m| m * m).sum::<f64>();
    let ss_error = weight * (0..scores.df()).map(|k| products[k][k]).sum::<f64>();
    let cells = scores.participants() * (scores.df() + 1);
    if negligible(ss_error / weight, scores.largest, cells) {
        return Err(StatisticsError::NoErrorVariance { test: TEST });
    }
    let df = scores.df() as f64;
    let df = [df, df * (participants - 1.0)];
    let f = (ss_effect / df[0]) / (ss_error / df[1]);
    let eps_gg = greenhouse_geisser(&products);
    let eps_hf = huynh_feldt(eps_gg, df[0], participants);
    let p = |epsilon: f64| f_sf(f, df.map(|df| df * epsilon));
    Ok(Anova {
        f,
        df,
        p: p(1.0),
        p_gg: p(eps_gg),
        p_hf: p(eps_hf),
        eps_gg,
        eps_hf,
        partial_eta_squared: ss_effect / (ss_effect + ss_error),
        ss_effect,
        ss_error,
        sphericity: mauchly(&products, scores.participants()),
    })
}
