//! Numbers of statistics as people read them.

use super::results::{AnovaResult, FriedmanResult, Normality, PairTest};

/// A p-value: three decimals, or `< 0.001`.
pub(super) fn p(value: f64) -> String {
    if value < 0.001 {
        "p < 0.001".to_owned()
    } else {
        format!("p = {value:.3}")
    }
}

/// Stars of a p-value.
pub(super) fn stars(value: f64) -> &'static str {
    match value {
        _ if value < 0.001 => "***",
        _ if value < 0.01 => "**",
        _ if value < 0.05 => "*",
        _ => "",
    }
}

/// An ANOVA in a sentence.
pub(super) fn anova(test: &AnovaResult) -> String {
    let [a, b] = test.df;
    let mauchly = match (test.mauchly_w, test.mauchly_p) {
        (Some(w), Some(value)) => format!("; Mauchly W = {w:.3}, {}", p(value)),
        _ => String::new(),
    };
    format!(
        "F({a}, {b}) = {:.3}, {}; Greenhouse\u{2013}Geisser {} (\u{3b5} = {:.3}), Huynh\u{2013}Feldt {} (\u{3b5} = {:.3}); partial \u{3b7}\u{b2} = {:.3}{mauchly}",
        test.f,
        p(test.p),
        p(test.p_gg),
        test.eps_gg,
        p(test.p_hf),
        test.eps_hf,
        test.partial_eta_squared
    )
}

/// Friedman's test in a sentence.
pub(super) fn friedman(test: &FriedmanResult) -> String {
    format!(
        "Friedman \u{3c7}\u{b2}({}) = {:.3}, {}; Kendall's W = {:.3}",
        test.df,
        test.chi2,
        p(test.p),
        test.kendall_w
    )
}

/// The tests of normality that are defined, in a sentence.
pub(super) fn normality(test: &Normality) -> String {
    let one = |name: &str, statistic: Option<f64>, value: Option<f64>| {
        Some(format!("{name} = {:.4}, {}", statistic?, p(value?)))
    };
    let all = [
        one("Kolmogorov\u{2013}Smirnov D", test.ks_d, test.ks_p),
        one("Lilliefors D", test.lilliefors_d, test.lilliefors_p),
        one("Shapiro\u{2013}Wilk W", test.shapiro_w, test.shapiro_p),
    ];
    let all: Vec<String> = all.into_iter().flatten().collect();
    match all.is_empty() {
        true => "not defined".to_owned(),
        false => all.join("; "),
    }
}

/// The fields of a comparison, in the order of [`PAIR_HEADS`].
pub(super) fn pair(test: Option<&PairTest>) -> Vec<String> {
    let Some(test) = test else {
        return vec!["not defined".to_owned()];
    };
    let maybe = |value: Option<f64>| value.map_or(String::new(), |value| format!("{value:.2}"));
    vec![
        format!("{:.3}", test.t),
        test.df.to_string(),
        number_p(test.p),
        number_p(test.p_bonferroni),
        number_p(test.p_holm),
        format!("{:.3} to {:.3}", test.ci95[0], test.ci95[1]),
        format!("{:.2}", test.cohen_dz),
        maybe(test.hedges_g),
    ]
}

/// Heads of the columns of a comparison, after both models and the difference.
pub(super) const PAIR_HEADS: [&str; 8] = [
    "t",
    "df",
    "p",
    "p Bonferroni",
    "p Holm",
    "95 % interval",
    "d_z",
    "g",
];

/// A p-value in a table: three digits.
pub(super) fn number_p(value: f64) -> String {
    match value {
        _ if value < 0.001 => format!("{value:.1e}"),
        _ => format!("{value:.3}"),
    }
}
