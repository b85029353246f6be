//! Properties of the tests, and named errors for data that do not allow them.
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

use htex_statistics::StatisticsError::*;
use htex_statistics::*;
use proptest::prelude::*;

fn table(participants: usize, levels: usize, values: &[f64]) -> Table {
    Table::new(participants, levels, values.to_vec()).unwrap()
}

/// A normal sample by a fixed generator (SplitMix64).
fn sample(seed: u64, count: usize) -> Vec<f64> {
    let mut state = seed;
    let mut next = || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64 + 1e-17
    };
    (0..count)
        .map(|_| distributions::normal_quantile(next()))
        .collect()
}

proptest! {
    /// With two conditions an ANOVA is a paired t-test.
    #[test]
    fn f_is_the_square_of_t(values in prop::collection::vec(-5.0f64..5.0, 6..40)) {
        let count = values.len() / 2;
        let table = table(count, 2, &values[..2 * count]);
        let (Ok(f), Ok(t)) = (anova(&table), paired_t(&table.column(0), &table.column(1))) else {
            return Ok(());
        };
        prop_assert!((f.f - t.t * t.t).abs() <= 1e-9 * f.f.max(1.0));
        prop_assert!((f.p - t.p).abs() < 1e-9);
        prop_assert!(t.ci95[0] <= t.mean_difference && t.mean_difference <= t.ci95[1]);
        prop_assert_eq!(t.p < 0.05, t.ci95[0] > 0.0 || t.ci95[1] < 0.0);
    }

    /// Exchanging the factors exchanges their results; effects do not depend on a participant's own level.
    #[test]
    fn factors_can_be_exchanged(values in prop::collection::vec(0u8..7, 5 * 6)) {
        let at = |p: usize, a: usize, b: usize| f64::from(values[p * 6 + a * 3 + b]);
        let cells = |f: &dyn Fn(usize, usize, usize) -> f64, a: usize, b: usize| -> Vec<f64> {
            (0..5).flat_map(|p| (0..a).flat_map(move |i| (0..b).map(move |j| (p, i, j)))).map(|(p, i, j)| f(p, i, j)).collect()
        };
        let one = TwoFactors::new(5, [2, 3], cells(&at, 2, 3)).unwrap().anova();
        let other = TwoFactors::new(5, [3, 2], cells(&|p, i, j| at(p, j, i) + 10.0 * p as f64, 3, 2)).unwrap().anova();
        prop_assert_eq!(one.is_ok(), other.is_ok());
        if let (Ok(one), Ok(other)) = (one, other) {
            for (a, b) in [(one.first, other.second), (one.second, other.first), (one.interaction, other.interaction)] {
                prop_assert!((a.f - b.f).abs() < 1e-6 * a.f.max(1.0));
                prop_assert!((a.eps_gg - b.eps_gg).abs() < 1e-6);
            }
        }
    }

    /// Ratings of whole numbers tie, are constant, and repeat: every result is a finite number or an error with a name.
    #[test]
    fn no_result_is_nan(people in 1usize..6, levels in 1usize..6, values in prop::collection::vec(0u8..3, 36)) {
        let values: Vec<f64> = values.iter().take(people * levels).map(|v| f64::from(*v)).collect();
        let table = table(people, levels, &values);
        let mut numbers = Vec::new();
        if let Ok(t) = anova(&table) {
            numbers.extend([t.f, t.p, t.p_gg, t.p_hf, t.eps_gg, t.eps_hf, t.partial_eta_squared]);
            if let Ok(s) = t.sphericity { numbers.extend([s.w, s.chi2, s.p]) }
        }
        if let Ok(t) = friedman(&table) { numbers.extend([t.chi2, t.p, t.kendall_w]) }
        if let Ok(t) = paired_t(&table.column(0), &table.column(levels - 1)) {
            numbers.extend([t.t, t.p, t.ci95[0], t.ci95[1], t.cohen_dz]);
            numbers.extend(t.cohen_d_av.into_iter().chain(t.hedges_g));
        }
        for t in [kolmogorov_smirnov(&values), lilliefors(&values), shapiro_wilk(&values)].into_iter().flatten() {
            numbers.extend([t.statistic, t.p]);
        }
        let columns: Vec<Vec<f64>> = (0..levels).map(|l| table.column(l)).collect();
        let target = table.column(levels - 1);
        let predictors = Matrix::new(people, columns).unwrap();
        if let Ok(t) = regression(&predictors, &target) {
            numbers.extend([t.r2, t.adjusted_r2, t.f, t.p, t.rmse, t.aic, t.bic]);
            numbers.extend(t.coefficients);
        }
        let groups: Vec<usize> = (0..people).collect();
        numbers.extend(cross_validated_r2(&predictors, &target, &groups));
        prop_assert!(numbers.iter().all(|v| v.is_finite()), "{numbers:?}");
    }
}

