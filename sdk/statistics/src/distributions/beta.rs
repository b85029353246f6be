//! The regularised incomplete beta function.

use std::f64::consts::PI;

/// Returns both tails of the beta distribution with shapes `a` and `b`: below `x` and above it, where `y` is 1 - x.
///
/// By the continued fraction of DLMF 8.17.22, evaluated with Lentz's method on the side of the mean where it converges quickly.
pub(super) fn tails(a: f64, b: f64, x: f64, y: f64) -> (f64, f64) {
    if x <= 0.0 {
        (0.0, 1.0)
    } else if y <= 0.0 {
        (1.0, 0.0)
    } else if x < (a + 1.0) / (a + b + 2.0) {
        let lower = smaller_tail(a, b, x, y);
        (lower, 1.0 - lower)
    } else {
        let upper = smaller_tail(b, a, y, x);
        (1.0 - upper, upper)
    }
}

fn smaller_tail(a: f64, b: f64, x: f64, y: f64) -> f64 {
    let tail = power_term(a, b, x, y) * fraction(a, b, x) / a;
    tail.clamp(0.0, 1.0)
}

/// x^a y^b / B(a, b), without the cancellation of three large log-gammas: each is Stirling's formula plus a small remainder.
fn power_term(a: f64, b: f64, x: f64, y: f64) -> f64 {
    let sum = a + b;
    if a < 8.0 || b < 8.0 {
        let log = a * libm::log(x) + b * libm::log(y) + libm::lgamma(sum)
            - libm::lgamma(a)
            - libm::lgamma(b);
        return libm::exp(log);
    }
    let log = a * log_ratio(x, a / sum, y, b / sum) + b * log_ratio(y, b / sum, x, a / sum);
    let remainder = stirling_remainder(sum) - stirling_remainder(a) - stirling_remainder(b);
    libm::exp(log + remainder) * libm::sqrt(a / sum * b / (2.0 * PI))
}

/// ln(x / mean), where `y` and `other` are the distances of both from 1; accurate when they are close.
fn log_ratio(x: f64, mean: f64, y: f64, other: f64) -> f64 {
    let difference = if x < y { x - mean } else { other - y };
    libm::log1p((difference / mean).max(-1.0))
}

/// ln gamma(z) less Stirling's formula, for z of at least 8 (DLMF 5.11.1).
fn stirling_remainder(z: f64) -> f64 {
    const TERMS: [f64; 8] = [
        1.0 / 12.0,
        -1.0 / 360.0,
        1.0 / 1260.0,
        -1.0 / 1680.0,
        1.0 / 1188.0,
        -691.0 / 360_360.0,
        1.0 / 156.0,
        -3617.0 / 122_400.0,
    ];
    let square = 1.0 / (z * z);
    TERMS
        .iter()
        .rev()
        .fold(0.0, |sum, term| sum * square + term)
        / z
}

fn fraction(a: f64, b: f64, x: f64) -> f64 {
    const TINY: f64 = 1e-300;
    let away = |value: f64| if value.abs() < TINY { TINY } else { value };
    let mut c = 1.0;
    let mut d = 1.0 / away(1.0 - (a + b) * x / (a + 1.0));
    let mut result = d;
    for step in 1..100_000 {
        let m = f64::from(step);
        let even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
        let odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
        let mut change = 1.0;
        for term in [even, odd] {
            d = 1.0 / away(1.0 + term * d);
            c = away(1.0 + term / c);
            change = c * d;
            result *= change;
        }
        if (change - 1.0f64).abs() < 1e-16 {
            break;
        }
    }
    result
}
