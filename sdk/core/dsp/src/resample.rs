//! Streaming sample-rate conversion by polyphase windowed-sinc filters.
//!
//! A texture voice renders at its own, low rate. The converter converts the voice's samples to the
//! rate of the device. The converter pulls exactly the samples that it needs from its source, never
//! allocates while it runs, and gives the same samples for any block size. The resamplers of other
//! libraries work in chunks of a fixed size, which does not meet these requirements. Therefore, the
//! project has its own converter.
//!
//! Textures have no content above 1 kHz, so voices generate noise at sample rates of 2 to 4 kHz. At
//! these rates a voice generates five to eight times fewer samples than at the rate of the device.
//! In addition, the converter's filter serves as the steep filter that removes noise above the
//! band.

use alloc::sync::Arc;
use alloc::vec::Vec;

use crate::kernels;
use crate::polyphase::{INTERPOLATED_PHASES, Polyphase};
use crate::upsample::Upsampler;

/// Number of phases up to which the kernel table is exact. Above it, the kernel is interpolated.
const MAX_EXACT_PHASES: u64 = 1024;
/// Half the width of the transition band around the source's Nyquist frequency, as a fraction of
/// the Nyquist frequency.
const TRANSITION: f64 = 0.02;
/// Length of the longest kernel. Rates that need a longer kernel are refused, to limit the memory.
const MAX_TAPS: usize = 16_384;
/// Largest ratio of the two rates.
const MAX_RATIO: u64 = 10_000;

/// Error: no converter exists between these rates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UnusableRates {
    /// Rate of the source, hertz.
    pub from_hz: f64,
    /// Requested rate, hertz.
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

/// Converts a stream of samples from one rate to another.
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
    /// Makes a converter from `from_hz` to `to_hz`, for a source without content above `top_hz`,
    /// all in hertz. Returns `None` if the rates are equal to within a millihertz, so that no
    /// conversion is needed.
    ///
    /// # Errors
    /// Returns an error if a rate is outside 1 mHz to 10 MHz, or the rates differ by more than a
    /// factor of 10,000.
    pub fn new(from_hz: f64, to_hz: f64, top_hz: f64) -> Result<Option<Self>, UnusableRates> {
        Self::with_specs(specs(from_hz, to_hz, top_hz)?)
    }

    /// Makes a converter as [`Self::new`] does, but for a source whose rate is fixed at `from_hz`,
    /// such as a filter.
    ///
    /// Near half the source's rate, a conversion to a high rate removes up to half of the power.
    /// This converter removes the same part of the power also if the two rates are equal
    /// ([`OwnRate`]) or if `to_hz` is the lower rate. As a result, the level is the same at all
    /// rates that can represent the source's frequencies.
    ///
    /// # Errors
    /// Returns the errors of [`Self::new`].
    pub fn of_own_rate(
        from_hz: f64,
        to_hz: f64,
        top_hz: f64,
    ) -> Result<Option<Self>, UnusableRates> {
        Self::with_specs(own_specs(from_hz, to_hz, top_hz)?)
    }

    fn with_specs(specs: Vec<Spec>) -> Result<Option<Self>, UnusableRates> {
        let stages: Vec<Stage> = specs.iter().map(Stage::new).collect();
        Ok((!stages.is_empty()).then_some(Self { stages }))
    }

    /// Returns the computing work of a converter for these rates, or `None` if no conversion is
    /// needed. If `own_rate` is true, this is the work of a converter made with
    /// [`Self::of_own_rate`], otherwise with [`Self::new`].
    ///
    /// # Errors
    /// Returns the errors of [`Self::new`].
    pub fn work(
        from_hz: f64,
        to_hz: f64,
        top_hz: f64,
        own_rate: bool,
    ) -> Result<Option<Work>, UnusableRates> {
        let specs = if own_rate {
            own_specs(from_hz, to_hz, top_hz)?
        } else {
            specs(from_hz, to_hz, top_hz)?
        };
        let mut work = Work::default();
        for spec in &specs {
            let samples = spec.to as f64 / 1000.0 / to_hz;
            // If the stage doubles the rate, every other output is a copy of an input.
            let rows = match spec.up() {
                2 if spec.is_whole() => 0.5,
                _ if spec.is_exact() => 1.0,
                _ => 2.0,
            };
            let part = if spec.is_whole() { &mut work.whole } else { &mut work.rational };
            part.samples += samples;
            part.macs += samples * rows * spec.taps() as f64;
        }
        Ok((!specs.is_empty()).then_some(work))
    }

    /// Fills `out` with the next samples. Calls `source` for the samples that it needs; `source`
    /// must fill the whole slice. Does not allocate.
    pub fn process(&mut self, out: &mut [f32], source: &mut dyn FnMut(&mut [f32])) {
        run(&mut self.stages, out, source);
    }
}

