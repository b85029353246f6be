//! Reduces the vibration that an asset plays to a vibration that an actuator can play: one tone, or
//! samples.
//!
//! **One tone.** In each block, the power of each band is divided by the squared detection
//! threshold in this band. The sum of these quotients over all bands measures how strongly a finger
//! feels the block. The tone's level is the level at which a finger feels the tone as strongly as
//! the block. It follows from the detection threshold at the tone's frequency. The tone's frequency
//! is the geometric mean of the bands' frequencies, limited to the actuator's range. In this mean,
//! the weight of each band is its share of the sum. If the actuator is too weak at this frequency,
//! the export moves the frequency towards the actuator's resonance until the actuator is strong
//! enough. If the actuator is too weak at every frequency, it plays the strongest tone that it can
//! produce, and the export counts this block as too strong for the actuator. **Samples.** The
//! export filters the asset's vibration by the inverse of the actuator's response. This filter
//! raises no frequency by more than 12 dB.

use htex_dsp::fir::Fir;
use htex_format::Quantity;

use crate::curve::Point;
use crate::heard::{Block, Heard, acceleration_of, threshold};
use crate::pattern::Pattern;
use crate::profile::{Kind, Profile};

/// Number of steps between a frequency and the resonance.
const STEPS: usize = 32;
/// Smallest response of the actuator that is still inverted: −12 dB.
const LEAST_RESPONSE: f64 = 0.25;
/// Resolution of the inverse filter, hertz.
const RESOLUTION_HZ: f64 = 16.0;

/// A pattern with one tone, and how often the actuator is too weak for it.
pub(crate) struct Reduction {
    pub(crate) pattern: Pattern,
    /// Fraction of the time during which the actuator is too weak, 0 to 1.
    pub(crate) limited: f64,
}

/// Reduces what an asset plays to one tone. If `fixed` is true, the tone is always at the
/// resonance.
pub(crate) fn one_tone(heard: &Heard, profile: &Profile, fixed: bool) -> Reduction {
    let felt = Felt::new(heard.quantity, heard.middles_hz());
    let (mut level, mut frequency_hz, mut limited) = (Vec::new(), Vec::new(), 0usize);
    for (index, block) in heard.blocks.iter().enumerate() {
        let (strength, wanted_hz) = felt.strength(block);
        let wanted_hz = if fixed { profile.resonance_hz.value } else { wanted_hz };
        let tone = match profile.kind {
            Kind::Resonant => resonant(profile, wanted_hz, strength),
            Kind::Rotating => rotating(profile, strength),
        };
        limited += usize::from(tone.is_limited);
        level.push(Point::new(heard.middle_s(index), tone.amplitude));
        frequency_hz.push(Point::new(heard.middle_s(index), tone.hertz));
    }
    Reduction {
        pattern: Pattern {
            from_s: 0.0,
            to_s: heard.seconds(),
            level: with_ends(level, heard.seconds()),
            exponent: 1,
            frequency_hz: with_ends(frequency_hz, heard.seconds()),
            transients: Vec::new(),
        },
        limited: limited as f64 / heard.blocks.len().max(1) as f64,
    }
}

/// Computes how strongly blocks are felt.
struct Felt {
    thresholds: Vec<f64>,
    middles_hz: Vec<f64>,
}

impl Felt {
    fn new(quantity: Quantity, middles_hz: Vec<f64>) -> Self {
        Self {
            thresholds: middles_hz.iter().map(|hertz| threshold(quantity, *hertz)).collect(),
            middles_hz,
        }
    }

    /// Returns the felt amplitude of a block relative to the threshold, and the mean frequency
    /// weighted by felt strength.
    fn strength(&self, block: &Block) -> (f64, f64) {
        let (mut energy, mut moment) = (0.0, 0.0);
        for ((power, threshold), hertz) in
            block.powers.iter().zip(&self.thresholds).zip(&self.middles_hz)
        {
            // A sine of amplitude A has a mean square of A²/2.
            let own = 2.0 * power / (threshold * threshold);
            energy += own;
            moment += own * libm::log(*hertz);
        }
        let hertz = if energy > 0.0 { libm::exp(moment / energy) } else { 0.0 };
        (libm::sqrt(energy), hertz)
    }
}

