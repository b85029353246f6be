//! Streaming sample-rate conversion by polyphase windowed-sinc filters.
//!
//! A texture voice renders at a low rate of its own; the converter brings it to the device's rate. The
//! converter pulls exactly the samples it needs from its source, never allocates while it runs, and gives the
//! same samples for any block size.
//!
//! A voice states the rate at which it renders. Textures end at 1 kHz, so noise is generated at 2 to 4 kHz: five to
//! eight times fewer samples, and the steep filter at the top of the band is the converter's. It is not a library's,
//! since those work in chunks of their own size.

use alloc::vec::Vec;

use crate::kernels;
use crate::polyphase::{INTERPOLATED_PHASES, Polyphase};
use crate::upsample::Upsampler;

/// Number of phases beyond which the kernel table is interpolated instead of exact.
const MAX_EXACT_PHASES: u64 = 1024;
/// Half the width of the transition band around the source's Nyquist frequency, relative to that frequency.
const TRANSITION: f64 = 0.02;
/// Kernel length beyond which rates are refused, to bound memory.
const MAX_TAPS: usize = 16_384;
/// Maximum ratio of the rates.
const MAX_RATIO: u64 = 10_000;

/// Error: no converter exists between these rates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UnusableRates {
    /// Rate of the source, hertz.
    pub from_hz: f64,
    /// Rate wanted, hertz.
    pub to_hz: f64,
}

impl core::fmt::Display for UnusableRates {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let Self { from_hz, to_hz } = self;
        write!(
            f,
            "no conversion from {from_hz} Hz to {to_hz} Hz: rates lie in 1 mHz to 10 MHz and differ by a \
             factor of at most 10,000"
        )
    }
}

impl core::error::Error for UnusableRates {}

/// Converts a stream from one rate to another.
///
/// ```
/// use htex_dsp::resample::Resampler;
/// assert!(Resampler::new(2_000.0, 48_000.0, 1_000.0)?.is_some());
/// assert!(Resampler::new(2_000.0, 2_000.0, 1_000.0)?.is_none());
/// assert!(Resampler::new(2_000.0, f64::NAN, 1_000.0).is_err());
/// # Ok::<(), htex_dsp::resample::UnusableRates>(())
/// ```
#[derive(Debug, Clone)]
pub struct Resampler {
    stages: Vec<Stage>,
}

impl Resampler {
    /// Makes a converter from `from_hz` to `to_hz` for a source without content above `top_hz`, all in hertz;
    /// `None` if the rates are equal (to a millihertz) and no conversion is needed.
    ///
    /// # Errors
    /// Rates outside 1 mHz to 10 MHz, or that differ by more than a factor of 10,000.
    pub fn new(from_hz: f64, to_hz: f64, top_hz: f64) -> Result<Option<Self>, UnusableRates> {
        let specs = specs(from_hz, to_hz, top_hz)?;
        let stages: Vec<Stage> = specs.iter().map(Stage::new).collect();
        Ok((!stages.is_empty()).then_some(Self { stages }))
    }

    /// Multiply-accumulates per output sample of such a converter, on average; `None` if no conversion is
    /// needed.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn macs_per_output(
        from_hz: f64,
        to_hz: f64,
        top_hz: f64,
    ) -> Result<Option<f64>, UnusableRates> {
        let specs = specs(from_hz, to_hz, top_hz)?;
        let mut macs = 0.0;
        for spec in &specs {
            let rate = spec.to as f64 / 1000.0 / to_hz;
            // When a rate is doubled, every other sample is a copy.
            let rows = match spec.up() {
                2 => 0.5,
                _ if spec.is_exact() => 1.0,
                _ => 2.0,
            };
            macs += rate * rows * spec.taps() as f64;
        }
        Ok((!specs.is_empty()).then_some(macs))
    }

    /// Fills `out`, pulling source samples through `source`, which must fill the whole slice that it is
    /// given. Does not allocate.
    pub fn process(&mut self, out: &mut [f32], source: &mut dyn FnMut(&mut [f32])) {
        run(&mut self.stages, out, source);
    }
}

/// Specification of a stage: rates in millihertz, edges of its transition band in hertz.
struct Spec {
    from: u64,
    to: u64,
    pass_hz: f64,
    stop_hz: f64,
}

/// The stages of a converter; empty if no conversion is needed.
fn specs(from_hz: f64, to_hz: f64, top_hz: f64) -> Result<Vec<Spec>, UnusableRates> {
    let unusable = UnusableRates { from_hz, to_hz };
    let (Some(from), Some(mut to)) = (millihertz(from_hz), millihertz(to_hz)) else {
        return Err(unusable);
    };
    // A divided rate is seldom a whole number of millihertz.
    let ratio = libm::round(to_hz / from_hz);
    if ratio >= 2.0 && (to_hz / from_hz / ratio - 1.0).abs() < 1e-9 {
        to = from * ratio as u64;
    }
    if from == to {
        return Ok(Vec::new());
    }
    if from > MAX_RATIO * to || to > MAX_RATIO * from {
        return Err(unusable);
    }
    let spec = |from, to, pass_hz, stop_hz| Spec {
        from,
        to,
        pass_hz,
        stop_hz,
    };
    let nyquist = 0.5 * from_hz.min(to_hz);
    // The transition band is wide if the source's highest content is far below its first image.
    let pass = top_hz.min(nyquist * (1.0 - TRANSITION));
    let stop = (from_hz.min(to_hz) - pass).max(nyquist * (1.0 + TRANSITION));
    let narrow = stop - pass < 0.5 * nyquist;
    if !narrow || to / from < 4 {
        return Ok(alloc::vec![spec(from, to, pass, stop)]);
    }
    let middle = 2 * from;
    let image = 2.0 * from_hz - stop;
    Ok(alloc::vec![
        spec(from, middle, pass, stop),
        spec(middle, to, pass.max(1e-3), image.max(stop)),
    ])
}

