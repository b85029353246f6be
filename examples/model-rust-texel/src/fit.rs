//! Fits a comb to a spectrum. A harmonic sum gives the fundamental. The bins nearest to a harmonic
//! give its amplitude. The distance of these bins from the harmonics gives the jitter.

use alloc::vec;
use alloc::vec::Vec;

use htex_model::{Error, Fit, FitInput, Model, Values};

use crate::comb::{Comb, HARMONICS};
use crate::{FORCE_N, SPEED_MM_S, Texel};

/// Assumed speed of a recording of unknown speed, mm/s.
const USUAL_SPEED_MM_S: f64 = 100.0;
/// Smallest distance between harmonics that a grid of 5 Hz can resolve.
const LEAST_FUNDAMENTAL_HZ: f64 = 20.0;
/// Step of the search, hertz: a twentieth of a bin.
const STEP_HZ: f64 = 0.25;
/// A comb sum that is at least this fraction of the largest comb sum counts as equal to it.
const NEARLY: f64 = 0.85;
/// Largest spread that can be distinguished from noise around the lines.
const MOST_JITTER: f64 = 0.05;
/// Variance of the power of a single line over the bins around it, Hz². The line appears in three
/// bins. The two outer bins have half the amplitude and are 5 Hz away.
const WINDOW_VARIANCE: f64 = 2.0 * 0.25 * 25.0 / 1.5;

pub(crate) fn fit(input: &FitInput<'_>) -> Result<Fit, Error> {
    let largest = input.magnitude.iter().copied().fold(0.0, f64::max);
    if largest <= 0.0 {
        return Err(Error::cannot_fit(
            "the spectrum is silent: there is nothing to fit",
        ));
    }
    let spectrum = Power {
        frequency_hz: input.frequency_hz,
        power: input
            .magnitude
            .iter()
            .map(|m| (m / largest) * (m / largest))
            .collect(),
        high_hz: input.band.high_hz,
    };
    let found = spectrum.fundamental_hz().ok_or_else(|| {
        Error::cannot_fit("the spectrum has no lines at multiples of one frequency")
    })?;
    let fundamental_hz = (0..8).fold(found, |f, _| spectrum.refined(f));
    let harmonics = spectrum.harmonics(fundamental_hz);
    let strongest = harmonics.iter().map(|h| h.power).fold(0.0, f64::max);
    let count = 1 + harmonics
        .iter()
        .rposition(|h| h.power > 1e-8 * strongest)
        .unwrap_or(0);
    let amplitude = harmonics[..count]
        .iter()
        .map(|h| libm::sqrt(h.power / strongest));
    let known = input.condition.speed_mm_s.filter(|&speed| speed > 0.0);
    let speed_mm_s = known
        .unwrap_or(USUAL_SPEED_MM_S)
        .clamp(SPEED_MM_S.0, SPEED_MM_S.1);
    let force_n = input
        .condition
        .force_n
        .unwrap_or(0.0)
        .clamp(FORCE_N.0, FORCE_N.1);
    let mut parameters = vec![
        speed_mm_s / fundamental_hz,
        speed_mm_s,
        force_n,
        jitter(&harmonics, fundamental_hz),
        count as f64,
    ];
    parameters.extend(amplitude);
    playable(&parameters, input)?;
    let total: f64 = harmonics.iter().map(|h| h.power).sum();
    Ok(Fit {
        parameters,
        level_rms: largest * libm::sqrt(total / 3.0),
    })
}

/// Checks that a comb has lines apart from those at the band's edges, which are silent.
fn playable(parameters: &[f64], input: &FitInput<'_>) -> Result<(), Error> {
    let comb = Values::read(&Texel::DESCRIPTOR, parameters)
        .and_then(|v| Comb::new(&v, input.band).map(|_| ()));
    comb.map_err(|error| Error::cannot_fit(error.message))
}

/// Squared magnitudes, relative to the largest.
struct Power<'a> {
    frequency_hz: &'a [f64],
    power: Vec<f64>,
    high_hz: f64,
}

/// The power nearest to one multiple of the fundamental.
#[derive(Clone, Copy, Default)]
struct Harmonic {
    power: f64,
    /// Σ power · distance, and Σ power · distance².
    first_moment: f64,
    second_moment: f64,
}

