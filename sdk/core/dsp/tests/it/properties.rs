//! Properties that hold for every input, checked on random inputs.

use htex_dsp::biquad::Cascade;
use htex_dsp::butterworth;
use htex_dsp::dct::{InverseDct, dct_ii};
use htex_dsp::estimation::{burg, covariance};
use htex_dsp::least_squares::PseudoInverse;
use htex_dsp::line_spectrum::{from_line_spectral_frequencies, line_spectral_frequencies};
use htex_dsp::linear_prediction::{
    coefficients_to_reflection, is_stable, levinson_durbin, reflection_to_coefficients, stabilize,
};
use htex_dsp::peaks::{FREQUENCY_JND, select_peaks};
use proptest::collection::vec;
use proptest::prelude::*;

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max)
}

/// Power spectra with zeros, lines and 200 dB of dynamic range.
fn power_spectrum() -> impl Strategy<Value = Vec<f64>> {
    let bin = prop_oneof![Just(0.0), (-20.0..0.0_f64).prop_map(|e| 10f64.powf(e)), 0.0..1.0];
    vec(bin, 2..300)
}

/// Autocorrelation lags `0..=order` from the power in equally spaced bins from 0 Hz to Nyquist
/// inclusive: `r[m] = Σ P_k cos(π k m / (bins - 1))`.
///
/// The power is one-sided: a bin includes the power of its negative frequency. So `r[0]` is the
/// total power. Bins outside the band have zero power, and the model approximates zero there.
fn autocorrelation_from_power(power: &[f64], order: usize) -> Vec<f64> {
    let nyquist = power.len().saturating_sub(1).max(1);
    let cosine = |turn: usize| {
        f64::cos(std::f64::consts::PI * (turn % (2 * nyquist)) as f64 / nyquist as f64)
    };
    (0..=order).map(|m| power.iter().enumerate().map(|(k, p)| p * cosine(k * m)).sum()).collect()
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn reflection_and_coefficients_are_the_same_model(k in vec(-0.95..0.95f64, 0..12)) {
        let back = coefficients_to_reflection(&reflection_to_coefficients(&k)).unwrap();
        prop_assert!(largest_difference(&k, &back) < 1e-6);
    }

    #[test]
    fn levinson_is_stable_on_any_power_spectrum(power in power_spectrum(), order in 0usize..24) {
        let model = levinson_durbin(&autocorrelation_from_power(&power, order), order);
        prop_assert_eq!(model.coefficients.len(), order);
        prop_assert!(model.reflection.iter().all(|k| k.abs() < 1.0));
        prop_assert!(model.coefficients.iter().all(|a| a.is_finite()));
        prop_assert!(model.error >= 0.0);
    }

    #[test]
    fn estimates_from_signals_are_stable(x in vec(-1.0..1.0f64, 0..120), order in 0usize..10) {
        let segments = [&x[..], &x[x.len() / 2..]];
        prop_assert!(burg(&segments, order).reflection.iter().all(|k| k.abs() < 1.0));
        let model = covariance(&segments, order);
        prop_assert!(is_stable(&model.coefficients));
        prop_assert!(model.error >= 0.0);
    }

    #[test]
    fn stabilizing_always_succeeds(a in vec(-4.0..4.0f64, 0..10)) {
        prop_assert!(is_stable(&stabilize(&a)));
    }

    #[test]
    fn line_spectral_frequencies_ascend_and_convert_back(k in vec(-0.9..0.9f64, 1..=10)) {
        let a = reflection_to_coefficients(&k);
        let lsf = line_spectral_frequencies(&a).unwrap();
        prop_assert!(lsf.windows(2).all(|pair| pair[0] < pair[1]));
        prop_assert!(lsf[0] > 0.0 && lsf[lsf.len() - 1] < std::f64::consts::PI);
        let back = from_line_spectral_frequencies(&lsf).unwrap();
        let scale = a.iter().fold(1.0, |m: f64, a| m.max(a.abs()));
        prop_assert!(largest_difference(&a, &back) < 1e-10 * scale);
    }

    #[test]
    fn line_spectral_frequencies_hold_to_order_64(k in vec(-0.3..0.3f64, 64)) {
        let a = reflection_to_coefficients(&k);
        let back = line_spectral_frequencies(&a).and_then(|w| from_line_spectral_frequencies(&w));
        let error = largest_difference(&a, &back.unwrap());
        prop_assert!(error < 1e-9, "{error}");
    }

    #[test]
    fn means_of_line_spectra_are_stable(
        k in vec((-0.95..0.95f64, -0.95..0.95f64), 6),
        t in 0.0..1.0f64,
    ) {
        let (k, l): (Vec<f64>, Vec<f64>) = k.into_iter().unzip();
        let lines = |k: &[f64]| line_spectral_frequencies(&reflection_to_coefficients(k)).unwrap();
        let (v, w) = (lines(&k), lines(&l));
        let mean: Vec<f64> = v.iter().zip(&w).map(|(v, w)| v * (1.0 - t) + w * t).collect();
        prop_assert!(is_stable(&from_line_spectral_frequencies(&mean).unwrap()));
    }

    #[test]
    fn cosine_transform_is_orthonormal(x in vec(-10.0..10.0f64, 1..60)) {
        let (mut c, mut back) = (vec![0.0; x.len()], vec![0.0; x.len()]);
        dct_ii(&x, &mut c);
        InverseDct::new(x.len()).run(&c, &mut back);
        prop_assert!(largest_difference(&x, &back) < 1e-11);
        let power = |v: &[f64]| v.iter().map(|v| v * v).sum::<f64>();
        prop_assert!((power(&x) - power(&c)).abs() <= 1e-11 * (1.0 + power(&x)));
    }

    #[test]
    fn pseudo_inverse_inverts_attainable_right_sides(
        matrix in vec(-1.0..1.0f64, 24),
        y in vec(-1.0..1.0f64, 4),
    ) {
        // A wide matrix, almost surely of full rank: the pseudo-inverse solves every right-hand
        // side.
        let inverse = PseudoInverse::new(&matrix, 4, 6);
        prop_assume!(inverse.rank() == 4);
        let mut x = [0.0; 6];
        inverse.apply(&y, &mut x);
        let size = x.iter().fold(1.0, |m: f64, x| m.max(x.abs()));
        for (row, y) in matrix.chunks(6).zip(&y) {
            let reached: f64 = row.iter().zip(&x).map(|(a, x)| a * x).sum();
            prop_assert!((reached - y).abs() < 1e-10 * size);
        }
    }

    #[test]
    fn blocks_do_not_change_a_filter(
        x in vec(-1.0..1.0f64, 1..200),
        cut in 0usize..200,
        fc in 1.0..990.0f64,
        order in 1usize..=20,
    ) {
        let sections = butterworth::low_pass(order, fc, 2000.0).unwrap();
        let (mut whole, mut parts) = (x.clone(), x.clone());
        Cascade::new(&sections).process(&mut whole);
        let mut cascade = Cascade::new(&sections);
        let (head, tail) = parts.split_at_mut(cut.min(x.len()));
        cascade.process(head);
        tail.iter_mut().for_each(|x| *x = cascade.tick(*x));
        prop_assert_eq!(whole, parts);
    }

    #[test]
    fn selected_peaks_stand_apart(m in vec(0.0..1.0f64, 0..197), count in 0usize..20) {
        let f: Vec<f64> = (0..197).map(|i| 20.0 + 5.0 * f64::from(i)).collect();
        let peaks = select_peaks(&f, &m, count, FREQUENCY_JND);
        prop_assert!(peaks.len() <= count);
        for pair in peaks.windows(2) {
            let (low, high) = (pair[0].frequency_hz, pair[1].frequency_hz);
            prop_assert!((high - low) / low >= FREQUENCY_JND);
        }
    }
}
