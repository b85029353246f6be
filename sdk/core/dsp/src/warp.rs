//! Reads a stream of samples faster or slower, at a ratio that may change at any sample.
//!
//! A player reads a texture faster or slower if the current motion differs from the motion for
//! which the voice was created. If the two motions are the same, the ratio is 1, and samples pass
//! through this reader unchanged and at no cost ([`Warp::when_needed`]). The interpolation also
//! needs samples after the current position. This causes no delay, because the reader pulls these
//! samples from its source in advance. The interpolation kernel has 8 to 32 taps, as many as are
//! needed to separate the source's highest frequency from its image.

use alloc::sync::Arc;
use alloc::vec::Vec;

use crate::kernels::{self, kaiser_length};
use crate::wide::{Work, wide};

/// Maximum number of source samples from which an output is computed. Above the source's Nyquist
/// frequency, the attenuation is about 60 dB.
const MOST_TAPS: usize = 32;
/// The number of taps is a multiple of this.
const LANES: usize = 8;
/// Bits of a position that select the row of the kernel table. Between two rows the kernel is
/// interpolated.
const PHASE_BITS: u32 = 8;
/// Maximum number of outputs read at a time.
const CHUNK: usize = 64;
/// The same as [`PHASE_BITS`], but for a reader that starts to interpolate only when this is
/// needed. Computing its table takes an eighth of the time. The interpolation error between its
/// rows is -60 dB at 0.4 of the source's rate, and -98 dB at 0.05.
const FEW_PHASE_BITS: u32 = 5;

/// Reads a stream of samples at a variable ratio, by windowed-sinc interpolation. Like
/// [`crate::resample::Resampler`], the reader pulls samples from the source and gives the same
/// samples for any block size.
///
/// ```
/// use htex_dsp::warp::Warp;
/// let mut n = 0.0;
/// let mut ramp = |block: &mut [f32]| for sample in block { *sample = n; n += 1.0; };
/// let mut out = [0.0; 3];
/// Warp::through().process(1.0, &mut out, &mut ramp);
/// assert_eq!(out, [0.0, 1.0, 2.0]);
/// ```
#[derive(Debug, Clone)]
pub struct Warp {
    taps: usize,
    phase_bits: u32,
    /// One row of `taps` coefficients per phase, plus one row. If there is only one tap, the kernel
    /// is not used.
    kernel: Arc<[f32]>,
    /// Distance from `start` to the next output, in units of 2⁻⁶⁴ source samples.
    place: u64,
    history: Vec<f32>,
    start: usize,
    filled: usize,
    /// Whether the reader interpolates. If false, the source passes through unchanged.
    reads: bool,
}

impl Warp {
    /// Makes a reader for a source without content above `top` (0 to 0.5) times the source's rate.
    /// A change of the ratio takes effect after half a kernel (4 to 16 source samples).
    pub fn new(top: f64) -> Self {
        Self::with_taps(taps(top), PHASE_BITS)
    }

    /// Makes a reader that supports only the ratio 1. The source passes through without delay.
    pub fn through() -> Self {
        Self::with_taps(1, 0)
    }

    /// Makes a reader that starts to interpolate only when it is needed. While the ratio is 1, the
    /// source passes through bit-identical and without delay. When another ratio occurs for the
    /// first time, the reader starts to interpolate at the current position, and interpolates from
    /// then on.
    pub fn when_needed(top: f64) -> Self {
        let mut warp = Self::with_taps(taps(top), FEW_PHASE_BITS);
        // The samples before the first sample of the source count as zeros.
        warp.filled = warp.before();
        warp.reads = false;
        warp
    }

    fn with_taps(taps: usize, phase_bits: u32) -> Self {
        Self {
            taps,
            phase_bits,
            kernel: kernels::kernel(taps, 1 << phase_bits, false, 0.5),
            place: 0,
            history: alloc::vec![0.0; taps + CHUNK],
            start: 0,
            filled: 0,
            reads: true,
        }
    }

    /// Number of samples that a window contains before the position that is read.
    fn before(&self) -> usize {
        self.taps / 2 - 1
    }