/// Average work of a converter for each sample of its output.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Work {
    /// Work of the stages that raise the rate by an integer factor.
    pub whole: Part,
    /// Work of all other stages.
    pub rational: Part,
}

/// Average work that all stages of one kind do for each sample of a converter's output.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Part {
    /// Number of samples that the stages compute.
    pub samples: f64,
    /// Number of multiply-accumulates for all these samples.
    pub macs: f64,
}

/// The amplitude that a conversion to a high rate passes at each frequency. A program needs this
/// amplitude for a source with a fixed rate, if the source's frequencies extend into the transition
/// band around half of this rate. In the middle of the transition band, half the amplitude passes,
/// and an image with the same amplitude appears.
#[derive(Debug, Clone)]
pub struct OwnRate {
    rate_hz: f64,
    kernel: Arc<[f32]>,
    taps: usize,
}

/// Number of phases in the kernel of [`OwnRate`].
const OWN_PHASES: u64 = 4;

impl OwnRate {
    /// Computes the amplitude for a source with this sample rate and this highest frequency (both
    /// in hertz). Returns `None` if this frequency is below the transition band. In this case the
    /// source passes unchanged.
    pub fn new(rate_hz: f64, top_hz: f64) -> Option<Self> {
        let spec = Spec::of_own_rate(rate_hz, millihertz(rate_hz)?, top_hz)?;
        Some(Self { rate_hz, kernel: spec.own_kernel(), taps: spec.taps() })
    }

    /// Returns the rate of the source, hertz.
    pub fn rate_hz(&self) -> f64 {
        self.rate_hz
    }

    /// Returns the amplitude that passes at a frequency (hertz). A frequency above half the
    /// source's rate belongs to an image.
    pub fn amplitude(&self, hz: f64) -> f64 {
        let middle = 0.5 * self.taps as f64 - 1.0;
        let turn = core::f64::consts::TAU * hz / self.rate_hz;
        let (step_sin, step_cos) = crate::trig::sincos(turn);
        let row = |(row, kernel): (usize, &[f32])| -> f64 {
            let first = -middle - row as f64 / OWN_PHASES as f64;
            let (mut sin, mut cos) = crate::trig::sincos(turn * first);
            let mut sum = 0.0;
            for x in kernel {
                sum += f64::from(*x) * cos;
                // The angle is turned step by step. This is much faster than computing a sine for
                // each coefficient.
                (cos, sin) = (cos * step_cos - sin * step_sin, sin * step_cos + cos * step_sin);
            }
            sum
        };
        let rows = self.kernel.chunks_exact(self.taps).enumerate();
        rows.map(row).sum::<f64>() / OWN_PHASES as f64
    }
}

/// Specification of a stage: its two rates in millihertz, and the edges of its transition band in
/// hertz.
struct Spec {
    from: u64,
    to: u64,
    pass_hz: f64,
    stop_hz: f64,
}

/// Returns the stages of [`Resampler::of_own_rate`]; empty if no conversion is needed.
fn own_specs(from_hz: f64, to_hz: f64, top_hz: f64) -> Result<Vec<Spec>, UnusableRates> {
    let all = specs(from_hz, to_hz, top_hz)?;
    if all.is_empty() {
        let same = millihertz(from_hz).and_then(|rate| Spec::of_own_rate(from_hz, rate, top_hz));
        return Ok(same.into_iter().collect());
    }
    let is_cut = top_hz > 0.5 * to_hz * (1.0 - TRANSITION) && top_hz <= 0.5 * to_hz;
    if to_hz >= from_hz || !is_cut {
        return Ok(all);
    }
    // All of the source's content lies below half the lower rate, so it passes the filter as in a
    // conversion to high rates.
    let edges = |spec: Spec| {
        let nyquist = 0.5 * from_hz;
        let pass_hz = top_hz.min(nyquist * (1.0 - TRANSITION));
        Spec { pass_hz, stop_hz: (from_hz - pass_hz).max(nyquist * (1.0 + TRANSITION)), ..spec }
    };
    Ok(all.into_iter().map(edges).collect())
}

