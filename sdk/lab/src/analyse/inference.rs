//! The tests of ratings, with a note for each that is not defined.

use htex_statistics::{
    Anova, StatisticsError, Table, TwoFactors, anova, bonferroni, friedman, holm,
    kolmogorov_smirnov, lilliefors, paired_t, shapiro_wilk, z_scores,
};
use std::collections::BTreeMap;

use super::analysis::Note;
use super::methods;
use super::results::{AnovaResult, FriedmanResult, Normality, PairResult, PairTest};

/// Collects why groups are missing.
#[derive(Default)]
pub(super) struct Notes(pub(super) Vec<Note>);

impl Notes {
    /// Adds a note.
    pub(super) fn add(&mut self, group: &str, code: &str, message: String) {
        self.0.push(Note {
            group: group.to_owned(),
            code: code.to_owned(),
            message,
        });
    }

    /// Returns the result, or notes the error.
    pub(super) fn take<T>(&mut self, group: &str, result: Result<T, StatisticsError>) -> Option<T> {
        result
            .map_err(|error| self.add(group, error.code(), error.to_string()))
            .ok()
    }
}

pub(super) fn anova_of(table: &Table, group: &str, notes: &mut Notes) -> Option<AnovaResult> {
    let test = notes.take(group, anova(table))?;
    Some(anova_result(&test, group, notes))
}

fn anova_result(test: &Anova, group: &str, notes: &mut Notes) -> AnovaResult {
    let mauchly = notes.take(group, test.sphericity.clone());
    AnovaResult {
        f: test.f,
        df: test.df,
        p: test.p,
        p_gg: test.p_gg,
        p_hf: test.p_hf,
        eps_gg: test.eps_gg,
        eps_hf: test.eps_hf,
        partial_eta_squared: test.partial_eta_squared,
        mauchly_w: mauchly.map(|m| m.w),
        mauchly_chi2: mauchly.map(|m| m.chi2),
        mauchly_p: mauchly.map(|m| m.p_pingouin),
        mauchly_p_r: mauchly.map(|m| m.p),
        method: methods::ANOVA.to_owned(),
    }
}

/// The two-way ANOVA, by effect.
pub(super) fn two_way(
    table: Result<TwoFactors, StatisticsError>,
    notes: &mut Notes,
) -> BTreeMap<String, AnovaResult> {
    const GROUP: &str = "anova_two_way";
    let tests = table.and_then(|table| table.anova());
    let Some(tests) = notes.take(GROUP, tests) else {
        return BTreeMap::new();
    };
    let mut result = |name: &str, test: &Anova| {
        let group = format!("{GROUP}.{name}");
        (name.to_owned(), anova_result(test, &group, notes))
    };
    [
        result("texture", &tests.first),
        result("model", &tests.second),
        result("texture * model", &tests.interaction),
    ]
    .into()
}

pub(super) fn friedman_of(table: &Table, group: &str, notes: &mut Notes) -> Option<FriedmanResult> {
    let test = notes.take(group, friedman(table))?;
    Some(FriedmanResult {
        chi2: test.chi2,
        df: test.df,
        p: test.p,
        kendall_w: test.kendall_w,
        method: methods::FRIEDMAN.to_owned(),
    })
}

pub(super) fn normality_of(values: &[f64], group: &str, notes: &mut Notes) -> Normality {
    let mut result = Normality {
        count: values.len(),
        on: "cell means, z-scored with n-1".to_owned(),
        method: methods::NORMALITY.to_owned(),
        ..Normality::default()
    };
    let Some(scores) = notes.take(group, z_scores(values)) else {
        return result;
    };
    let ks = notes.take(group, kolmogorov_smirnov(&scores));
    let corrected = notes.take(group, lilliefors(&scores));
    let shapiro = notes.take(group, shapiro_wilk(&scores));
    result.ks_d = ks.map(|test| test.statistic);
    result.ks_p = ks.map(|test| test.p);
    result.lilliefors_d = corrected.map(|test| test.statistic);
    result.lilliefors_p = corrected.map(|test| test.p);
    result.shapiro_w = shapiro.map(|test| test.statistic);
    result.shapiro_p = shapiro.map(|test| test.p);
    result
}

/// Compares every two columns of `table`.
pub(super) fn pairs_of(
    table: &Table,
    names: &[String],
    group: &str,
    notes: &mut Notes,
) -> Vec<PairResult> {
    let columns: Vec<Vec<f64>> = (0..names.len()).map(|level| table.column(level)).collect();
    let mut tests = Vec::new();
    for a in 0..names.len() {
        for b in a + 1..names.len() {
            let group = format!("{group}.{}-{}", names[a], names[b]);
            let test = notes.take(&group, paired_t(&columns[a], &columns[b]));
            tests.push((a, b, test));
        }
    }
    // A pair without a test counts as a comparison all the same.
    let p: Vec<f64> = tests
        .iter()
        .map(|(_, _, test)| test.map_or(1.0, |test| test.p))
        .collect();
    let (bonferroni, holm) = (bonferroni(&p), holm(&p));
    let result = |(index, (a, b, test)): (usize, &(usize, usize, Option<_>))| PairResult {
        a: names[*a].clone(),
        b: names[*b].clone(),
        mean_difference: mean_difference(&columns[*a], &columns[*b]),
        test: test.map(|test: htex_statistics::PairedT| PairTest {
            t: test.t,
            df: test.df,
            p: test.p,
            p_bonferroni: bonferroni[index],
            p_holm: holm[index],
            ci95: test.ci95,
            cohen_dz: test.cohen_dz,
            cohen_d_av: test.cohen_d_av,
            hedges_g: test.hedges_g,
        }),
    };
    tests.iter().enumerate().map(result).collect()
}

fn mean_difference(a: &[f64], b: &[f64]) -> f64 {
    let sum: f64 = a.iter().zip(b).map(|(x, y)| x - y).sum();
    sum / a.len() as f64
}