    /// Fills `out`. Each output lies `ratio` source samples (0 to 1,000) after the output before
    /// it. With a `ratio` above 1, source frequencies above the output's Nyquist frequency are
    /// aliased. Pulls no more samples than `out` needs. Does not allocate.
    pub fn process(&mut self, ratio: f64, out: &mut [f32], source: &mut dyn FnMut(&mut [f32])) {
        if !self.reads {
            if ratio == 1.0 {
                source(out);
                return self.remember(out);
            }
            self.reads = true;
        }
        let whole = ratio as usize;
        // In units of 2⁻⁶⁴. The factor is below 1, so the product cannot round up to 2⁶⁴.
        let step = (whole, ((ratio - whole as f64) * 18_446_744_073_709_551_616.0) as u64);
        let mut rest = out;
        while !rest.is_empty() {
            let done = self.piece(step, rest, source);
            rest = &mut rest[done..];
        }
    }

    /// Reads as many samples as the windows in one pull allow; returns their number.
    fn piece(
        &mut self,
        (whole, part): (usize, u64),
        out: &mut [f32],
        source: &mut dyn FnMut(&mut [f32]),
    ) -> usize {
        self.skip(source);
        let mut places = [ReadPosition::default(); CHUNK];
        let (mut count, mut last) = (0, 0);
        for place in places.iter_mut().take(out.len()) {
            if self.start + self.taps > self.history.len() {
                break;
            }
            last = self.start;
            *place = ReadPosition { start: last, between: self.place };
            count += 1;
            let carry;
            (self.place, carry) = self.place.overflowing_add(part);
            self.start += whole + usize::from(carry);
        }
        // The source is called only once, here, because only now the number of samples that all
        // windows need is known.
        self.pull(last + self.taps, source);
        wide(Windows { warp: self, places: &places[..count], out: &mut out[..count] });
        count
    }

    /// Stores the samples that precede the next sample.
    fn remember(&mut self, block: &[f32]) {
        let before = self.before();
        let new = block.len().min(before);
        self.history.copy_within(new..before, 0);
        self.history[before - new..before].copy_from_slice(&block[block.len() - new..]);
    }

    /// Drops samples before the next window. If the window begins after the samples in the history,
    /// reads and discards source samples.
    fn skip(&mut self, source: &mut dyn FnMut(&mut [f32])) {
        while self.start > self.filled {
            let end = self.history.len().min(self.start - self.filled);
            source(&mut self.history[..end]);
            (self.start, self.filled) = (self.start - self.filled - end, 0);
        }
        self.history.copy_within(self.start..self.filled, 0);
        (self.filled, self.start) = (self.filled - self.start, 0);
    }

    /// Fills the history up to `end`.
    fn pull(&mut self, end: usize, source: &mut dyn FnMut(&mut [f32])) {
        if end > self.filled {
            source(&mut self.history[self.filled..end]);
            self.filled = end;
        }
    }
}

/// Window length for a source without content above `top` times its rate. Its images begin at `1 -
/// top`.
fn taps(top: f64) -> usize {
    let taps = kaiser_length((1.0 - 2.0 * top).max(1e-6)).next_multiple_of(LANES);
    taps.min(MOST_TAPS)
}

/// Position of an output: the start of its window in the history, and the position between two
/// source samples as a fraction.
#[derive(Debug, Clone, Copy, Default)]
struct ReadPosition {
    start: usize,
    between: u64,
}

/// Samples to be read, with their windows.
struct Windows<'a> {
    warp: &'a Warp,
    places: &'a [ReadPosition],
    out: &'a mut [f32],
}

impl Work for Windows<'_> {
    #[inline(always)]
    fn run(self) {
        match self.warp.taps {
            1 => self.copy(),
            8 => self.read::<8>(),
            16 => self.read::<16>(),
            24 => self.read::<24>(),
            _ => self.read::<MOST_TAPS>(),
        }
    }
}

impl Windows<'_> {
    #[inline(always)]
    fn copy(self) {
        for (sample, place) in self.out.iter_mut().zip(self.places) {
            *sample = self.warp.history[place.start];
        }
    }

    #[inline(always)]
    fn read<const TAPS: usize>(self) {
        let bits = self.warp.phase_bits;
        let rows = self.warp.kernel.as_chunks::<TAPS>().0;
        for (sample, place) in self.out.iter_mut().zip(self.places) {
            let row = (place.between >> (64 - bits)) as usize;
            // A single-precision number holds 24 bits exactly.
            let between = (place.between << bits >> 40) as f32 / (1u32 << 24) as f32;
            let window = &self.warp.history[place.start..][..TAPS];
            *sample = dot_between([&rows[row], &rows[row + 1]], between, window);
        }
    }
}

