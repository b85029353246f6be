//! Repeatability: how much the spectra of one texture differ between blocks of time.
//!
//! Overlapping windows share samples. One could compute the repeatability from two spectra, one of
//! the odd windows and one of the even windows. But windows overlap, so the two spectra would share
//! samples, and the difference between them would be several times too small. This module uses
//! blocks of time instead, because blocks share no samples. Each block lasts up to a second. The
//! difference between blocks therefore includes the drift of texture, finger and motion within
//! about a second.

use htex_dsp::Band;
use htex_dsp::bands::{BAND_COUNT, BandBank, band_error_db, rms};
use htex_dsp::fidelity::third_octave_error_rms_db;
use htex_dsp::spectrum::Complex;

use crate::spectrum::{Averaging, SegmentSpectra, average, spans_of};

/// Shortest and longest block, counted in segments of 0.2 s. The lengths are 0.2 and 1 s.
const BLOCK: [f64; 2] = [1.0, 5.0];
/// Fewest blocks that are compared.
const FEWEST: usize = 4;
/// Tolerance of times, in segments.
const TOLERANCE: f64 = 1e-9;

/// The part of a recording from which one spectrum was taken, in segments of 0.2 s from the
/// beginning of the recording.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Span {
    /// Index of the recording.
    pub(crate) take: usize,
    pub(crate) from: f64,
    pub(crate) to: f64,
}

/// The expected difference between the spectra of two recordings of one texture, decibels. It is
/// computed from two spectra, one of the odd blocks and one of the even blocks. It is the RMS of
/// the difference of these spectra, divided by √2.
///
/// Each of the two spectra averages n/2 blocks, so its random error is √2 times the error of an
/// average over all n blocks. The division by √2 corrects for this.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Repeatability {
    /// The RMS over nine bands.
    pub band_rms_db: f64,
    /// The RMS over third octaves; `None` if the texture's band contains no third octave with
    /// energy.
    pub third_octave_rms_db: Option<f64>,
}

/// Returns the repeatability of a texture. `None` if there are fewer than four blocks, or half of
/// them are silent.
pub(crate) fn repeatability(
    band: Band,
    spectra: &[&[Complex<f64>]],
    spans: &[Span],
    averaging: Averaging,
) -> Option<Repeatability> {
    let blocks = blocks(spans)?;
    let grid = band.grid_hz();
    let half = |parity: usize| {
        let of_half =
            blocks.iter().zip(spectra).filter(|(block, _)| block.is_some_and(|b| b % 2 == parity));
        let half: Vec<&[Complex<f64>]> = of_half.map(|(_, spectrum)| *spectrum).collect();
        average(&half, grid.len(), averaging)
    };
    let (odd, even) = (half(0), half(1));
    let bank = BandBank::new(BAND_COUNT, band, &grid);
    let nine_db = rms(&band_error_db(&bank.energies(&odd), &bank.energies(&even)));
    let third_db = third_octave_error_rms_db(&grid, &even, &odd);
    // A difference is not finite if half of the blocks are silent.
    let of_all = |db: f64| Some(db / std::f64::consts::SQRT_2).filter(|db| db.is_finite());
    Some(Repeatability {
        band_rms_db: of_all(nine_db)?,
        third_octave_rms_db: third_db.and_then(of_all),
    })
}

/// Returns the block of each span, counted from 0. A span that shares samples with two blocks gets
/// `None`. If there are fewer than four blocks, the whole result is `None`. Spans must be in the
/// order of their recordings and times.
///
/// Each stretch of overlapping spans is cut into equal blocks. The length of a block is at most a
/// quarter of the total length that is read, limited to the range from 0.2 to 1 s. Only one segment
/// of a sweep is read, so each sweep is one block.
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

/// Appends the blocks of a stretch, numbered from `count`, and returns the next number. A span
/// belongs to the block that contains its middle, unless it shares samples with an earlier block.
fn cut(stretch: &[Span], longest: f64, mut count: usize, blocks: &mut Vec<Option<usize>>) -> usize {
    let (start, length) = (earliest(stretch), length(stretch));
    // If a block were shorter than a segment, it would share samples with the next block.
    let most = libm::floor(length + TOLERANCE);
    // A length may differ from a whole number of segments only in its last digit. In this case,
    // `libm` and the tolerance keep the number of blocks the same on all processors.
    let parts = libm::ceil(length / longest - TOLERANCE).min(most).max(1.0);
    // Three values: the part number of the open block, the end of its spans so far, and the end of
    // all earlier blocks.
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

/// Returns the stretches of overlapping spans.
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

/// Returns the mean power of each block of recordings at one condition, on the grid of their band;
/// `None` if there are fewer than four blocks.
pub(crate) fn block_power(parts: &[SegmentSpectra]) -> Option<Vec<Vec<f64>>> {
    let spans: Vec<Span> = parts.iter().enumerate().flat_map(spans_of).collect();
    let of_spans = blocks(&spans)?;
    let mut powers = Vec::<(Vec<f64>, f64)>::new();
    for (spectrum, block) in parts.iter().flat_map(|part| &part.spectra).zip(of_spans) {
        let Some(block) = block else { continue };
        if block >= powers.len() {
            powers.resize(block + 1, (vec![0.0; spectrum.len()], 0.0));
        }
        let (power, count) = &mut powers[block];
        power.iter_mut().zip(spectrum).for_each(|(sum, bin)| *sum += bin.norm_sqr());
        *count += 1.0;
    }
    let mean = |(power, count): (Vec<f64>, f64)| power.into_iter().map(|p| p / count).collect();
    Some(powers.into_iter().map(mean).collect())
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

    /// Number of windows in each block.
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
        // The lengths are 10 s, 2 s, 0.8 s and 0.7 s.
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
        // There are two recordings. A part of the first recording is not read.
        let takes: Vec<Span> =
            windows(0, 0.0, 9).chain(windows(0, 40.0, 9)).chain(windows(1, 0.0, 9)).collect();
        assert_eq!(counts(&takes), Some(vec![4; 6]));
    }
}
