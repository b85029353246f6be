//! A cache of the line spectral frequencies of filters.
//!
//! Computing these frequencies takes about ten times as long as all other steps of a parameter
//! change. While a motion is between the same conditions, the voice interpolates the same few
//! filters again and again, so a cache saves this time.

use htex_dsp::line_spectrum::lines_of_reflection;
use htex_dsp::linear_prediction::step_down_in_place;
use htex_model::Lock;

use crate::MAX_ORDER;

/// Highest order of a filter that is cached.
const KEPT_ORDER: usize = 32;
/// Number of buckets. A bucket holds [`PLACES`] cached filters.
const HASHES: usize = 16;
const PLACES: usize = 4;

static CACHE: Lock<LineCache> = Lock::new(LineCache::NONE);

/// The cached filters with their line spectral frequencies, bucket by bucket. A new filter replaces
/// the oldest filter in its bucket.
struct LineCache {
    filters: [[Filter; PLACES]; HASHES],
    oldest: [u8; HASHES],
}

#[derive(Clone, Copy)]
struct Filter {
    order: usize,
    coefficients: [f64; KEPT_ORDER],
    lines: [f64; KEPT_ORDER],
}

impl LineCache {
    const NONE: Self = {
        let none = Filter { order: 0, coefficients: [0.0; KEPT_ORDER], lines: [0.0; KEPT_ORDER] };
        Self { filters: [[none; PLACES]; HASHES], oldest: [0; HASHES] }
    };
}

/// Writes the line spectral frequencies of a filter, radians, one for each coefficient. Returns
/// false if the filter is not stable. The result does not depend on whether the filter was cached.
/// Does not allocate or wait.
pub(crate) fn write_lines(coefficients: &[f64], lines: &mut [f64]) -> bool {
    let order = coefficients.len();
    // The render thread must not wait for the lock. Computing the lines again gives the same bits.
    let kept = if (1..=KEPT_ORDER).contains(&order) { CACHE.try_lock() } else { None };
    let Some(mut kept) = kept else {
        return find_lines(coefficients, lines);
    };
    let hash = hash(coefficients);
    let same = |f: &&Filter| f.order == order && f.coefficients[..order] == *coefficients;
    if let Some(found) = kept.filters[hash].iter().find(same) {
        lines.copy_from_slice(&found.lines[..order]);
        return true;
    }
    if !find_lines(coefficients, lines) {
        return false;
    }
    let place = usize::from(kept.oldest[hash]) % PLACES;
    kept.oldest[hash] = (place as u8) + 1;
    let new = &mut kept.filters[hash][place];
    new.order = order;
    new.coefficients[..order].copy_from_slice(coefficients);
    new.lines[..order].copy_from_slice(lines);
    true
}

fn find_lines(coefficients: &[f64], lines: &mut [f64]) -> bool {
    let mut reflection = [0.0; MAX_ORDER];
    let reflection = &mut reflection[..coefficients.len()];
    reflection.copy_from_slice(coefficients);
    if !step_down_in_place(reflection) {
        return false;
    }
    for (line, found) in lines.iter_mut().zip(lines_of_reflection(reflection)) {
        *line = found;
    }
    true
}

/// Returns a hash of the bits of all coefficients.
fn hash(coefficients: &[f64]) -> usize {
    let mix = |hash: u64, a: &f64| {
        (hash.rotate_left(5) ^ a.to_bits()).wrapping_mul(0x9e37_79b9_7f4a_7c15)
    };
    (coefficients.iter().fold(0, mix) >> 32) as usize % HASHES
}