/// The stages of a converter; empty if no conversion is needed.
fn specs(from_hz: f64, to_hz: f64, top_hz: f64) -> Result<Vec<Spec>, UnusableRates> {
    let unusable = UnusableRates { from_hz, to_hz };
    // The rates are rounded to whole millihertz, so that their ratio is an exact fraction.
    let (Some(from), Some(mut to)) = (millihertz(from_hz), millihertz(to_hz)) else {
        return Err(unusable);
    };
    // If one rate is the other rate divided by a whole number, it is seldom a whole number of
    // millihertz.
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
    let spec = |from, to, pass_hz, stop_hz| Spec { from, to, pass_hz, stop_hz };
    let nyquist = 0.5 * from_hz.min(to_hz);
    // The transition band is wide if the highest content of the source is far below its first
    // image.
    let pass = top_hz.min(nyquist * (1.0 - TRANSITION));
    let stop = (from_hz.min(to_hz) - pass).max(nyquist * (1.0 + TRANSITION));
    let narrow = stop - pass < 0.5 * nyquist;
    if !narrow || to / from < 4 {
        return Ok(alloc::vec![spec(from, to, pass, stop)]);
    }
    // The steep filter runs at only twice the source's rate. The images that it leaves are far
    // away. Therefore, the second stage, which computes many more outputs, needs only few taps.
    let middle = 2 * from;
    // The first stage passes content up to `stop`. The image of this content begins at this
    // frequency.
    let image = 2.0 * from_hz - stop;
    Ok(alloc::vec![
        spec(from, middle, pass, stop),
        spec(middle, to, pass.max(1e-3), image.max(stop)),
    ])
}

impl Spec {
    /// Returns the filter for a source at its own rate, or `None` if the source's frequencies end
    /// below the transition band.
    fn of_own_rate(rate_hz: f64, rate: u64, top_hz: f64) -> Option<Self> {
        let nyquist = 0.5 * rate_hz;
        let pass_hz = nyquist * (1.0 - TRANSITION);
        (top_hz > pass_hz).then_some(Self {
            from: rate,
            to: rate,
            pass_hz,
            stop_hz: nyquist * (1.0 + TRANSITION),
        })
    }

    /// The kernel of this filter, with four phases: steps of a quarter of a sample.
    fn own_kernel(&self) -> Arc<[f32]> {
        kernels::kernel(self.taps(), OWN_PHASES, true, self.cutoff())
    }

    /// The cut-off in cycles per sample of the source.
    fn cutoff(&self) -> f64 {
        0.5 * (self.pass_hz + self.stop_hz) / self.source_hz()
    }

    fn up(&self) -> u64 {
        self.to / gcd(self.from, self.to)
    }

    fn down(&self) -> u64 {
        self.from / gcd(self.from, self.to)
    }

    /// Whether this stage raises the rate by an integer factor.
    fn is_whole(&self) -> bool {
        self.from != self.to && self.down() == 1 && self.is_exact()
    }

    /// Whether the kernel table has a separate row for each phase.
    fn is_exact(&self) -> bool {
        self.up() <= MAX_EXACT_PHASES
    }

    fn source_hz(&self) -> f64 {
        self.from as f64 / 1000.0
    }

    fn taps(&self) -> usize {
        let width = (self.stop_hz - self.pass_hz).max(1e-6) / self.source_hz();
        let least = kernels::kaiser_length(width).clamp(8, MAX_TAPS);
        // Eight for `dot` of `Polyphase`. `Upsampler` only needs an even number.
        least.next_multiple_of(if self.is_whole() { 2 } else { 8 })
    }
}

