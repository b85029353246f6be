//! The distribution of Kolmogorov's D.

use crate::distributions::normal_cdf;

/// Above this number of values the limiting distribution is used.
const EXACT: usize = 4000;

/// Probability that the largest distance between a distribution and that of `n` values from it is at least `d`: the two-sided p-value.
///
/// Exact up to 4000 values: by Marsaglia, Tsang and Wang (2003), and where n d^2 is above 4 as twice the one-sided probability, whose
/// relative error is below 1e-7 there and falls with d (Simard and L'Ecuyer 2011). For more values by Kolmogorov's limit with
/// Vrbik's correction (2018).
pub fn kolmogorov_sf(n: usize, d: f64) -> f64 {
    let count = n as f64;
    let p = if d <= 0.5 / count {
        1.0
    } else if d >= 1.0 {
        0.0
    } else if n > EXACT {
        limit(libm::sqrt(count) * d, count)
    } else if d >= 0.5 || count * d * d > 4.0 {
        2.0 * one_sided(n, d)
    } else {
        1.0 - cdf(n, d)
    };
    p.clamp(0.0, 1.0)
}

/// Birnbaum and Tingey's formula (1951) for one side; all terms are positive.
fn one_sided(n: usize, d: f64) -> f64 {
    let count = n as f64;
    let term = |j: usize| {
        let (j, choose) = (j as f64, log_choose(count, j as f64));
        let low = d + j / count;
        let high = 1.0 - low;
        if high <= 0.0 {
            return if j == count { 1.0 / low } else { 0.0 };
        }
        libm::exp(choose + (j - 1.0) * libm::log(low) + (count - j) * libm::log(high))
    };
    let last = (count * (1.0 - d)).floor() as usize;
    d * (0..=last.min(n)).map(term).sum::<f64>()
}

fn log_choose(n: f64, k: f64) -> f64 {
    libm::lgamma(n + 1.0) - libm::lgamma(k + 1.0) - libm::lgamma(n - k + 1.0)
}

/// Marsaglia, Tsang and Wang: n! / n^n times the middle entry of H^n.
fn cdf(n: usize, d: f64) -> f64 {
    let scaled = n as f64 * d;
    let k = scaled.floor() as usize + 1;
    let matrix = Scaled::new(step_matrix(k, k as f64 - scaled));
    let power = matrix.power(n);
    let mut value = power.rows[k - 1][k - 1];
    let mut exponent = power.exponent;
    for i in 1..=n {
        value *= i as f64 / n as f64;
        if value < 1e-140 {
            value *= 1e140;
            exponent -= 140;
        }
    }
    value * libm::pow(10.0, f64::from(exponent))
}

/// The matrix H of size 2 k - 1, for h = k - n d.
fn step_matrix(k: usize, h: f64) -> Vec<Vec<f64>> {
    let size = 2 * k - 1;
    let mut rows: Vec<Vec<f64>> = (0..size)
        .map(|i| {
            (0..size)
                .map(|j| if j <= i + 1 { 1.0 } else { 0.0 })
                .collect()
        })
        .collect();
    for i in 0..size {
        rows[i][0] -= libm::pow(h, (i + 1) as f64);
        rows[size - 1][i] -= libm::pow(h, (size - i) as f64);
    }
    if 2.0 * h > 1.0 {
        rows[size - 1][0] += libm::pow(2.0 * h - 1.0, size as f64);
    }
    for (i, row) in rows.iter_mut().enumerate() {
        for (j, value) in row.iter_mut().enumerate().take(i + 1) {
            *value /= libm::exp(libm::lgamma((i + 2 - j) as f64));
        }
    }
    rows
}

/// A matrix times a power of ten.
#[derive(Clone)]
struct Scaled {
    rows: Vec<Vec<f64>>,
    exponent: i32,
}

impl Scaled {
    fn new(rows: Vec<Vec<f64>>) -> Self {
        Self { rows, exponent: 0 }
    }

    fn times(&self, other: &Self) -> Self {
        let size = self.rows.len();
        let mut rows = vec![vec![0.0; size]; size];
        for (out, left) in rows.iter_mut().zip(&self.rows) {
            for (factor, right) in left.iter().zip(&other.rows) {
                let pairs = out.iter_mut().zip(right);
                pairs.for_each(|(sum, value)| *sum += factor * value);
            }
        }
        let mut exponent = self.exponent + other.exponent;
        if rows[size / 2][size / 2] > 1e140 {
            rows.iter_mut().flatten().for_each(|v| *v *= 1e-140);
            exponent += 140;
        }
        Self { rows, exponent }
    }

    fn power(&self, n: usize) -> Self {
        if n == 1 {
            return self.clone();
        }
        let half = self.power(n / 2);
        let square = half.times(&half);
        if n.is_multiple_of(2) {
            square
        } else {
            square.times(self)
        }
    }
}

/// Kolmogorov's limiting distribution, for x = sqrt(n) d.
fn limit(x: f64, n: f64) -> f64 {
    let x = x + 1.0 / (6.0 * libm::sqrt(n)) + (x - 1.0) / (4.0 * n);
    if x < 0.2 {
        return 1.0;
    }
    let term = |k: i32| {
        let sign = if k % 2 == 1 { 2.0 } else { -2.0 };
        sign * libm::exp(-2.0 * f64::from(k * k) * x * x)
    };
    (1..=40).map(term).sum()
}

/// Largest distance between the distribution of `sorted` values and the standard normal.
pub(crate) fn distance_from_normal(sorted: &[f64]) -> f64 {
    let n = sorted.len() as f64;
    let gap = |(index, value): (usize, &f64)| {
        let (cdf, i) = (normal_cdf(*value), index as f64);
        (cdf - i / n).max((i + 1.0) / n - cdf)
    };
    sorted.iter().enumerate().map(gap).fold(0.0, f64::max)
}