/// Dot product of a window and an interpolated row, in eight lanes.
#[inline(always)]
fn dot_between<const TAPS: usize>(
    [row, next]: [&[f32; TAPS]; 2],
    between: f32,
    window: &[f32],
) -> f32 {
    let mut lanes = [0.0f32; LANES];
    for start in (0..TAPS).step_by(LANES) {
        for (i, lane) in lanes.iter_mut().enumerate() {
            let (a, b) = (row[start + i], next[start + i]);
            *lane += (a + between * (b - a)) * window[start + i];
        }
    }
    (lanes[0] + lanes[4]) + (lanes[1] + lanes[5]) + ((lanes[2] + lanes[6]) + (lanes[3] + lanes[7]))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sine(f: f64) -> impl FnMut(&mut [f32]) {
        let mut n = 0.0;
        move |block: &mut [f32]| {
            for x in block {
                *x = libm::sin(core::f64::consts::TAU * f * n) as f32;
                n += 1.0;
            }
        }
    }

    #[test]
    fn a_sine_keeps_its_amplitude_and_follows_the_ratio() {
        let mut warp = Warp::new(0.5);
        let mut source = sine(0.05);
        let (mut place, mut worst) = (MOST_TAPS as f64 / 2.0 - 1.0, 0.0f64);
        for i in 0..4_000 {
            let ratio = 0.2 + 1.3 * f64::from(i % 700) / 700.0;
            let mut out = [0.0f32];
            warp.process(ratio, &mut out, &mut source);
            let expected = libm::sin(core::f64::consts::TAU * 0.05 * place);
            worst = worst.max((f64::from(out[0]) - expected).abs());
            place += ratio;
        }
        assert!(worst < 1e-3, "{worst}");
    }

    #[test]
    fn pass_through_at_ratio_one_is_bit_identical() {
        let (mut direct, mut through) = ([0.0f32; 100], [0.0f32; 100]);
        sine(0.123)(&mut direct);
        let (mut warp, mut source) = (Warp::through(), sine(0.123));
        for block in through.chunks_mut(7) {
            warp.process(1.0, block, &mut source);
        }
        assert_eq!(direct, through);
    }

    #[test]
    fn interpolation_starts_at_the_current_position() {
        let rendered = |sizes: &[usize]| {
            let (mut warp, mut source) = (Warp::when_needed(0.5), sine(0.05));
            let mut out = [0.0f32; 600];
            let (still, moving) = out.split_at_mut(100);
            for (part, ratio) in [(still, 1.0), (moving, 1.3)] {
                let mut rest = part;
                for size in sizes.iter().cycle() {
                    let (block, behind) = rest.split_at_mut(rest.len().min(*size));
                    warp.process(ratio, block, &mut source);
                    rest = behind;
                    if rest.is_empty() {
                        break;
                    }
                }
            }
            out
        };
        let out = rendered(&[600]);
        assert_eq!(out, rendered(&[1, 7, 40]));
        let mut direct = [0.0f32; 100];
        sine(0.05)(&mut direct);
        assert_eq!(out[..100], direct);
        for (n, x) in out.iter().enumerate() {
            let place = n.min(100) as f64 + 1.3 * n.saturating_sub(100) as f64;
            let expected = libm::sin(core::f64::consts::TAU * 0.05 * place);
            assert!((f64::from(*x) - expected).abs() < 1e-3, "{n}: {x}");
        }
    }

    #[test]
    fn large_ratios_skip_samples() {
        let mut warp = Warp::new(0.5);
        let mut out = [0.0f32; 8];
        warp.process(1_000.0, &mut out, &mut sine(0.001));
        // Each output is a whole period after the one before.
        let expected = libm::sin(core::f64::consts::TAU * 0.001 * (MOST_TAPS as f64 / 2.0 - 1.0));
        let near = |x: &f32| (f64::from(*x) - expected).abs() < 1e-3;
        assert!(out.iter().all(near), "{out:?}");
    }
}
