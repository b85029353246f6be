//! Detection of recordings without a texture in the band (20 to 1000 Hz). In such a recording, the
//! power in the band either leaks from lower frequencies or is far weaker than the power above the
//! band.
//!
//! The spectrum of a 0.2 s segment under a Hann window cannot distinguish 15 Hz from 20 Hz, or a
//! drift from noise. The spectrum of a one-second segment can distinguish them, with a window whose
//! side lobes are 92 dB down (four-term Blackman-Harris; Harris 1978). The check computes the power
//! in the band with each of the two windows, and compares the two powers. In 240 third-party
//! recordings of fingers, tools and microphones, the short segments show at most 4.3 dB more power
//! than the long segments. If a normal force or a position from a recording of a finger is read by
//! mistake as a texture, the short segments show at least 32 dB more power. For noise of 1 to 15
//! Hz, they show at least 11 dB more power.

use std::f64::consts::TAU;

use htex_base::finding::Findings;
use htex_dsp::Band;
use htex_dsp::fft::RealFft;
use htex_dsp::spectrum::Complex;
use htex_dsp::window::hann_periodic;

use super::lanes;
use crate::Recording;
use crate::segments::{SEGMENTS_PER_S, SegmentChoice, choose_segments};
use htex_recording::rules::{RECORDING_ABOVE_BAND, RECORDING_BELOW_BAND};

/// A recording has a finding if its segments show at least this many times as much power in the
/// band as long windows do. The factor is 7 dB, i.e. four fifths of the power leak into the band.
const LEAKS: f64 = 5.0;
/// A recording has a finding if its power above the band is at least this many times its power in
/// the band: 30 dB. White noise at 192 kHz has 20 dB. The microphones that were tried have up to
/// 3.3 dB, and the current of a motor has 5.1 dB.
const ABOVE: f64 = 1000.0;
/// Segments in a long window: one second.
const LONG: usize = SEGMENTS_PER_S as usize;
/// For a recording whose largest value is 1, only a power in the band of at least this number is
/// judged. A smaller power is only the rounding error of a constant signal.
const LEAST: f64 = 1e-24;
/// Largest number of samples in a long window, to limit memory. If two segments have more samples
/// than this, the recording is not checked.
const MOST: usize = 1 << 22;
/// Four-term Blackman-Harris window.
const COSINES: [f64; 4] = [0.35875, -0.48829, 0.14128, -0.01168];

/// Defines the findings of this module, for `spec/recording-findings.md`.
pub(super) fn definition() -> String {
    let [a, b, c, d] = COSINES.map(f64::abs);
    format!(
        "- `RECORDING_BELOW_BAND` and `RECORDING_ABOVE_BAND`: the *power* of a stretch is the sum over the axes and over the bins of a range of frequencies of the \
         squared magnitudes of the windowed stretch, over its length and the sum of the squared window. It is read twice: of each \
         segment less its mean under a periodic Hann window, and of a *long* stretch of {LONG} segments (the whole recording if that is shorter) less its line of least squares \
         under a periodic Blackman-Harris window, `{a} - {b} cos t + {c} cos 2t - {d} cos 3t`. The long stretch has the segment in its middle, as far as it lies within the recording; a segment that \
         begins less than half a long stretch after the last one with a long stretch has none. Powers are averaged. The band is from 20 Hz to 1000 Hz, or to half the rate if that is less; above it is what exceeds 1000 Hz. \
         The finding is `RECORDING_BELOW_BAND` if the segments' power in the band is above {LEAST} of the square of the largest magnitude of a value and at least {LEAKS} times that of the long stretches, and `RECORDING_ABOVE_BAND` if the long stretches' power above the band is above the same limit and at least {ABOVE} times \
         that in it. Segments are those that would be read without a choice. A recording with an axis that is a ramp, alternates or is coarse is not checked.\n"
    )
}

/// Compares the power in the band with the power that leaks into it and with the power above it.
pub(super) fn judge(recording: &Recording, findings: &mut Findings) {
    let Some(Powers { shown, long }) = Powers::measure(recording) else {
        return;
    };
    let pointer = format!("/{}", recording.axis_name(0));
    let band_hz = Band::TACTILE;
    if shown > LEAST && shown >= LEAKS * long.inside {
        let message = format!(
            "{:.1} % of the power that the spectrum shows from {} Hz on leaks from lower frequencies: there is no texture in the band; \
             check the sensor and that the column is the lateral signal",
            100.0 * (1.0 - long.inside / shown),
            band_hz.low_hz
        );
        findings.add(RECORDING_BELOW_BAND, pointer, message);
    } else if long.above > LEAST && long.above >= ABOVE * long.inside {
        let message = format!(
            "above {} Hz the signal is {:.0} dB stronger than in the band: there is next to no texture in it; check the sensor, its filter and the \
             sample rate",
            band_hz.high_hz,
            10.0 * libm::log10(long.above / long.inside.max(f64::MIN_POSITIVE))
        );
        findings.add(RECORDING_ABOVE_BAND, pointer, message);
    }
}

