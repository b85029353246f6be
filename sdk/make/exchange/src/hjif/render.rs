//! Renders the bands of a channel to samples.

use std::collections::BTreeMap;

use super::{Band, BandType, BaseSignal, Chosen, Effect, EffectType, Hjif, Keyframe, synthesised};
use crate::curve::{Point, Reader};
use crate::error::Fault;
use crate::pattern::{MOST_S, check_work};

/// Length of a transient, seconds. A transient is two periods of a sine
/// (source/Types/include/Band.h).
const TRANSIENT_S: f64 = 0.022;
/// Work for each coefficient of a block of wavelets, expressed as a number of samples.
const PER_COEFFICIENT: f64 = 4.0;

/// The effects to which bands can refer, by their ids.
type Library<'a> = BTreeMap<i64, &'a Effect>;

/// A band with its units converted to seconds.
struct BandInSeconds<'a> {
    band: &'a Band,
    library: &'a Library<'a>,
    /// Length of a tick, seconds.
    tick_s: f64,
    /// Factor that converts the file's frequencies to hertz.
    per_s: f64,
    rate_hz: f64,
}

impl Hjif {
    /// Renders the channel that the reader uses, at a sample rate in hertz. Samples lie between -1
    /// and 1. If positions in the file are distances, the texture is rendered for the finger's
    /// speed, mm/s.
    ///
    /// # Errors
    /// Returns an error if the channel is longer than ten minutes, or if rendering all of its
    /// effects would take too much computation.
    pub fn rendered(&self, rate_hz: f64, speed_mm_s: f64) -> Result<Vec<f64>, Fault> {
        let Some(chosen) = self.chosen() else {
            return Err(Fault::new("/perceptions", "no perception vibrates"));
        };
        // Speed at which a file over space is played, metres per second.
        let speed = if self.is_over_space() { speed_mm_s / 1e3 } else { 1.0 };
        let library = chosen.perception.effect_library.iter();
        let library: Library<'_> = library.filter_map(|e| Some((e.id?, e))).collect();
        let bands = chosen.channel.bands.iter().map(|band| BandInSeconds {
            band,
            library: &library,
            tick_s: chosen.tick(self.timescale) / speed,
            per_s: speed,
            rate_hz,
        });
        let bands: Vec<BandInSeconds<'_>> = bands.collect();
        let mut samples = vec![0.0; length(&bands, &chosen, rate_hz)?];
        for band in &bands {
            band.add_to(&mut samples);
        }
        let gain = chosen.channel.gain * chosen.channel.mixing_coefficient;
        samples.iter_mut().for_each(|x| *x = (gain * *x).clamp(-1.0, 1.0));
        Ok(samples)
    }
}

/// Returns the number of samples up to the end of the last effect.
fn length(bands: &[BandInSeconds<'_>], chosen: &Chosen<'_>, rate_hz: f64) -> Result<usize, Fault> {
    let (mut end_s, mut work) = (0.0f64, 0.0);
    for (index, band) in bands.iter().enumerate() {
        let at = || format!("{}/bands/{index}", chosen.pointer);
        for effect in band.effects() {
            let (from_s, to_s) = (band.start_s(&effect), band.end_s(&effect));
            if to_s > MOST_S {
                let problem = format!("it ends at {to_s:.0} s, and {MOST_S} s are read at most");
                return Err(Fault::new(at(), problem));
            }
            end_s = end_s.max(to_s);
            work += band.work(effect.effect, to_s - from_s);
            // Checked inside the loop, because a short file can refer to a long effect many times.
            check_work(work, rate_hz, at)?;
        }
    }
    Ok(first_from(end_s, rate_hz))
}

/// An effect and its position: its own one, or the position of a reference to the effect.
struct PlacedEffect<'a> {
    effect: &'a Effect,
    position: i64,
}

