//! Repeatability: the difference between blocks of time of what is read of a texture.
//!
//! Windows that overlap share samples, and so would halves made of every second window: their
//! difference would be several times too small. Blocks share none. Each of them lasts up to a
//! second, so that a difference between them contains how the texture, the finger and the motion
//! drift, as far as it shows within a second.

use htex_dsp::Band;
use htex_dsp::bands::{BAND_COUNT, BandBank, band_error_db, rms};
use htex_dsp::spectrum::Complex;

use crate::averaging::{Averaging, average};

/// Shortest and longest block, in segments of 0.2 s: 0.2 to 1 s.
const BLOCK: [f64; 2] = [1.0, 5.0];
/// Fewest blocks that are compared.
const FEWEST: usize = 4;
/// Tolerance of times, in segments.
const TOLERANCE: f64 = 1e-9;

/// The part of a recording from which a spectrum was taken, in segments of 0.2 s from the
/// recording's beginning.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Span {
    /// Index of the recording.
    pub(crate) take: usize,
    pub(crate) from: f64,
    pub(crate) to: f64,
}

/// Returns the RMS over nine bands of the difference between the spectra of odd and of even blocks,
/// over √2, decibels: by as much two readings like this one differ. `None` if fewer than four
/// blocks are read, or half of them are silent.
///
/// Halves of n/2 blocks each have √2 times the deviation of all n blocks; the root takes that out.
pub(crate) fn repeatability_rms_db(
    band: Band,
    spectra: &[&[Complex<f64>]],
    spans: &[Span],
    averaging: Averaging,
) -> Option<f64> {
    let blocks = blocks(spans)?;
    let grid = band.grid_hz();
    let bank = BandBank::new(BAND_COUNT, band, &grid);
    let energies = |parity: usize| {
        let of_half =
            blocks.iter().zip(spectra).filter(|(block, _)| block.is_some_and(|b| b % 2 == parity));
        let half: Vec<&[Complex<f64>]> = of_half.map(|(_, spectrum)| *spectrum).collect();
        bank.energies(&average(&half, grid.len(), averaging))
    };
    let difference_db = rms(&band_error_db(&energies(0), &energies(1)));
    // If half of the blocks are silent, it is not finite.
    Some(difference_db / std::f64::consts::SQRT_2).filter(|db| db.is_finite())
}

/// Returns the block of each span, counted from 0; `None` for a span that shares samples with two
/// blocks, and for all if there are fewer than four blocks. Spans are in the order of their
/// recordings and times.
///
/// Each stretch of overlapping spans is cut into equal blocks of a quarter of what is read, but of
/// 0.2 to 1 s. Sweeps, of which one segment is read, are a block each.
pub(crate) fn blocks(spans: &[Span]) -> Option<Vec<Option<usize>>> {
    let stretches = stretches(spans);
    let read: f64 = stretches.iter().map(|stretch| length(stretch)).sum();
    let longest = (read / FEWEST as f64).clamp(BLOCK[0], BLOCK[1]);
    let mut blocks = Vec::with_capacity(spans.len());
    let mut count = 0;
    for stretch in stretches {
        count = cut(stretch, longest, count, &mut blocks);
    }
    (count >= FEWEST).then_some(blocks)
}

/// Appends the blocks of a stretch, counted from `count`, and returns the next number. A span
/// belongs to the block that its middle is in, unless it shares samples with an earlier block.
fn cut(stretch: &[Span], longest: f64, mut count: usize, blocks: &mut Vec<Option<usize>>) -> usize {
    let (start, length) = (earliest(stretch), length(stretch));
    let most = libm::floor(length + TOLERANCE);
    let parts = libm::ceil(length / longest - TOLERANCE).min(most).max(1.0);
    // The part of the block that is open, and the ends of what is in it and in those before it.
    let (mut open, mut end, mut closed) = (None, start, f64::NEG_INFINITY);
    for span in stretch {
        let middle = 0.5 * (span.from + span.to) - start;
        let part = libm::floor(middle / length * parts + TOLERANCE) as usize;
        let before = if open == Some(part) { closed } else { end };
        if open.is_some() && span.from < before - TOLERANCE {
            blocks.push(None);
            continue;
        }
        if open != Some(part) {
            (open, closed) = (Some(part), end);
            count += 1;
        }
        end = end.max(span.to);
        blocks.push(Some(count - 1));
    }
    count
}

/// Returns the stretches of spans that overlap.
fn stretches(spans: &[Span]) -> Vec<&[Span]> {
    let overlap =
        |a: &Span, b: &Span| a.take == b.take && b.from < a.to - TOLERANCE && a.from < b.to;
    spans.chunk_by(overlap).collect()
}

fn earliest(stretch: &[Span]) -> f64 {
    let from = stretch.iter().map(|span| span.from);
    from.fold(f64::INFINITY, f64::min)
}

fn length(stretch: &[Span]) -> f64 {
    let to = stretch.iter().map(|span| span.to);
    to.fold(f64::NEG_INFINITY, f64::max) - earliest(stretch)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Windows that overlap by half, in segments.
    fn windows(take: usize, from: f64, count: usize) -> impl Iterator<Item = Span> {
        (0..count).map(move |i| Span {
            take,
            from: from + 0.5 * i as f64,
            to: from + 0.5 * i as f64 + 1.0,
        })
    }

    /// The windows of each block of some spans.
    fn counts(spans: &[Span]) -> Option<Vec<usize>> {
        let blocks = blocks(spans)?;
        for (a, block) in spans.iter().zip(&blocks) {
            for (b, other) in spans.iter().zip(&blocks) {
                let shares = a.take == b.take && a.from < b.to - 1e-6 && b.from < a.to - 1e-6;
                let differ = block.is_some() && other.is_some() && block != other;
                assert!(!(shares && differ), "{a:?} {b:?}");
            }
        }
        let last = blocks.iter().flatten().max()?;
        let of = |block| blocks.iter().filter(|b| **b == Some(block)).count();
        Some((0..=*last).map(of).collect())
    }

    #[test]
    fn blocks_are_equal_and_share_no_sample() {
        let one = |count| counts(&windows(0, 0.0, count).collect::<Vec<_>>());
        // 10 s, 2 s, 0.8 s, 0.7 s.
        assert_eq!(one(99), Some(vec![9; 10]));
        assert_eq!(one(19), Some(vec![4; 4]));
        assert_eq!(one(7), Some(vec![1; 4]));
        assert_eq!(one(6), None);
        for count in 8..200 {
            let sizes = one(count).unwrap_or_default();
            let [least, most] = [sizes.iter().min(), sizes.iter().max()];
            assert!(sizes.len() >= 4 && most <= Some(&9) && least >= Some(&1));
        }
        let sweeps: Vec<Span> = (0..5).flat_map(|i| windows(0, 6.1 * f64::from(i), 1)).collect();
        assert_eq!(counts(&sweeps), Some(vec![1; 5]));
        assert_eq!(counts(&sweeps[..3]), None);
        // Two recordings, and a part between them that is not read.
        let takes: Vec<Span> =
            windows(0, 0.0, 9).chain(windows(0, 40.0, 9)).chain(windows(1, 0.0, 9)).collect();
        assert_eq!(counts(&takes), Some(vec![4; 6]));
    }
}