#[test]
fn degenerate_data_are_errors_with_names() {
    assert!(matches!(
        anova(&table(1, 3, &[1.0, 2.0, 3.0])),
        Err(TooFewParticipants { found: 1, .. })
    ));
    assert!(matches!(
        anova(&table(3, 1, &[1.0, 2.0, 3.0])),
        Err(TooFewLevels { found: 1, .. })
    ));
    // Means like 3.2 are not exact: differences that are equal but for rounding have no variance either.
    let shifted = [3.2, 2.2, 4.2, 3.2, 1.1, 0.1];
    assert!(matches!(
        anova(&table(3, 2, &shifted)),
        Err(NoErrorVariance { .. })
    ));
    assert!(matches!(
        paired_t(&[3.2, 4.2, 1.1], &[2.2, 3.2, 0.1]),
        Err(NoErrorVariance { .. })
    ));
    assert!(matches!(
        friedman(&table(2, 3, &[1.0, 1.0, 1.0, 4.0, 4.0, 4.0])),
        Err(AllTied)
    ));
    let few = anova(&table(
        3,
        4,
        &[1.0, 2.0, 4.0, 3.0, 2.0, 2.0, 5.0, 1.0, 0.0, 3.0, 4.0, 2.0],
    ))
    .unwrap();
    assert!(matches!(
        few.sphericity,
        Err(SphericityUndefined {
            participants: 3,
            differences: 3
        })
    ));
    assert!(matches!(
        Table::new(2, 2, vec![1.0, 2.0, 3.0]),
        Err(Shape { found: 3, .. })
    ));
    assert!(matches!(
        Table::new(1, 2, vec![1.0, f64::NAN]),
        Err(NotFinite { index: 1 })
    ));
    assert!(matches!(shapiro_wilk(&[2.0; 9]), Err(Constant { .. })));
    assert!(matches!(lilliefors(&[1.0, 2.0]), Err(TooFewValues { .. })));
    let one = |values: &[f64]| Matrix::new(values.len(), vec![values.to_vec()]).unwrap();
    assert!(matches!(
        regression(&one(&[1.0; 4]), &[1.0, 2.0, 3.0, 5.0]),
        Err(NoPredictor)
    ));
    assert!(matches!(
        regression(&one(&[1.0, 2.0, 3.0]), &[2.0, 4.0, 6.0]),
        Err(PerfectFit)
    ));
    assert!(matches!(
        regression(&one(&[1.0, 2.0]), &[2.0, 4.0]),
        Err(TooFewRows { .. })
    ));
    assert!(matches!(
        regression(&one(&[1.0, 2.0, 3.0]), &[4.0; 3]),
        Err(Constant { .. })
    ));
    let groups = cross_validated_r2(&one(&[1.0, 2.0, 3.0]), &[4.0, 5.0, 7.0], &[0, 0, 0]);
    assert!(matches!(groups, Err(TooFewParticipants { found: 1, .. })));
    assert!(matches!(
        Power::new(0.25, 1).participants_for(0.8),
        Err(Setting {
            name: "the number of measurements",
            ..
        })
    ));
    assert!(matches!(
        Power::new(1e-5, 2).participants_for(0.8),
        Err(PowerNotReached { .. })
    ));
}

/// A predictor that repeats others changes nothing but its own coefficient.
#[test]
fn dependent_predictors_are_named() {
    let (a, b) = (sample(1, 30), sample(2, 30));
    let sum: Vec<f64> = a.iter().zip(&b).map(|(x, y)| x + y).collect();
    let target: Vec<f64> = a
        .iter()
        .zip(sample(3, 30))
        .map(|(x, e)| 2.0 * x + e)
        .collect();
    let two = regression(
        &Matrix::new(30, vec![a.clone(), b.clone()]).unwrap(),
        &target,
    )
    .unwrap();
    let all = regression(
        &Matrix::new(30, vec![a, vec![0.0; 30], b, sum]).unwrap(),
        &target,
    )
    .unwrap();
    assert_eq!(all.dependent, [1, 3]);
    assert_eq!(
        (all.df, all.coefficients[2], all.coefficients[4]),
        (two.df, 0.0, 0.0)
    );
    assert!((all.bic - two.bic).abs() < 1e-9 && (all.r2 - two.r2).abs() < 1e-12);
}

