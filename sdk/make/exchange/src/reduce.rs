//! Reduction of what an asset plays to what an actuator can play.
//!
//! **One tone.** A block's powers in bands are each taken relative to the detection threshold in
//! the band, and added up to the strength that is felt. The tone is equally far above its own
//! threshold. Its frequency is the mean of the bands' frequencies, weighted by what is felt, within
//! the actuator's range. Where the actuator is too weak, the frequency moves towards its resonance,
//! no further than necessary. Where it is too weak at every frequency, the strongest possible tone
//! is played, and the time is counted as limited. **Samples** are filtered by the inverse of the
//! actuator's response, which raises no frequency by more than 12 dB.

use htex_dsp::fir::Fir;
use htex_format::Quantity;

use crate::curve::Point;
use crate::heard::{Block, Heard, acceleration_of, threshold};
use crate::pattern::Pattern;
use crate::profile::{Kind, Profile};

/// Number of steps in which a frequency moves to the resonance.
const STEPS: usize = 32;
/// Smallest response of the actuator that is still inverted: −12 dB.
const LEAST_RESPONSE: f64 = 0.25;
/// Resolution of the inverse filter, hertz.
const RESOLUTION_HZ: f64 = 16.0;

/// A pattern of one tone, and how often the actuator was too weak for it.
pub(crate) struct Reduction {
    pub(crate) pattern: Pattern,
    /// Fraction of the time in which the actuator is too weak.
    pub(crate) limited: f64,
}

/// Reduces what was heard to one tone; with `fixed`, always at the resonance.
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

/// Computes how strongly a block is felt.
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

    /// Returns the amplitude relative to the threshold, and the mean frequency weighted by what is
    /// felt.
    fn strength(&self, block: &Block) -> (f64, f64) {
        let (mut energy, mut moment) = (0.0, 0.0);
        for ((power, threshold), hertz) in
            block.powers.iter().zip(&self.thresholds).zip(&self.middles_hz)
        {
            // A sine of amplitude A has the mean square A²/2.
            let own = 2.0 * power / (threshold * threshold);
            energy += own;
            moment += own * libm::log(*hertz);
        }
        let hertz = if energy > 0.0 { libm::exp(moment / energy) } else { 0.0 };
        (libm::sqrt(energy), hertz)
    }
}

struct Tone {
    /// Amplitude from 0 to 1, relative to the strongest at its frequency; for a rotating mass, the
    /// level.
    amplitude: f64,
    hertz: f64,
    is_limited: bool,
}

/// The tone at the frequency nearest to the wanted one at which the actuator is strong enough.
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
        // Rounding of the power may step over an end of the range, where the response is 0.
        let hertz = hertz.clamp(profile.low_hz.value, profile.high_hz.value);
        let needed = strength * threshold(Quantity::Acceleration, hertz);
        let part = needed / profile.strongest_at(hertz);
        Tone { amplitude: part.min(1.0), hertz, is_limited: part > 1.0 }
    });
    // The first one is nearest to the wanted frequency: steps go from there to the resonance.
    let enough = tones.by_ref().find(|tone| !tone.is_limited);
    enough.unwrap_or(Tone { amplitude: 1.0, hertz: resonance_hz, is_limited: true })
}

/// The smallest level of a motor at which it is felt as strongly.
fn rotating(profile: &Profile, strength: f64) -> Tone {
    let (low_hz, high_hz) = (profile.low_hz.value, profile.high_hz.value);
    let felt = |hertz: f64| profile.strongest_at(hertz) / threshold(Quantity::Acceleration, hertz);
    let tone =
        |hertz: f64, is_limited: bool| Tone { amplitude: hertz / high_hz, hertz, is_limited };
    // Silence is closer to this than the weakest vibration of the motor.
    if strength < 0.5 * felt(low_hz) {
        return Tone { amplitude: 0.0, hertz: low_hz, is_limited: false };
    }
    let steps =
        (0..=STEPS).map(|step| low_hz * libm::pow(high_hz / low_hz, step as f64 / STEPS as f64));
    // Rounding may put the last step above the range, where the response is 0.
    let enough = steps.map(|hertz| hertz.min(high_hz)).find(|hertz| felt(*hertz) >= strength);
    enough.map_or_else(|| tone(high_hz, true), |hertz| tone(hertz, false))
}

/// Adds points at time 0 and at the end, with the first and the last value.
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

/// What an actuator plays of a file's pattern. The frequency of a motor follows its level, and its
/// strength the square of the level.
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

/// Several tones, with their amplitudes over time.
pub(crate) struct Tones {
    pub(crate) tones: Vec<(f64, Vec<Point>)>,
    pub(crate) limited: f64,
}

/// Reduces what was heard to one tone in each of several bands. Bands in which the actuator is weak
/// are played at its resonance.
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

/// Groups bands, each group with one frequency: its own, or the resonance if the actuator is weak
/// at its own.
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
        // Exact equality suffices: equal frequencies are copies of the same resonance.
        match groups.iter_mut().find(|(other, _)| *other == hertz) {
            Some((_, all)) => all.extend(bands),
            None => groups.push((hertz, bands.collect())),
        }
    }
    groups
}

/// Returns the samples within ±1 that drive the actuator, and the fraction of them that was too
/// strong.
pub(crate) fn drive(heard: &Heard, profile: &Profile) -> (Vec<f64>, f64) {
    let strongest = profile.strongest_m_s2.value;
    let gain = |hertz: f64| match profile.response(hertz) {
        // Outside its range the actuator plays nothing, and no gain would change that.
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
    // The filter delays by half its length, and the last samples must come out of it too.
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
