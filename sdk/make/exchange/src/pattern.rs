//! The common representation of all envelope formats: a level and a frequency over time, and
//! transients.

use crate::curve::{Point, Reader};
use crate::error::Fault;

/// Longest pattern that can be rendered, seconds.
pub const MOST_S: f64 = 600.0;
/// A transient is rendered as this number of periods of a sine. Other renderers play one or two
/// periods of a square wave (Meta, *.haptic File Specification 1.0*, Emphasis Object).
const PERIODS: f64 = 2.0;

/// Limit on the work for a file. The work is the number of samples of each vibration, added up over
/// all vibrations, plus the points of their curves. At the sample rate of imports, a vibration of
/// ten minutes has 4.8 million samples.
const MOST_WORK: f64 = 3.2e7;

/// Returns a fault if the work exceeds [`MOST_WORK`]. `at` is the place of the vibrations in the
/// file.
pub(crate) fn check_work(
    work: f64,
    rate_hz: f64,
    at: impl FnOnce() -> String,
) -> Result<(), Fault> {
    if work <= MOST_WORK {
        return Ok(());
    }
    let problem = format!(
        "its effects have more than {MOST_WORK:e} samples and keyframes at {rate_hz} Hz; leave some out"
    );
    Err(Fault::new(at(), problem))
}

/// A vibration of one actuator: a sine whose level and frequency follow curves, plus transients.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Pattern {
    /// Start and end, seconds.
    pub from_s: f64,
    pub to_s: f64,
    /// Level over time, 0 to 1. The level raised to the power of `exponent` is the amplitude,
    /// relative to the strongest vibration at the current frequency.
    pub level: Vec<Point>,
    /// Exponent that converts levels to amplitudes. The exponent is 1 if levels are themselves
    /// amplitudes relative to the strongest vibration. The exponent is 2 if levels are the square
    /// roots of these amplitudes, as in `.ahap`.
    pub exponent: i32,
    /// Frequency over time, hertz.
    pub frequency_hz: Vec<Point>,
    pub transients: Vec<Transient>,
}

/// A short pulse.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Transient {
    /// Start of the transient, seconds.
    pub time_s: f64,
    /// Amplitude from 0 to 1, relative to the strongest vibration.
    pub amplitude: f64,
    pub frequency_hz: f64,
}

impl Pattern {
    /// Returns the end of the pattern, including its transients, seconds.
    #[must_use]
    pub fn end_s(&self) -> f64 {
        let ends = self.transients.iter().map(Transient::end_s);
        ends.fold(self.to_s, f64::max)
    }

    /// Adds the vibration to samples. The first sample is at time 0. A sample of 1 is the strongest
    /// vibration of the actuator.
    pub fn add_to(&self, samples: &mut [f64], rate_hz: f64) {
        self.add_sine(samples, rate_hz);
        for transient in &self.transients {
            transient.add_to(samples, rate_hz);
        }
    }

    /// Returns the work of rendering: the number of samples of the vibration and its transients,
    /// plus the number of points.
    fn work(&self, rate_hz: f64) -> f64 {
        let sine = (self.to_s - self.from_s).max(0.0) * rate_hz;
        let pulse = |t: &Transient| (t.end_s() - t.time_s) * rate_hz + 1.0;
        let pulses: f64 = self.transients.iter().map(pulse).sum();
        sine + pulses + (self.level.len() + self.frequency_hz.len()) as f64
    }

    fn add_sine(&self, samples: &mut [f64], rate_hz: f64) {
        let (mut level, mut frequency) =
            (Reader::new(&self.level), Reader::new(&self.frequency_hz));
        let mut phase = 0.0;
        let first = libm::ceil(self.from_s * rate_hz).max(0.0) as usize;
        for (index, sample) in samples.iter_mut().enumerate().skip(first) {
            let time_s = index as f64 / rate_hz;
            if time_s >= self.to_s {
                break;
            }
            let Some((level, hertz)) = level.value_at(time_s).zip(frequency.value_at(time_s))
            else {
                break;
            };
            // The exponent is at least 1, because the exponent 0 of a default pattern would turn
            // silence into the strongest vibration.
            *sample += libm::pow(level, f64::from(self.exponent.max(1))) * libm::sin(phase);
            // The phase is added up, so that the sine stays continuous while its frequency changes.
            phase += std::f64::consts::TAU * hertz / rate_hz;
            // A phase that grew for ten minutes would lose digits, which would change the
            // frequency.
            if phase > std::f64::consts::TAU {
                phase -= std::f64::consts::TAU * libm::floor(phase / std::f64::consts::TAU);
            }
        }
    }
}

impl Transient {
    /// Returns the end of the transient, seconds.
    #[must_use]
    pub fn end_s(&self) -> f64 {
        self.time_s + PERIODS / self.frequency_hz.max(1.0)
    }

