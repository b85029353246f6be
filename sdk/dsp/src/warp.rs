//! Reading a stream faster or slower, by a ratio that may change all the time.

use alloc::sync::Arc;
use alloc::vec::Vec;

use crate::kernels;
use crate::polyphase::dot;

/// Samples of the source that one output looks at: stop band of about 60 dB.
const TAPS: usize = 32;
/// Rows of the kernel's table; between two rows it is interpolated.
const PHASES: usize = 256;
const CHUNK: usize = 64;
/// Rows for a reader that stands by. A row between two is 60 dB near at 0.4 of the source's rate, 98 dB at 0.05, and
/// the table is made in an eighth of the time.
const FEW_PHASES: usize = 32;
/// Samples of a window that stand before the place that is read.
const BEFORE: usize = TAPS / 2 - 1;

/// Reads its source at a changing ratio, by windowed-sinc interpolation. Pulled like
/// [`crate::resample::Resampler`]; gives the same samples for any block size.
#[derive(Debug, Clone)]
pub struct Warp {
    taps: usize,
    phases: usize,
    /// `phases + 1` rows of `taps`; not read when there is one tap.
    kernel: Arc<[f32]>,
    /// Place of the next output behind `start`, samples of the source, 0 to 1.
    place: f64,
    history: Vec<f32>,
    start: usize,
    filled: usize,
    /// Whether it reads; else it hands its source on.
    reads: bool,
}

impl Warp {
    /// Reads by interpolation; a change of ratio is heard half a kernel (16 source samples) late.
    pub fn new() -> Self {
        Self::of(
            TAPS,
            PHASES,
            kernels::kernel(TAPS, PHASES as u64, false, 0.5),
        )
    }

    /// Reads at a ratio of 1 only, without any delay: what goes in comes out.
    pub fn through() -> Self {
        Self::of(1, 1, Arc::from(&[1.0f32][..]))
    }

    /// Hands its source on, without delay and bit by bit, as long as the ratio is 1. At the first other ratio it
    /// begins to read by interpolation, from the place where it stands, and goes on so.
    pub fn when_needed() -> Self {
        Self {
            filled: BEFORE,
            reads: false,
            ..Self::of(TAPS, FEW_PHASES, small_kernel())
        }
    }

    fn of(taps: usize, phases: usize, kernel: Arc<[f32]>) -> Self {
        Self {
            taps,
            phases,
            kernel,
            place: 0.0,
            history: alloc::vec![0.0; taps + CHUNK],
            start: 0,
            filled: 0,
            reads: true,
        }
    }

    /// Fills `out`; each sample stands `ratio` source samples (0 to 1,000) after the one before.
    /// Aliases where `ratio` is above 1, unless the source has nothing there. Does not allocate.
    pub fn process(&mut self, ratio: f64, out: &mut [f32], source: &mut dyn FnMut(&mut [f32])) {
        if !self.reads {
            if ratio == 1.0 {
                source(out);
                return self.remember(out);
            }
            self.reads = true;
        }
        for sample in out {
            while self.start + self.taps > self.filled {
                self.refill(source);
            }
            *sample = self.read();
            self.place += ratio;
            let whole = self.place as usize;
            self.place -= whole as f64;
            self.start += whole;
        }
    }

    /// Keeps what stands before the next sample.
    fn remember(&mut self, block: &[f32]) {
        let new = block.len().min(BEFORE);
        self.history.copy_within(new..BEFORE, 0);
        self.history[BEFORE - new..BEFORE].copy_from_slice(&block[block.len() - new..]);
    }

    fn read(&self) -> f32 {
        let window = &self.history[self.start..self.start + self.taps];
        if self.taps == 1 {
            return window[0];
        }
        let place = self.place * self.phases as f64;
        let i = (place as usize).min(self.phases - 1);
        let t = (place - i as f64) as f32;
        let row = |i: usize| &self.kernel[i * self.taps..(i + 1) * self.taps];
        let (a, b) = (dot(row(i), window), dot(row(i + 1), window));
        a + t * (b - a)
    }

    /// Drops what is behind, and pulls a few samples. A source that is far ahead is read and thrown away
    /// in pieces.
    fn refill(&mut self, source: &mut dyn FnMut(&mut [f32])) {
        let keep_from = self.start.min(self.filled);
        self.history.copy_within(keep_from..self.filled, 0);
        self.filled -= keep_from;
        self.start -= keep_from;
        let wanted = (self.start + self.taps - self.filled).max(8);
        let end = (self.filled + wanted).min(self.history.len());
        source(&mut self.history[self.filled..end]);
        self.filled = end;
    }
}

/// The kernel of a reader that stands by. With `std` it is made once a program: most voices never read by it, and
/// each would have to be ready.
fn small_kernel() -> Arc<[f32]> {
    let make = || kernels::kernel(TAPS, FEW_PHASES as u64, false, 0.5);
    #[cfg(feature = "std")]
    {
        static KERNEL: std::sync::OnceLock<Arc<[f32]>> = std::sync::OnceLock::new();
        KERNEL.get_or_init(make).clone()
    }
    #[cfg(not(feature = "std"))]
    make()
}

impl Default for Warp {
    fn default() -> Self {
        Self::new()
    }
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
        let mut warp = Warp::new();
        let mut source = sine(0.05);
        let (mut place, mut worst) = (TAPS as f64 / 2.0 - 1.0, 0.0f64);
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
    fn at_ratio_one_it_can_be_no_change_at_all() {
        let (mut direct, mut through) = ([0.0f32; 100], [0.0f32; 100]);
        sine(0.123)(&mut direct);
        let (mut warp, mut source) = (Warp::through(), sine(0.123));
        for block in through.chunks_mut(7) {
            warp.process(1.0, block, &mut source);
        }
        assert_eq!(direct, through);
    }

    #[test]
    fn it_begins_to_read_where_it_stands() {
        let rendered = |sizes: &[usize]| {
            let (mut warp, mut source) = (Warp::when_needed(), sine(0.05));
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
    fn it_may_skip_far_ahead() {
        let mut warp = Warp::new();
        let mut out = [0.0f32; 8];
        warp.process(1_000.0, &mut out, &mut sine(0.001));
        // A whole period on each time.
        let expected = libm::sin(core::f64::consts::TAU * 0.001 * (TAPS as f64 / 2.0 - 1.0));
        let near = |x: &f32| (f64::from(*x) - expected).abs() < 1e-3;
        assert!(out.iter().all(near), "{out:?}");
    }
}