/// Rates of p-values below 0.05 over 2000 normal samples: 5 % where the test knows that the normal is fitted, and far less where it does not.
#[test]
fn tests_of_normality_keep_their_level() {
    let mut found = [0; 3];
    for seed in 0..2000 {
        let scores = z_scores(&sample(1000 * seed, 40)).unwrap();
        let tests = [
            lilliefors(&scores),
            shapiro_wilk(&scores),
            kolmogorov_smirnov(&scores),
        ];
        for (count, test) in found.iter_mut().zip(tests) {
            *count += i32::from(test.unwrap().p < 0.05);
        }
    }
    assert!(
        (75..=130).contains(&found[0]) && (75..=130).contains(&found[1]),
        "{found:?}"
    );
    assert!(found[2] < 5, "{found:?}");
}

/// Regression on noise: r2 grows with every predictor, cross-validated r2 does not.
#[test]
fn cross_validation_shows_overfitting() {
    let groups: Vec<usize> = (0..60).map(|row| row / 6).collect();
    let columns: Vec<Vec<f64>> = (0..15).map(|k| sample(10 + k, 60)).collect();
    let target = sample(9, 60);
    let predictors = Matrix::new(60, columns).unwrap();
    assert!(regression(&predictors, &target).unwrap().r2 > 0.15);
    assert!(cross_validated_r2(&predictors, &target, &groups).unwrap() < 0.0);
}

/// The definition: each group is predicted by the regression on the others. One predictor depends on others, groups are of different sizes,
/// and their rows are mixed.
#[test]
fn cross_validation_predicts_each_group_from_the_others() {
    let rows = 90;
    let mut columns: Vec<Vec<f64>> = (0..4).map(|k| sample(30 + k, rows)).collect();
    columns.push(
        (0..rows)
            .map(|row| 2.0 * columns[0][row] - columns[2][row])
            .collect(),
    );
    let noise = sample(40, rows);
    let target: Vec<f64> = (0..rows)
        .map(|row| 5.0 + columns[1][row] - 0.5 * columns[4][row] + noise[row])
        .collect();
    let groups: Vec<usize> = (0..rows).map(|row| 3 * ((row * row) % 7)).collect();
    let (mut errors, mut baseline) = (0.0, 0.0);
    for group in (0..21).filter(|group| groups.contains(group)) {
        let others: Vec<usize> = (0..rows).filter(|row| groups[*row] != group).collect();
        let of = |values: &[f64]| others.iter().map(|row| values[*row]).collect::<Vec<_>>();
        let known = Matrix::new(others.len(), columns.iter().map(|c| of(c)).collect()).unwrap();
        let fit = regression(&known, &of(&target)).unwrap();
        let mean = of(&target).iter().sum::<f64>() / others.len() as f64;
        for row in (0..rows).filter(|row| groups[*row] == group) {
            let slopes = fit.coefficients[1..].iter().zip(&columns);
            let predicted = fit.coefficients[0] + slopes.map(|(c, x)| c * x[row]).sum::<f64>();
            errors += (target[row] - predicted) * (target[row] - predicted);
            baseline += (target[row] - mean) * (target[row] - mean);
        }
    }
    let checked = cross_validated_r2(&Matrix::new(rows, columns).unwrap(), &target, &groups);
    let expected = 1.0 - errors / baseline;
    assert!((checked.unwrap() - expected).abs() < 1e-12, "{expected}");
}

/// 50,000 rows of 2,000 participants: a regression for each of them would take minutes.
#[test]
fn cross_validation_takes_time_by_rows() {
    let rows = 50_000;
    let columns: Vec<Vec<f64>> = (0..20).map(|k| sample(50 + k, rows)).collect();
    let target = sample(49, rows);
    let groups: Vec<usize> = (0..rows).map(|row| row / 25).collect();
    let predictors = Matrix::new(rows, columns).unwrap();
    let start = std::time::Instant::now();
    cross_validated_r2(&predictors, &target, &groups).unwrap();
    assert!(start.elapsed().as_secs() < 20, "{:?}", start.elapsed());
}
