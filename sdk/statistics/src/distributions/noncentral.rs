//! The noncentral F distribution.

use super::{beta, beta_point};

/// Upper tail of noncentral F above `f`, with noncentrality `lambda` of at least 0.
///
/// A Poisson mixture of incomplete beta functions (Johnson, Kotz and Balakrishnan 1995, section 30.2): the upper tails of beta
/// with shapes df1 / 2 + j and df2 / 2, weighted by the probabilities of j with mean lambda / 2. It is summed outwards from the largest weight.
pub fn noncentral_f_sf(f: f64, df: [f64; 2], lambda: f64) -> f64 {
    let mean = lambda / 2.0;
    let tail = |j: f64| {
        let (x, y) = beta_point(f, df);
        beta::tails(df[0] / 2.0 + j, df[1] / 2.0, x, y).1
    };
    // Tails grow with j: where the first that has weight is 1, so are the others.
    let first = (mean - 9.0 * libm::sqrt(mean) - 9.0).floor().max(0.0);
    if tail(first) == 1.0 {
        return 1.0;
    }
    let mode = mean.floor();
    let start = poisson(mode, mean);
    (sum_up(mode, mean, start, &tail) + sum_down(mode, mean, start, &tail)).clamp(0.0, 1.0)
}

fn sum_up(mode: f64, mean: f64, start: f64, tail: &impl Fn(f64) -> f64) -> f64 {
    let (mut j, mut weight, mut sum) = (mode, start, 0.0);
    while weight > start * 1e-18 {
        sum += weight * tail(j);
        j += 1.0;
        weight *= mean / j;
    }
    sum
}

fn sum_down(mode: f64, mean: f64, start: f64, tail: &impl Fn(f64) -> f64) -> f64 {
    let (mut j, mut weight, mut sum) = (mode, start, 0.0);
    while j > 0.0 && weight > start * 1e-18 {
        weight *= j / mean;
        j -= 1.0;
        sum += weight * tail(j);
    }
    sum
}

fn poisson(j: f64, mean: f64) -> f64 {
    if mean == 0.0 {
        return 1.0;
    }
    libm::exp(j * libm::log(mean) - mean - libm::lgamma(j + 1.0))
}