/// Mean powers in the band and above it.
#[derive(Default)]
struct Power {
    inside: f64,
    above: f64,
}

/// The power in the band that the segments show, and the powers that long windows show.
struct Powers {
    shown: f64,
    long: Power,
}

impl Powers {
    /// `None` if the recording has no segment, or its segments are too long.
    fn measure(recording: &Recording) -> Option<Self> {
        let segments = choose_segments(recording, SegmentChoice::Auto);
        let (len, samples) = (segments.len, recording.samples());
        let long_len = (LONG * len).min(samples).min(MOST);
        // Values are divided by the largest one, which must not be 0.
        let is_silent = recording.axes.iter().flatten().all(|x| *x == 0.0);
        if segments.starts.is_empty() || long_len < 2 * len || is_silent {
            return None;
        }
        let short = Reader::new(recording, hann_periodic(len), false);
        let shown = short.mean(segments.starts.iter().copied());
        let mut next = 0;
        let is_due = |start: &usize| {
            let is_due = *start >= next;
            // Segments overlap. If each segment had a window of one second around it, the same
            // samples would be read ten times.
            next = if is_due { start + long_len / 2 } else { next };
            is_due
        };
        let due = segments.starts.into_iter().filter(is_due);
        let around = |start: usize| {
            let first = (start + len / 2).saturating_sub(long_len / 2);
            first.min(samples - long_len)
        };
        let long = Reader::new(recording, blackman_harris(long_len), true);
        Some(Self { shown: shown.inside, long: long.mean(due.map(around)) })
    }
}

/// Periodic four-term Blackman-Harris window.
fn blackman_harris(len: usize) -> Vec<f64> {
    // The remainder keeps the angle below one turn, so that the cosine is precise.
    let cosine = |k: usize, i: usize| libm::cos(TAU * (k * i % len) as f64 / len as f64);
    let value = |i| (0..4).map(|k| COSINES[k] * cosine(k, i)).sum();
    (0..len).map(value).collect()
}

/// Reads the powers of windowed stretches of a recording.
struct Reader<'a> {
    recording: &'a Recording,
    window: Vec<f64>,
    /// Inverse of the largest magnitude in the recording. All values are multiplied by it, so that
    /// no square overflows.
    scale: f64,
    /// Whether a straight line is removed from each stretch; otherwise its mean is removed.
    is_level: bool,
}

impl<'a> Reader<'a> {
    fn new(recording: &'a Recording, window: Vec<f64>, is_level: bool) -> Self {
        let of_axes = recording.axes.iter().map(|axis| lanes::largest(axis, f64::abs));
        let largest = of_axes.fold(f64::MIN_POSITIVE, f64::max);
        Self { recording, window, scale: 1.0 / largest, is_level }
    }

    /// Returns the mean powers of the stretches that begin at the given samples.
    fn mean(&self, starts: impl Iterator<Item = usize>) -> Power {
        let len = self.window.len();
        let mut fft = RealFft::new(len);
        let mut bins = fft.make_bins();
        let squares: f64 = self.window.iter().map(|w| w * w).sum();
        let spacing_hz = self.recording.rate_hz / len as f64;
        let first_bin = |is: &dyn Fn(f64) -> bool| {
            (0..bins.len()).find(|k| is(*k as f64 * spacing_hz)).unwrap_or(bins.len())
        };
        let above = first_bin(&|hz| hz > Band::TACTILE.high_hz);
        let inside = first_bin(&|hz| Band::TACTILE.contains(hz)).min(above);
        let (mut sum, mut count) = (Power::default(), 0.0);
        let mut windowed = vec![0.0; len];
        for start in starts {
            count += 1.0;
            for axis in &self.recording.axes {
                self.window(axis.get(start..start + len).unwrap_or_default(), &mut windowed);
                fft.forward(&windowed, &mut bins);
                let power = |bins: &[Complex<f64>]| bins.iter().map(Complex::norm_sqr).sum::<f64>();
                sum.inside += power(&bins[inside..above]);
                sum.above += power(&bins[above..]);
            }
        }
        let scale = 1.0 / (count * squares * len as f64);
        Power { inside: scale * sum.inside, above: scale * sum.above }
    }

    /// Removes the mean or the line from a stretch, and multiplies the stretch by the window.
    fn window(&self, stretch: &[f64], windowed: &mut [f64]) {
        let (count, scale) = (stretch.len() as f64, self.scale);
        let mean = lanes::sum(stretch, |_, x| x * scale) / count;
        let middle = 0.5 * (count - 1.0);
        let slope = if self.is_level {
            // The denominator, divided by 12, is the sum of the squared distances from the middle.
            12.0 * lanes::sum(stretch, |at, x| (at - middle) * (x * scale))
                / (count * (count * count - 1.0))
        } else {
            0.0
        };
        let values = stretch.iter().zip(&self.window).enumerate();
        for (windowed, (at, (x, window))) in windowed.iter_mut().zip(values) {
            *windowed = (x * scale - mean - slope * (at as f64 - middle)) * window;
        }
    }
}