struct Tone {
    /// Amplitude from 0 to 1, relative to the strongest vibration at the frequency. For a rotating
    /// mass, it is the level.
    amplitude: f64,
    hertz: f64,
    is_limited: bool,
}

/// Returns the tone of a resonant actuator. Of the frequencies at which the actuator is strong
/// enough, the tone has the frequency nearest to the wanted one.
fn resonant(profile: &Profile, wanted_hz: f64, strength: f64) -> Tone {
    let resonance_hz = profile.resonance_hz.value;
    let wanted_hz = if wanted_hz > 0.0 {
        wanted_hz.clamp(profile.low_hz.value, profile.high_hz.value)
    } else {
        resonance_hz
    };
    let steps = (0..=STEPS)
        .map(|step| wanted_hz * libm::pow(resonance_hz / wanted_hz, step as f64 / STEPS as f64));
    let mut tones = steps.map(|hertz| {
        // Rounding may put the frequency slightly outside the range, where the response is 0.
        let hertz = hertz.clamp(profile.low_hz.value, profile.high_hz.value);
        let needed = strength * threshold(Quantity::Acceleration, hertz);
        let part = needed / profile.strongest_at(hertz);
        Tone { amplitude: part.min(1.0), hertz, is_limited: part > 1.0 }
    });
    // The first tone that is found is nearest to the wanted frequency, because the steps go from
    // there to the resonance.
    let enough = tones.by_ref().find(|tone| !tone.is_limited);
    enough.unwrap_or(Tone { amplitude: 1.0, hertz: resonance_hz, is_limited: true })
}

/// Returns the tone of a motor: the smallest level at which the motor is felt at least as strongly
/// as `strength`.
fn rotating(profile: &Profile, strength: f64) -> Tone {
    let (low_hz, high_hz) = (profile.low_hz.value, profile.high_hz.value);
    let felt = |hertz: f64| profile.strongest_at(hertz) / threshold(Quantity::Acceleration, hertz);
    let tone =
        |hertz: f64, is_limited: bool| Tone { amplitude: hertz / high_hz, hertz, is_limited };
    // Silence is closer to the wanted strength than the weakest vibration of the motor.
    if strength < 0.5 * felt(low_hz) {
        return Tone { amplitude: 0.0, hertz: low_hz, is_limited: false };
    }
    let steps =
        (0..=STEPS).map(|step| low_hz * libm::pow(high_hz / low_hz, step as f64 / STEPS as f64));
    // Rounding may put the last step above the range, where the response is 0.
    let enough = steps.map(|hertz| hertz.min(high_hz)).find(|hertz| felt(*hertz) >= strength);
    enough.map_or_else(|| tone(high_hz, true), |hertz| tone(hertz, false))
}

/// Adds a point with the first value at time 0, and a point with the last value at the end.
fn with_ends(mut curve: Vec<Point>, end_s: f64) -> Vec<Point> {
    if let (Some(first), Some(last)) = (curve.first().copied(), curve.last().copied()) {
        if first.time_s > 0.0 {
            curve.insert(0, Point::new(0.0, first.value));
        }
        if last.time_s < end_s {
            curve.push(Point::new(end_s, last.value));
        }
    }
    curve
}

/// Returns the vibration that an actuator plays from a file's pattern. In a motor, the frequency
/// follows the level, and the strength follows the square of the level.
pub(crate) fn played_by(pattern: Pattern, profile: &Profile) -> Pattern {
    if profile.kind == Kind::Resonant {
        return pattern;
    }
    let level: Vec<Point> = pattern
        .level
        .iter()
        .map(|p| Point::new(p.time_s, libm::pow(p.value, f64::from(pattern.exponent.max(1)))))
        .collect();
    let hertz = |p: &Point| Point::new(p.time_s, p.value * profile.high_hz.value);
    let frequency_hz = level.iter().map(hertz).collect();
    // Below its lowest frequency a motor does not turn.
    let turns = |p: &Point| {
        Point::new(
            p.time_s,
            if p.value * profile.high_hz.value < profile.low_hz.value { 0.0 } else { p.value },
        )
    };
    Pattern { level: level.iter().map(turns).collect(), exponent: 2, frequency_hz, ..pattern }
}

