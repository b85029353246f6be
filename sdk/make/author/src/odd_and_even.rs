//! Odd and even blocks of time in recordings. The odd blocks give one spectrum of a texture and the
//! even blocks another. The two spectra share no sample.

use htex_dsp::spectrum::Complex;

use crate::blocks::{Span, blocks};
use crate::segments::SEGMENTS_PER_S;
use crate::spectrum::spans_of;
use crate::{Averaging, SegmentSpectra, TextureSpectrum};

/// The spectra of the odd blocks and of the even blocks.
#[derive(Debug, Clone)]
pub(crate) struct OddAndEven {
    /// The average over the first, third, … block.
    pub(crate) odd: TextureSpectrum,
    /// The average over the second, fourth, … block.
    pub(crate) even: TextureSpectrum,
    /// Number of odd and even blocks together.
    pub(crate) blocks: usize,
    /// Length of the longest block, 0.2 to 1 s.
    pub(crate) block_s: f64,
}

/// Cuts the segments of recordings at one condition into equal blocks, as for repeatability
/// ([`TextureSpectrum::repeatability_rms_db`]). Averages the odd and the even blocks separately.
///
/// `None` if there are fewer than four blocks, or if quantities or bands differ.
pub(crate) fn odd_and_even(parts: &[SegmentSpectra], averaging: Averaging) -> Option<OddAndEven> {
    let first = parts.first()?;
    let differs =
        |part: &SegmentSpectra| (part.quantity, part.band) != (first.quantity, first.band);
    if parts.iter().any(differs) {
        return None;
    }
    let spans: Vec<Span> = parts.iter().enumerate().flat_map(spans_of).collect();
    let of_spans = blocks(&spans)?;
    let spectra = parts.iter().flat_map(|part| &part.spectra);
    let all: Vec<(&[Complex<f64>], Span, usize)> = spectra
        .zip(&spans)
        .zip(&of_spans)
        // A segment that lies in two blocks is left out. Otherwise, odd and even blocks would share
        // samples.
        .filter_map(|((spectrum, span), block)| Some((spectrum.as_slice(), *span, (*block)?)))
        .collect();
    let half = |parity: usize| {
        let own = all.iter().filter(|(.., block)| block % 2 == parity);
        let (spectra, spans): (Vec<_>, Vec<_>) =
            own.map(|(spectrum, span, _)| (*spectrum, *span)).unzip();
        TextureSpectrum::from_segments(first.quantity, first.band, &spectra, &spans, averaging)
    };
    let count = 1 + all.iter().map(|(.., block)| *block).max()?;
    let longest = (0..count).map(|number| {
        let own = all.iter().filter(move |(.., block)| *block == number);
        let [from, to] = own.fold([f64::MAX, f64::MIN], |[from, to], (_, span, _)| {
            [from.min(span.from), to.max(span.to)]
        });
        to - from
    });
    Some(OddAndEven {
        odd: half(0),
        even: half(1),
        blocks: count,
        block_s: longest.fold(0.0, f64::max) / SEGMENTS_PER_S,
    })
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
    fn lengths_of_blocks() {
        // Seconds read, number of blocks, and length of each block.
        for (seconds, count, block_s) in
            [(0.7, None, 0.0), (0.8, Some(4), 0.2), (2.0, Some(4), 0.5), (10.0, Some(10), 1.0)]
        {
            let part = read(seconds).unwrap_or_else(|e| panic!("{e}"));
            let found = odd_and_even(std::slice::from_ref(&part), Averaging::Rms);
            assert_eq!(found.as_ref().map(|f| f.blocks), count, "{seconds} s");
            let found_s = found.map_or(0.0, |found| found.block_s);
            assert!((found_s - block_s).abs() < 1e-9, "{found_s} for {block_s}");
        }
    }

    /// Each half averages its own segments, so the mean power of both halves is the mean power of
    /// all segments that are read.
    #[test]
    fn odd_and_even_are_two_readings() {
        let part = read(0.8).unwrap_or_else(|e| panic!("{e}"));
        let halves = odd_and_even(std::slice::from_ref(&part), Averaging::Rms);
        let Some(OddAndEven { odd, even, .. }) = halves else { panic!("four blocks of 0.2 s") };
        assert_eq!((odd.segments, even.segments), (2, 2));
        let power = |segment: usize, k: usize| part.spectra[segment][k].norm_sqr();
        for k in 0..odd.magnitude.len() {
            // Windows of 0.2 s begin every 0.1 s, and every second window is one block.
            let expected = [0.5 * (power(0, k) + power(4, k)), 0.5 * (power(2, k) + power(6, k))];
            let found = [&odd, &even].map(|half| half.magnitude[k].powi(2));
            for (a, b) in found.iter().zip(expected) {
                assert!((a / b - 1.0).abs() < 1e-9, "bin {k}");
            }
        }
    }
}