/// Runs the last stage, which pulls from the stages before it.
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
        if spec.from == spec.to {
            // The output is a quarter of a sample away from the source's samples. At this distance,
            // the phases of a frequency and its image differ by a quarter turn. Therefore, their
            // powers add up, as at other rates.
            let kernel = spec.own_kernel();
            return Self::Rational(Polyphase::with_phase(
                1,
                OWN_PHASES as usize,
                spec.taps(),
                kernel,
            ));
        }
        let (up, down, taps) = (spec.up(), spec.down(), spec.taps());
        let phases = if spec.is_exact() { up } else { INTERPOLATED_PHASES };
        let kernel = kernels::kernel(taps, phases, spec.is_exact(), spec.cutoff());
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

    /// Converts a sine, and returns its largest error against the same sine at the other rate.
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
        // The first output of each stage is at the centre of its first window.
        let stages = specs(from_hz, to_hz, 1000.0).unwrap().into_iter().zip(&resampler.stages);
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
        // The ratio of the rates is 17. If both rates were rounded to millihertz, it would not be a
        // whole number.
        let whole = specs(2_594.117_647, 44_100.0, 900.0).unwrap();
        assert!(whole.iter().all(Spec::is_whole));
    }

    #[test]
    fn a_steep_filter_is_cheap_at_a_low_rate() {
        let macs = |to_hz| {
            let work = Resampler::work(2_000.0, to_hz, 1_000.0, false);
            work.unwrap().unwrap().whole.macs
        };
        let taps = specs(2_000.0, 4_000.0, 1_000.0).unwrap()[0].taps() as f64;
        // In the first stage, every other sample is a copy. The second stage computes five times as
        // many samples, but with few taps.
        assert_eq!(macs(4_000.0), 0.5 * taps);
        assert!(macs(20_000.0) < 0.2 * macs(4_000.0) + 12.0);
    }

    /// Noise in the transition band of a source at 2 kHz has the same power at all rates, as
    /// [`OwnRate`] states.
    #[test]
    fn a_source_of_its_own_rate_has_one_level_at_all_rates() {
        let own = OwnRate::new(2_000.0, 1_000.0).unwrap();
        assert!(OwnRate::new(2_000.0, 970.0).is_none());
        assert!((own.amplitude(500.0) - 1.0).abs() < 1e-3 && own.amplitude(1_030.0).abs() < 1e-3);
        for hz in [970.3, 985.3, 992.3, 997.3, 999.3] {
            let stated = own.amplitude(hz).powi(2) + own.amplitude(2_000.0 - hz).powi(2);
            for to_hz in [2_000.0, 2_001.0, 2_050.0, 2_400.0, 8_000.0, 48_000.0] {
                let found = 2.0 * power(2_000.0, to_hz, hz);
                let off_db = 10.0 * libm::log10(found / stated);
                // Lengths of kernels are rounded up to multiples of 2 or 8. A level contains many
                // frequencies, so levels differ by less than this limit.
                assert!(off_db.abs() < 0.06, "{hz} Hz at {to_hz}: {off_db} dB");
            }
        }
        for from_hz in [2_020.0, 2_500.0, 4_000.0] {
            let ratio = power(from_hz, 2_000.0, 991.3) / power(from_hz, 48_000.0, 991.3);
            let off_db = 10.0 * libm::log10(ratio);
            assert!(off_db.abs() < 0.04, "from {from_hz}: {off_db} dB");
        }
    }

    /// Mean square of a converted sine over ten seconds.
    fn power(from_hz: f64, to_hz: f64, hz: f64) -> f64 {
        let mut resampler = Resampler::of_own_rate(from_hz, to_hz, 1_000.0).unwrap();
        let mut n = 0usize;
        let mut source = |block: &mut [f32]| {
            for x in block {
                *x = libm::sin(core::f64::consts::TAU * hz * n as f64 / from_hz) as f32;
                n += 1;
            }
        };
        let mut out = alloc::vec![0.0f32; (10.0 * to_hz) as usize];
        match &mut resampler {
            Some(resampler) => resampler.process(&mut out, &mut source),
            None => source(&mut out),
        }
        out.iter().map(|x| f64::from(*x).powi(2)).sum::<f64>() / out.len() as f64
    }
}