    fn add_to(&self, samples: &mut [f64], rate_hz: f64) {
        let first = libm::ceil(self.time_s * rate_hz).max(0.0) as usize;
        for (index, sample) in samples.iter_mut().enumerate().skip(first) {
            let into_s = index as f64 / rate_hz - self.time_s;
            if self.time_s + into_s >= self.end_s() {
                break;
            }
            *sample +=
                self.amplitude * libm::sin(std::f64::consts::TAU * self.frequency_hz * into_s);
        }
    }
}

/// Does the same as [`rendered`], but limits the work, for a file from an untrusted source. `at` is
/// the place of the vibrations in the file.
pub(crate) fn rendered_of_file(
    patterns: &[Pattern],
    rate_hz: f64,
    at: &str,
) -> Result<Vec<f64>, Fault> {
    let work = patterns.iter().map(|pattern| pattern.work(rate_hz)).sum();
    check_work(work, rate_hz, || at.to_owned())?;
    Ok(rendered(patterns, rate_hz))
}

/// Renders the sum of patterns, from time 0 to the end of the last pattern. The sum is limited to
/// the range from -1 to 1, because an actuator cannot vibrate more strongly.
#[must_use]
pub fn rendered(patterns: &[Pattern], rate_hz: f64) -> Vec<f64> {
    let end_s = patterns.iter().map(Pattern::end_s).fold(0.0, f64::max);
    let len = libm::ceil(end_s.clamp(0.0, MOST_S) * rate_hz) as usize;
    let mut samples = vec![0.0; len];
    for pattern in patterns {
        pattern.add_to(&mut samples, rate_hz);
    }
    // Only the sum is limited, because single vibrations of opposite sign may be stronger than 1.
    samples.iter_mut().for_each(|x| *x = x.clamp(-1.0, 1.0));
    samples
}

/// Combines patterns into one, for formats with a single envelope. At each time, the level and
/// frequency of the strongest pattern are used. All transients are kept. At each point, the level
/// is converted to an amplitude (exponent 1). Between points, the converted level is interpolated
/// linearly.
#[must_use]
pub fn combined(patterns: &[Pattern]) -> Pattern {
    let sounding: Vec<&Pattern> = patterns.iter().filter(|p| p.to_s > p.from_s).collect();
    let mut times: Vec<f64> = sounding.iter().flat_map(|p| p.times()).collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    let mut all = Pattern { exponent: 1, ..Pattern::default() };
    for &time_s in &times {
        // The values just before and at this time. They differ at a jump.
        let sides = [strongest(&sounding, time_s, true), strongest(&sounding, time_s, false)];
        for (level, hertz) in sides.into_iter().flatten() {
            push(&mut all.level, Point::new(time_s, level));
            push(&mut all.frequency_hz, Point::new(time_s, hertz));
        }
    }
    all.from_s = times.first().copied().unwrap_or(0.0);
    all.to_s = times.last().copied().unwrap_or(0.0);
    all.transients = patterns.iter().flat_map(|p| p.transients.iter().copied()).collect();
    all.transients.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
    all
}

fn push(curve: &mut Vec<Point>, point: Point) {
    // Without a jump, both values are the same point.
    if curve.last() != Some(&point) {
        curve.push(point);
    }
}

/// Returns level and frequency of the strongest pattern at a time or, if `before` is true, just
/// before it. If no pattern sounds, the level is 0. Outside the range of all patterns, returns
/// `None`.
fn strongest(patterns: &[&Pattern], time_s: f64, before: bool) -> Option<(f64, f64)> {
    let (first, last) =
        patterns.iter().fold((f64::MAX, f64::MIN), |(a, b), p| (a.min(p.from_s), b.max(p.to_s)));
    let is_outside = if before { time_s <= first } else { time_s >= last };
    if is_outside && first < last {
        return None;
    }
    let here = patterns.iter().filter_map(|p| p.side(time_s, before));
    let silent = || patterns.first().and_then(|p| Some((0.0, p.frequency_hz.first()?.value)));
    here.max_by(|a, b| a.0.total_cmp(&b.0)).or_else(silent)
}

impl Pattern {
    fn times(&self) -> impl Iterator<Item = f64> + '_ {
        let points = self.level.iter().chain(&self.frequency_hz).map(|p| p.time_s);
        let (from_s, to_s) = (self.from_s, self.to_s);
        let inner = points.filter(move |t| (from_s..=to_s).contains(t));
        [from_s, to_s].into_iter().chain(inner)
    }

    /// Returns the amplitude and frequency at a time or, if `before` is true, just before it.
    /// Returns `None` if the pattern does not sound there.
    fn side(&self, time_s: f64, before: bool) -> Option<(f64, f64)> {
        let sounds = if before {
            self.from_s < time_s && time_s <= self.to_s
        } else {
            self.from_s <= time_s && time_s < self.to_s
        };
        let at = |curve: &[Point]| crate::curve::side(curve, time_s, before);
        let level = sounds.then(|| at(&self.level)).flatten()?;
        let amplitude = libm::pow(level, f64::from(self.exponent.max(1)));
        Some((amplitude, at(&self.frequency_hz)?))
    }
}
