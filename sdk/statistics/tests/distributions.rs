//! Distribution functions against `statrs`, closed forms and published tables.
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

use htex_statistics::distributions::*;
use htex_statistics::{Power, kolmogorov_sf};
use proptest::prelude::*;
use statrs::distribution::{
    ChiSquared, Continuous, ContinuousCDF, FisherSnedecor, Normal, StudentsT,
};

fn close(a: f64, b: f64, relative: f64) -> Result<(), TestCaseError> {
    prop_assert!(
        (a - b).abs() <= relative * b.abs() + 1e-14,
        "{a} is not {b}"
    );
    Ok(())
}

proptest! {
    #[test]
    fn tails_agree_with_statrs(x in 0.01f64..30.0, a in 1u32..200, b in 1u32..2000) {
        let df = [f64::from(a), f64::from(b)];
        close(f_sf(x, df), FisherSnedecor::new(df[0], df[1]).unwrap().sf(x), 1e-8)?;
        close(chi_squared_sf(x, df[0]), ChiSquared::new(df[0]).unwrap().sf(x), 1e-8)?;
        close(t_two_sided(x, df[1]), 2.0 * StudentsT::new(0.0, 1.0, df[1]).unwrap().sf(x), 1e-8)?;
        close(normal_cdf(-x), Normal::standard().cdf(-x), 1e-8)?;
    }

    #[test]
    fn quantiles_invert_tails(p in 1e-6f64..0.999, a in 1u32..50, b in 1u32..5000) {
        let df = [f64::from(a), f64::from(b)];
        close(f_sf(f_critical(p, df), df), p, 1e-9)?;
        close(t_two_sided(t_critical(p, df[1]), df[1]), p, 1e-9)?;
        close(normal_cdf(normal_quantile(p)), p, 1e-12)?;
    }

    /// With one numerator degree of freedom, noncentral F is (Z + sqrt(lambda))^2 over a mean square: integrated here by Simpson's rule.
    #[test]
    fn noncentral_f_agrees_with_an_integral(f in 0.1f64..10.0, df in 3u32..60, lambda in 0.0f64..40.0) {
        let df = f64::from(df);
        let (chi, delta) = (ChiSquared::new(df).unwrap(), lambda.sqrt());
        // Over the root of chi-squared, where the integrand is smooth.
        let beyond = |s: f64| {
            let c = s * (f / df).sqrt();
            2.0 * s * chi.pdf(s * s) * (normal_cdf(delta - c) + normal_cdf(-delta - c))
        };
        let (steps, h) = (2000, (df.sqrt() + 12.0) / 2000.0);
        let weight = |i: i32| if i == steps { 1.0 } else if i % 2 == 1 { 4.0 } else { 2.0 };
        let sum: f64 = (1..=steps).map(|i| weight(i) * beyond(f64::from(i) * h)).sum();
        let integral = sum * h / 3.0;
        let got = noncentral_f_sf(f, [1.0, df], lambda);
        prop_assert!((got - integral).abs() < 1e-8, "{got} is not {integral}");
    }

    #[test]
    fn power_grows_with_participants_and_effect(f in 0.05f64..1.0, m in 2usize..40, n in 2usize..60) {
        let power = |f: f64, n: usize| Power::new(f, m).with_participants(n).unwrap().power;
        prop_assert!(power(f, n) <= power(f, n + 1) + 1e-12);
        prop_assert!(power(f, n) <= power(1.2 * f, n) + 1e-12);
        let found = Power::new(f, m).participants_for(0.8).unwrap();
        prop_assert!(found.power >= 0.8);
        prop_assert!(found.participants == 2 || power(f, found.participants - 1) < 0.8);
    }
}

/// Critical values at 0.05 (Massey 1951, to more digits in Marsaglia, Tsang and Wang 2003), closed forms for small n.
#[test]
fn the_distribution_of_d_is_exact() {
    for (n, d) in [(5, 0.56328), (10, 0.40925), (20, 0.29408)] {
        assert!(
            (kolmogorov_sf(n, d) - 0.05).abs() < 2e-5,
            "{n}: {}",
            kolmogorov_sf(n, d)
        );
    }
    assert!((kolmogorov_sf(1, 0.75) - 0.5).abs() < 1e-15);
    // Two values: P(D < d) = 2 (2 d - 1/2)^2 up to d = 1/2.
    assert!((kolmogorov_sf(2, 0.4) - (1.0 - 2.0 * 0.3 * 0.3)).abs() < 1e-14);
    assert_eq!((kolmogorov_sf(9, 0.0), kolmogorov_sf(9, 1.0)), (1.0, 0.0));
}

#[test]
fn the_formulas_for_d_agree_where_they_meet() {
    for n in [20usize, 350, 1000, 3999] {
        let d = (4.0 / n as f64).sqrt();
        let (below, above) = (
            kolmogorov_sf(n, d * 0.999_999_9),
            kolmogorov_sf(n, d * 1.000_000_1),
        );
        assert!(
            (below / above - 1.0).abs() < 1e-5,
            "{n}: {below} and {above}"
        );
    }
    let d = 1.36 / 4000f64.sqrt();
    assert!((kolmogorov_sf(4000, d) / kolmogorov_sf(4001, d) - 1.0).abs() < 1e-3);
}
