//! Odd and even blocks of time of what is read of recordings: two readings of a texture that share no sample.

use std::ops::Range;

use htex_dsp::spectrum::Complex;

use crate::segments::{SEGMENTS_PER_S, Segments};
use crate::{Averaging, SegmentSpectra, TextureSpectrum};

/// Fewest blocks: two for each half.
const FEWEST_BLOCKS: usize = 4;
/// Most half-overlapping segments of 0.2 s of a block: they span 1 s.
const MOST_SEGMENTS: usize = 9;
/// Least part of what the best length reads that a longer block must read.
const READ: f64 = 0.9;

/// The spectra of the odd and of the even blocks.
#[derive(Debug, Clone)]
pub struct OddAndEven {
    /// The average over the first, the third, … block.
    pub odd: TextureSpectrum,
    /// The average over the second, the fourth, … block.
    pub even: TextureSpectrum,
    /// Number of blocks of both together.
    pub blocks: usize,
    /// Length of a block, 0.2 to 1 s.
    pub block_s: f64,
}

/// Cuts what is read of recordings at one condition into equal blocks, and averages the odd and the even ones.
///
/// Blocks are whole segments of the recording, 0.2 s (one segment) to 1 s (nine, half-overlapping), so that a sweep's segment is a block of
/// its own. A segment that lies in two blocks is left out: blocks share no sample. Of the lengths that give four blocks or more, the
/// longest that reads nine tenths of what the best reads is taken.
///
/// `None` if no length gives four blocks, or quantities or bands differ.
pub fn odd_and_even(parts: &[SegmentSpectra], averaging: Averaging) -> Option<OddAndEven> {
    let first = parts.first()?;
    let differs = |part: &SegmentSpectra| {
        (part.quantity, part.band) != (first.quantity, first.band)
            || part.spectra.len() != part.segments.starts.len()
    };
    if parts.iter().any(differs) {
        return None;
    }
    let (segments, blocks) = longest(parts)?;
    let half = |skipped: usize| {
        let half = blocks.iter().skip(skipped).step_by(2);
        let spectra: Vec<&[Complex<f64>]> = half
            .flat_map(|(part, range)| &part.spectra[range.clone()])
            .map(Vec::as_slice)
            .collect();
        TextureSpectrum::of(first.quantity, first.band, &spectra, averaging)
    };
    let len = first.segments.len;
    Some(OddAndEven {
        odd: half(0),
        even: half(1),
        blocks: blocks.len(),
        block_s: span(segments, len) as f64 / (len as f64 * SEGMENTS_PER_S),
    })
}

/// A block: a recording, and which of its segments.
type Block<'a> = (&'a SegmentSpectra, Range<usize>);

/// Chooses the number of segments of a block, and returns it with the blocks.
fn longest(parts: &[SegmentSpectra]) -> Option<(usize, Vec<Block<'_>>)> {
    let cut = |count: usize| {
        let of = |part| {
            let own: &SegmentSpectra = part;
            blocks(&own.segments, count)
                .into_iter()
                .map(move |range| (own, range))
        };
        (count, parts.iter().flat_map(of).collect::<Vec<Block<'_>>>())
    };
    let enough = |(_, blocks): &(usize, Vec<Block<'_>>)| blocks.len() >= FEWEST_BLOCKS;
    let mut cuts: Vec<_> = (1..=MOST_SEGMENTS).map(cut).filter(enough).collect();
    // The unit is half a segment.
    let read = |(count, blocks): &(usize, Vec<Block<'_>>)| ((count + 1) * blocks.len()) as f64;
    let best = cuts.iter().map(read).fold(0.0, f64::max);
    let at = cuts.iter().rposition(|cut| read(cut) >= READ * best)?;
    Some(cuts.swap_remove(at))
}

/// Returns the blocks of `count` segments, each of which begins in the middle of the one before.
fn blocks(segments: &Segments, count: usize) -> Vec<Range<usize>> {
    let (starts, len) = (&segments.starts, segments.len);
    let (mut blocks, mut at) = (Vec::new(), 0);
    while let Some(own) = starts.get(at..at + count) {
        if own.windows(2).any(|pair| pair[1] - pair[0] != hop(len)) {
            at += 1;
            continue;
        }
        let end = own[0] + span(count, len);
        blocks.push(at..at + count);
        at += count;
        while starts.get(at).is_some_and(|start| *start < end) {
            at += 1;
        }
    }
    blocks
}

/// Samples from a segment to the next that overlaps it by half.
fn hop(len: usize) -> usize {
    len.div_ceil(2)
}

/// Samples of a block of `count` segments.
fn span(count: usize, len: usize) -> usize {
    (count - 1) * hop(len) + len
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Recording, SegmentChoice, SpectrumOptions, segment_spectra};

    const RATE_HZ: f64 = 4000.0;

    /// Noise that differs from second to second, read in windows.
    fn read(seconds: f64) -> Result<SegmentSpectra, crate::AuthorError> {
        let mut state = 1u32;
        let sample = |_| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state) / f64::from(u32::MAX) - 0.5
        };
        let samples = (0..(seconds * RATE_HZ) as usize).map(sample).collect();
        let recording = Recording::new("noise", RATE_HZ, vec![samples])?;
        let options = SpectrumOptions::default().with_segments(SegmentChoice::Windows);
        segment_spectra(&recording, &options)
    }

    #[test]
    fn blocks_are_equal_and_share_no_sample() {
        // Seconds read, blocks, and the length of each.
        for (seconds, count, block_s) in [
            (0.7, None, 0.0),
            (0.8, Some(4), 0.2),
            (2.0, Some(4), 0.5),
            (2.4, Some(4), 0.6),
            (10.0, Some(10), 1.0),
        ] {
            let part = read(seconds).unwrap_or_else(|e| panic!("{e}"));
            let found = odd_and_even(std::slice::from_ref(&part), Averaging::Rms);
            assert_eq!(found.as_ref().map(|f| f.blocks), count, "{seconds} s");
            let Some(found) = found else { continue };
            assert!((found.block_s - block_s).abs() < 1e-9, "{found:?}");
            let (segments, all) = longest(std::slice::from_ref(&part)).unwrap_or_default();
            let span = span(segments, part.segments.len);
            let starts: Vec<usize> = all
                .iter()
                .map(|(_, r)| part.segments.starts[r.start])
                .collect();
            assert!(starts.windows(2).all(|pair| pair[1] - pair[0] >= span));
        }
    }

    /// Each half averages its own segments: the mean power of both together is that of all that are read.
    #[test]
    fn odd_and_even_are_two_readings() {
        let part = read(0.8).unwrap_or_else(|e| panic!("{e}"));
        let halves = odd_and_even(std::slice::from_ref(&part), Averaging::Rms);
        let Some(OddAndEven { odd, even, .. }) = halves else {
            panic!("four blocks of 0.2 s")
        };
        assert_eq!((odd.segments, even.segments), (2, 2));
        let power = |segment: usize, k: usize| part.spectra[segment][k].norm_sqr();
        for k in 0..odd.magnitude.len() {
            // Windows of 0.2 s begin every 0.1 s: every second one is a block.
            let expected = [
                0.5 * (power(0, k) + power(4, k)),
                0.5 * (power(2, k) + power(6, k)),
            ];
            let found = [&odd, &even].map(|half| half.magnitude[k].powi(2));
            for (a, b) in found.iter().zip(expected) {
                assert!((a / b - 1.0).abs() < 1e-9, "bin {k}");
            }
        }
    }
}