impl<'a> BandInSeconds<'a> {
    fn effects(&self) -> impl Iterator<Item = PlacedEffect<'a>> {
        let library = self.library;
        self.band.effects.iter().filter_map(move |effect| {
            let position = effect.position;
            let effect = match effect.effect_type {
                EffectType::Reference => library.get(&effect.id?).copied()?,
                _ => effect,
            };
            Some(PlacedEffect { effect, position })
        })
    }

    fn start_s(&self, placed: &PlacedEffect<'_>) -> f64 {
        placed.position as f64 * self.tick_s
    }

    fn end_s(&self, placed: &PlacedEffect<'_>) -> f64 {
        let keyframes = &placed.effect.keyframes;
        let last = keyframes.iter().filter_map(|k| k.relative_position).max().unwrap_or(0);
        let own_s = match self.band.band_type {
            BandType::WaveletWave => self.block_s(keyframes.len().saturating_sub(1)),
            BandType::Transient => last as f64 * self.tick_s + TRANSIENT_S,
            BandType::Curve | BandType::VectorialWave => last as f64 * self.tick_s,
        };
        self.start_s(placed) + own_s
    }

    /// Returns the work for an effect: the number of samples to which it is added, plus its number
    /// of keyframes. A transient effect adds samples at each keyframe.
    fn work(&self, effect: &Effect, length_s: f64) -> f64 {
        let keyframes = effect.keyframes.len() as f64;
        let samples = length_s * self.rate_hz;
        match self.band.band_type {
            BandType::Transient => keyframes * (TRANSIENT_S * self.rate_hz + 1.0),
            BandType::WaveletWave => samples + PER_COEFFICIENT * keyframes,
            BandType::Curve | BandType::VectorialWave => samples + keyframes,
        }
    }

    /// Returns the length of a block of wavelets, seconds. Its sample rate is the band's upper
    /// frequency limit.
    fn block_s(&self, samples: usize) -> f64 {
        match self.band.upper_frequency_limit * self.per_s {
            rate if rate > 0.0 => samples as f64 / rate,
            _ => 0.0,
        }
    }

    fn add_to(&self, samples: &mut [f64]) {
        for placed in self.effects() {
            let clock = Clock::new(self.start_s(&placed), self.rate_hz);
            let end = first_from(self.end_s(&placed), self.rate_hz);
            let end = samples.len().min(end);
            let Some(own) = samples.get_mut(clock.first.min(end)..end) else {
                continue;
            };
            match self.band.band_type {
                BandType::VectorialWave => self.add_wave(placed.effect, own, clock),
                BandType::WaveletWave => self.add_block(placed.effect, own, clock),
                BandType::Transient => self.add_transients(placed.effect, own, clock),
                BandType::Curve => self.add_curve(placed.effect, own, clock),
            }
        }
    }

    /// Returns the curve of a value of the keyframes over time, in seconds.
    fn curve(&self, effect: &Effect, value: impl Fn(&Keyframe) -> Option<f64>) -> Vec<Point> {
        let point = |k: &Keyframe| {
            Some(Point::new(k.relative_position.unwrap_or(0) as f64 * self.tick_s, value(k)?))
        };
        effect.keyframes.iter().filter_map(point).collect()
    }

    fn add_wave(&self, effect: &Effect, own: &mut [f64], clock: Clock) {
        let (low, high) = (self.band.lower_frequency_limit, self.band.upper_frequency_limit);
        let amplitude = self.curve(effect, |k| k.amplitude_modulation);
        let limited = |hz: f64| hz.clamp(low, high) * self.per_s;
        let frequency = self.curve(effect, |k| k.frequency_modulation.map(limited));
        let (mut amplitude, mut frequency) = (Reader::new(&amplitude), Reader::new(&frequency));
        let mut periods = effect.phase / std::f64::consts::TAU;
        let mut before_s = 0.0;
        for (index, sample) in own.iter_mut().enumerate() {
            let time_s = clock.into_s(index);
            // Frequencies are linear between keyframes, so the frequency at the middle of a step is
            // its mean over the step.
            let hz = frequency.value_at(0.5 * (before_s + time_s)).unwrap_or(0.0);
            periods += hz * (time_s - before_s);
            before_s = time_s;
            *sample +=
                amplitude.value_at(time_s).unwrap_or(1.0) * base(effect.base_signal, periods);
        }
    }

    fn add_block(&self, effect: &Effect, own: &mut [f64], clock: Clock) {
        let values = effect.keyframes.iter().map(|k| k.amplitude_modulation.unwrap_or(0.0));
        let mut coefficients: Vec<f64> = values.collect();
        // The last keyframe of a block is not a coefficient, but a factor for all coefficients.
        let scale = coefficients.pop().unwrap_or(0.0);
        coefficients.iter_mut().for_each(|c| *c *= scale);
        let block = synthesised(&coefficients);
        let per_s = self.band.upper_frequency_limit * self.per_s;
        for (index, sample) in own.iter_mut().enumerate() {
            // The reference software holds each sample until the next one, so this code does the
            // same.
            let at = libm::floor(clock.into_s(index) * per_s + 1e-6).max(0.0) as usize;
            *sample += block.get(at).copied().unwrap_or(0.0);
        }
    }

    fn add_transients(&self, effect: &Effect, own: &mut [f64], clock: Clock) {
        for at in self.curve(effect, |k| k.amplitude_modulation) {
            let (from, to) = (clock.index(at.time_s), clock.index(at.time_s + TRANSIENT_S));
            let to = to.min(own.len());
            let pulse = own.get_mut(from.min(to)..to).unwrap_or_default();
            for (index, sample) in pulse.iter_mut().enumerate() {
                let part = (clock.into_s(from + index) - at.time_s) / TRANSIENT_S;
                *sample += at.value * libm::sin(2.0 * std::f64::consts::TAU * part);
            }
        }
    }

    /// Adds a curve effect. All curves are read as straight lines between points. Other kinds of
    /// curves pass through the same points.
    fn add_curve(&self, effect: &Effect, own: &mut [f64], clock: Clock) {
        let curve = self.curve(effect, |k| k.amplitude_modulation);
        let mut curve = Reader::new(&curve);
        for (index, sample) in own.iter_mut().enumerate() {
            *sample += curve.value_at(clock.into_s(index)).unwrap_or(0.0);
        }
    }
}