/// Several tones, each with its amplitude over time.
pub(crate) struct Tones {
    pub(crate) tones: Vec<(f64, Vec<Point>)>,
    pub(crate) limited: f64,
}

/// Reduces what an asset plays to one tone for each of several bands. If the actuator is weak in a
/// band, the tone plays at the resonance.
pub(crate) fn tones(heard: &Heard, profile: &Profile, count: usize) -> Tones {
    let felt = Felt::new(heard.quantity, heard.middles_hz());
    let mut sums = vec![0.0f64; heard.blocks.len()];
    let tone = |(hertz, bands): (f64, Vec<usize>)| {
        let per_unit = threshold(Quantity::Acceleration, hertz) / profile.strongest_at(hertz);
        let mut amplitude = Vec::with_capacity(heard.blocks.len());
        for (index, (block, sum)) in heard.blocks.iter().zip(&mut sums).enumerate() {
            let part = felt.strength(&block.only(&bands)).0 * per_unit;
            *sum += part;
            amplitude.push(Point::new(heard.middle_s(index), part.min(1.0)));
        }
        (hertz, with_ends(amplitude, heard.seconds()))
    };
    let groups = groups(&felt.middles_hz, profile, count);
    let tones: Vec<(f64, Vec<Point>)> = groups.into_iter().map(tone).collect();
    let limited = sums.iter().filter(|sum| **sum > 1.0).count() as f64 / sums.len().max(1) as f64;
    Tones { tones, limited }
}

/// Groups bands. Each group gets one frequency: its own or, if the actuator is weak there, the
/// resonance.
fn groups(middles_hz: &[f64], profile: &Profile, count: usize) -> Vec<(f64, Vec<usize>)> {
    let own = middles_hz.len().div_ceil(count.max(1)).max(1);
    let mut groups: Vec<(f64, Vec<usize>)> = Vec::new();
    for (group, middles) in middles_hz.chunks(own).enumerate() {
        let logarithms: f64 = middles.iter().map(|hz| libm::log(*hz)).sum();
        let hertz = libm::exp(logarithms / middles.len() as f64);
        let hertz = if profile.response(hertz) >= LEAST_RESPONSE {
            hertz
        } else {
            profile.resonance_hz.value
        };
        let bands = group * own..group * own + middles.len();
        // Exact equality suffices, because equal frequencies are copies of the same resonance.
        match groups.iter_mut().find(|(other, _)| *other == hertz) {
            Some((_, all)) => all.extend(bands),
            None => groups.push((hertz, bands.collect())),
        }
    }
    groups
}

/// Returns the samples that drive the actuator, limited to the range from -1 to 1, and the fraction
/// of samples that were limited.
pub(crate) fn drive(heard: &Heard, profile: &Profile) -> (Vec<f64>, f64) {
    let strongest = profile.strongest_m_s2.value;
    let gain = |hertz: f64| match profile.response(hertz) {
        // Outside its range the actuator plays nothing, whatever the gain.
        response if response > 0.0 => {
            acceleration_of(heard.quantity, hertz) / (strongest * response.max(LEAST_RESPONSE))
        }
        _ => 0.0,
    };
    // With an odd number of taps, the delay is a whole number of samples.
    let taps = (4.0 * heard.rate_hz / RESOLUTION_HZ) as usize | 1;
    let mut filter = Fir::with_magnitude(taps, heard.rate_hz, gain);
    let delay = taps / 2;
    let mut samples: Vec<f32> = heard.samples.iter().map(|x| *x as f32).collect();
    // The filter delays by half its length. Zeros are appended, so that the last samples also come
    // out of it.
    samples.resize(samples.len() + delay, 0.0);
    filter.process(&mut samples);
    let filtered = samples.into_iter().skip(delay).map(f64::from);
    let (mut limited, mut driven) = (0usize, Vec::with_capacity(heard.samples.len()));
    for x in filtered {
        limited += usize::from(x.abs() > 1.0);
        driven.push(x.clamp(-1.0, 1.0));
    }
    let part = limited as f64 / driven.len().max(1) as f64;
    (driven, part)
}