impl Power<'_> {
    /// Linear interpolation between bins; 0 outside them.
    fn at(&self, frequency_hz: f64) -> f64 {
        let above = self.frequency_hz.partition_point(|&f| f <= frequency_hz);
        if above == 0 {
            return 0.0;
        }
        let (f, p) = (self.frequency_hz[above - 1], self.power[above - 1]);
        let (Some(g), Some(q)) = (self.frequency_hz.get(above), self.power.get(above)) else {
            return if f == frequency_hz { p } else { 0.0 };
        };
        p + (q - p) * (frequency_hz - f) / (g - f)
    }

    /// Power at the multiples of a frequency minus power between them. For half of the true
    /// fundamental, or its double, both are equal.
    fn comb_sum(&self, fundamental_hz: f64) -> f64 {
        (1..=HARMONICS)
            .map(|k| k as f64 * fundamental_hz)
            .take_while(|&f| f <= self.high_hz)
            .map(|f| {
                let half = 0.5 * fundamental_hz;
                self.at(f) - 0.5 * (self.at(f - half) + self.at(f + half))
            })
            .sum()
    }

    /// Returns the highest frequency whose comb sum is nearly the largest. Lower frequencies can
    /// have an equal sum, e.g. a third of the fundamental.
    fn fundamental_hz(&self) -> Option<f64> {
        let low_hz = self.frequency_hz.first()?.max(LEAST_FUNDAMENTAL_HZ);
        let steps = ((self.frequency_hz.last()? - low_hz) / STEP_HZ).max(0.0) as usize;
        let scored: Vec<(f64, f64)> = (0..=steps.min(100_000))
            .map(|i| low_hz + i as f64 * STEP_HZ)
            .map(|f| (self.comb_sum(f), f))
            .collect();
        let best = |part: &[(f64, f64)]| part.iter().copied().fold((1e-6, None), higher);
        let (largest, found) = best(&scored);
        found?;
        let last = scored.iter().rposition(|s| s.0 >= NEARLY * largest)?;
        let bin = (5.0 / STEP_HZ) as usize;
        best(&scored[last.saturating_sub(bin)..=last]).1
    }

    /// Returns the fundamental whose multiples have the least squared distance from the power
    /// around them.
    fn refined(&self, fundamental_hz: f64) -> f64 {
        let (mut sum, mut weight) = (0.0, 0.0);
        for (i, h) in self.harmonics(fundamental_hz).iter().enumerate() {
            let k = (i + 1) as f64;
            sum += k * h.first_moment;
            weight += k * k * h.power;
        }
        let shift = if weight > 0.0 { sum / weight } else { 0.0 };
        fundamental_hz + shift.clamp(-STEP_HZ, STEP_HZ)
    }

    /// Each bin is assigned to the nearest multiple, so that all power is counted.
    fn harmonics(&self, fundamental_hz: f64) -> [Harmonic; HARMONICS] {
        let mut harmonics = [Harmonic::default(); HARMONICS];
        for (&f, &power) in self.frequency_hz.iter().zip(&self.power) {
            let k = libm::round(f / fundamental_hz);
            if !(1.0..=HARMONICS as f64).contains(&k) {
                continue;
            }
            let distance = f - k * fundamental_hz;
            let harmonic = &mut harmonics[k as usize - 1];
            harmonic.power += power;
            harmonic.first_moment += power * distance;
            harmonic.second_moment += power * distance * distance;
        }
        harmonics
    }
}

fn higher(best: (f64, Option<f64>), (sum, f): (f64, f64)) -> (f64, Option<f64>) {
    if sum > best.0 { (sum, Some(f)) } else { best }
}

/// Returns the relative spread of the lines, computed from the distance of the power from the
/// harmonics. The part of this distance that the window causes is subtracted.
fn jitter(harmonics: &[Harmonic], fundamental_hz: f64) -> f64 {
    let (mut variance, mut weight) = (0.0, 0.0);
    for (i, h) in harmonics.iter().enumerate() {
        let centre_hz = (i + 1) as f64 * fundamental_hz;
        variance += (h.second_moment - WINDOW_VARIANCE * h.power).max(0.0);
        weight += h.power * centre_hz * centre_hz;
    }
    let jitter = if weight > 0.0 {
        libm::sqrt(variance / weight)
    } else {
        0.0
    };
    jitter.clamp(0.0, MOST_JITTER)
}