/// Returns the index of the first sample at or after a time. A sample that is too early only
/// because of rounding also counts.
fn first_from(time_s: f64, rate_hz: f64) -> usize {
    libm::ceil(time_s * rate_hz - 1e-6).max(0.0) as usize
}

/// Converts between samples and the time since an effect's start.
#[derive(Clone, Copy)]
struct Clock {
    from_s: f64,
    rate_hz: f64,
    /// The first sample at or after the effect's start.
    first: usize,
}

impl Clock {
    fn new(from_s: f64, rate_hz: f64) -> Self {
        let first = first_from(from_s, rate_hz);
        Self { from_s, rate_hz, first }
    }

    /// Returns the time from the effect's start to one of its samples, seconds.
    fn into_s(self, index: usize) -> f64 {
        (self.first + index) as f64 / self.rate_hz - self.from_s
    }

    /// Returns the index of the first sample at or after a time since the effect's start.
    fn index(self, into_s: f64) -> usize {
        first_from(self.from_s + into_s, self.rate_hz).saturating_sub(self.first)
    }
}

/// Returns the value of a base signal after a number of periods.
fn base(signal: BaseSignal, periods: f64) -> f64 {
    let saw = 2.0 * (periods - libm::floor(periods + 0.5));
    match signal {
        BaseSignal::Sine => libm::sin(std::f64::consts::TAU * periods),
        BaseSignal::Square if periods - libm::floor(periods) < 0.5 => 1.0,
        BaseSignal::Square => -1.0,
        BaseSignal::Triangle => {
            let quarter = periods - 0.25;
            1.0 - 4.0 * (quarter - libm::round(quarter)).abs()
        }
        BaseSignal::SawToothUp => saw,
        BaseSignal::SawToothDown => -saw,
    }
}