impl Spec {
    fn up(&self) -> u64 {
        self.to / gcd(self.from, self.to)
    }

    fn down(&self) -> u64 {
        self.from / gcd(self.from, self.to)
    }

    /// Whether the rate is raised by an integer factor.
    fn is_whole(&self) -> bool {
        self.down() == 1 && self.is_exact()
    }

    /// Whether each phase has its own row.
    fn is_exact(&self) -> bool {
        self.up() <= MAX_EXACT_PHASES
    }

    fn source_hz(&self) -> f64 {
        self.from as f64 / 1000.0
    }

    fn taps(&self) -> usize {
        let width = (self.stop_hz - self.pass_hz).max(1e-6) / self.source_hz();
        let least = kernels::kaiser_length(width).clamp(8, MAX_TAPS);
        least.next_multiple_of(if self.is_whole() { 2 } else { 8 })
    }
}

/// Runs the last stage, which pulls from the ones before it.
fn run(stages: &mut [Stage], out: &mut [f32], source: &mut dyn FnMut(&mut [f32])) {
    match stages.split_last_mut() {
        None => source(out),
        Some((last, before)) => last.process(out, &mut |block| run(before, block, source)),
    }
}

fn millihertz(rate_hz: f64) -> Option<u64> {
    let value = libm::round(rate_hz * 1000.0);
    (1.0..=1e10).contains(&value).then_some(value as u64)
}

#[derive(Debug, Clone)]
enum Stage {
    Whole(Upsampler),
    Rational(Polyphase),
}

impl Stage {
    fn new(spec: &Spec) -> Self {
        let (up, down, taps) = (spec.up(), spec.down(), spec.taps());
        let phases = if spec.is_exact() {
            up
        } else {
            INTERPOLATED_PHASES
        };
        let cutoff = 0.5 * (spec.pass_hz + spec.stop_hz) / spec.source_hz();
        let kernel = kernels::kernel(taps, phases, spec.is_exact(), cutoff);
        if spec.is_whole() {
            return Self::Whole(Upsampler::new(up as usize, taps, kernel, spec.source_hz()));
        }
        let step = ((down / up) as usize, (down % up) as usize);
        Self::Rational(Polyphase::new(up as usize, step, taps, kernel))
    }

    fn process(&mut self, out: &mut [f32], source: &mut dyn FnMut(&mut [f32])) {
        match self {
            Self::Whole(stage) => stage.process(out, source),
            Self::Rational(stage) => stage.process(out, source),
        }
    }
}

fn gcd(a: u64, b: u64) -> u64 {
    if b == 0 { a } else { gcd(b, a % b) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Converts a sine and returns the largest error against the same sine at the other rate.
    fn sine_error(from_hz: f64, to_hz: f64, f_hz: f64) -> f64 {
        let mut resampler = Resampler::new(from_hz, to_hz, 1000.0).unwrap().unwrap();
        let mut n = 0usize;
        let mut source = |block: &mut [f32]| {
            for x in block {
                *x = libm::sin(core::f64::consts::TAU * f_hz * n as f64 / from_hz) as f32;
                n += 1;
            }
        };
        let mut out = alloc::vec![0.0f32; 4_000];
        for block in out.chunks_mut(33) {
            resampler.process(block, &mut source);
        }
        // Each stage's first output is at the centre of its first window.
        let stages = specs(from_hz, to_hz, 1000.0)
            .unwrap()
            .into_iter()
            .zip(&resampler.stages);
        let delay_s: f64 = stages
            .map(|(spec, stage)| {
                let skipped = match stage {
                    Stage::Whole(stage) => stage.skipped(),
                    Stage::Rational(_) => 0,
                };
                (skipped as f64 + spec.taps() as f64 / 2.0 - 1.0) / spec.source_hz()
            })
            .sum();
        assert!(delay_s > 0.0);
        out.iter()
            .enumerate()
            .map(|(k, y)| {
                let t = k as f64 / to_hz + delay_s;
                (f64::from(*y) - libm::sin(core::f64::consts::TAU * f_hz * t)).abs()
            })
            .fold(0.0, f64::max)
    }

    #[test]
    fn sines_keep_their_amplitude_phase_and_frequency() {
        for (from, to) in [
            (2_000.0, 20_000.0),
            (2_500.0, 20_000.0),
            (2_000.0, 44_100.0),
            (2_594.117_647, 44_100.0),
            (20_000.0, 48_000.0),
            (20_000.0, 2_400.0),
            (1_000_000.0, 3_000.0),
        ] {
            for f in [20.0, 317.0, 900.0] {
                let error = sine_error(from, to, f);
                assert!(error < 2e-3, "{from} -> {to} at {f}: {error}");
            }
        }
        // 17 times, though not in millihertz.
        let whole = specs(2_594.117_647, 44_100.0, 900.0).unwrap();
        assert!(whole.iter().all(Spec::is_whole));
    }

    #[test]
    fn a_steep_filter_is_cheap_at_a_low_rate() {
        let macs = |to_hz| {
            Resampler::macs_per_output(2_000.0, to_hz, 1_000.0)
                .unwrap()
                .unwrap()
        };
        let taps = specs(2_000.0, 4_000.0, 1_000.0).unwrap()[0].taps() as f64;
        // Every other sample is a copy; the second stage makes five times as many samples with few taps.
        assert_eq!(macs(4_000.0), 0.5 * taps);
        assert!(macs(20_000.0) < 0.2 * macs(4_000.0) + 12.0);
    }
}
