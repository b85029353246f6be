//! Reads and writes Meta's `.haptic` files, version 1. A file has an amplitude envelope and a
//! frequency envelope, with numbers from 0 to 1. Points of the amplitude envelope may have an
//! emphasis.
//!
//! The code follows the published specification (*.haptic File Specification 1.0*,
//! resources/haptic-file-spec.md of facebook/meta-haptics-sdk). As the specification requires, a
//! frequency point after the end of the amplitude envelope is an error. There is one exception, for
//! files that earlier editors wrote: the last frequency point may lie after this end if all other
//! frequency points lie before this end. A frequency in the file is a position in an actuator's
//! frequency range, so the reader needs the actuator's profile to convert this position to hertz.
//! Without frequency points, the frequency is at the position 0.5.

use serde::{Deserialize, Deserializer, Serialize};
use serde_json::Value;

use crate::curve::{Point, value_at};
use crate::error::Fault;
use crate::format::{Sampling, Signal};
use crate::json::{self, within};
use crate::pattern::{MOST_S, Pattern, Transient, rendered_of_file};
use crate::profile::Profile;

/// The frequency of a file without frequency points (section Frequency Envelope).
const USUAL_FREQUENCY: f64 = 0.5;

/// A `.haptic` file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Haptic {
    pub version: Version,
    #[serde(default)]
    pub metadata: Metadata,
    pub signals: Signals,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Version {
    pub major: u32,
    #[serde(default)]
    pub minor: u32,
    #[serde(default)]
    pub patch: u32,
}

#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Metadata {
    pub editor: String,
    pub author: String,
    pub source: String,
    pub project: String,
    pub tags: Vec<String>,
    pub description: String,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Signals {
    pub continuous: Continuous,
    /// A key from a draft of the format. It is ignored.
    #[serde(default, skip_serializing)]
    impulses: Option<Value>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Continuous {
    pub envelopes: Envelopes,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Envelopes {
    pub amplitude: Vec<Amplitude>,
    /// The frequency envelope. If this field is missing, null or empty, the file has no frequency
    /// points.
    #[serde(default, deserialize_with = "or_none")]
    pub frequency: Vec<Frequency>,
}

fn or_none<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<Frequency>, D::Error> {
    Ok(Option::deserialize(from)?.unwrap_or_default())
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Amplitude {
    /// Time, seconds.
    pub time: f64,
    /// Amplitude from 0 to 1.
    pub amplitude: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub emphasis: Option<Emphasis>,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Emphasis {
    /// Amplitude of the emphasis: at least the envelope's amplitude, and at most 1.
    pub amplitude: f64,
    /// Frequency from 0 to 1.
    pub frequency: f64,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Frequency {
    /// Time, seconds.
    pub time: f64,
    /// Frequency from 0 to 1.
    pub frequency: f64,
}

const AMPLITUDE: &str = "/signals/continuous/envelopes/amplitude";
const FREQUENCY: &str = "/signals/continuous/envelopes/frequency";

impl Haptic {
    /// Reads a `.haptic` file.
    ///
    /// # Errors
    /// Returns an error if the file is not JSON, has another version or structure, or breaks a rule
    /// of the format. The fault names the place.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, Fault> {
        let haptic: Self = json::read(bytes)?;
        haptic.check()?;
        Ok(haptic)
    }

    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        json::written(self)
    }

    fn check(&self) -> Result<(), Fault> {
        if self.version.major != 1 {
            let problem = format!("version {} is not known; version 1 is read", self.version.major);
            return Err(Fault::new("/version/major", problem));
        }
        let (start_s, end_s) = self.check_amplitude()?;
        self.check_frequency(start_s, end_s)
    }

    /// Checks the amplitude envelope. Returns its start and end.
    fn check_amplitude(&self) -> Result<(f64, f64), Fault> {
        let points = &self.signals.continuous.envelopes.amplitude;
        let mut before = 0.0;
        for (index, point) in points.iter().enumerate() {
            let at = format!("{AMPLITUDE}/{index}");
            check_time(format!("{at}/time"), point.time, before)?;
            before = point.time;
            point.check(&at)?;
        }
        let problem = match &points[..] {
            [first, .., last] if last.time > first.time => return Ok((first.time, last.time)),
            [_, _, ..] => {
                "it has no duration; its last point must be later than its first".to_owned()
            }
            _ => format!("it has {} points; it needs two or more", points.len()),
        };
        Err(Fault::new(AMPLITUDE, problem))
    }

    fn check_frequency(&self, start_s: f64, end_s: f64) -> Result<(), Fault> {
        let points = &self.signals.continuous.envelopes.frequency;
        let mut before = 0.0;
        for (index, point) in points.iter().enumerate() {
            let at = |key: &str| format!("{FREQUENCY}/{index}/{key}");
            check_time(at("time"), point.time, before)?;
            within(|| at("frequency"), "the frequency", point.frequency, 0.0..=1.0)?;
            let leads_across = index + 1 == points.len() && index > 0 && before < end_s;
            if point.time < start_s || (point.time > end_s && !leads_across) {
                let problem = format!(
                    "{} s is outside the amplitude envelope, {start_s} to {end_s} s; leave the point out",
                    point.time
                );
                return Err(Fault::new(at("time"), problem));
            }
            before = point.time;
        }
        Ok(())
    }

    /// Returns what the reader ignores in this file, as a list of sentences.
    #[must_use]
    pub fn left_out(&self) -> Vec<String> {
        let impulses = self.signals.impulses.iter();
        impulses
            .map(|_| "/signals/impulses is of a draft of the format, and is left out.".to_owned())
            .collect()
    }

    /// Returns the file's vibration for an actuator. The file gives frequencies as positions in
    /// this actuator's range.
    #[must_use]
    pub fn pattern(&self, profile: &Profile) -> Pattern {
        let envelopes = &self.signals.continuous.envelopes;
        let amplitude = &envelopes.amplitude;
        let (from_s, to_s) = match (amplitude.first(), amplitude.last()) {
            (Some(first), Some(last)) => (first.time, last.time),
            _ => (0.0, 0.0),
        };
        let hertz = |point: &Frequency| Point::new(point.time, profile.hertz_of(point.frequency));
        let mut frequency_hz: Vec<Point> = envelopes.frequency.iter().map(hertz).collect();
        if frequency_hz.is_empty() {
            frequency_hz.push(Point::new(from_s, profile.hertz_of(USUAL_FREQUENCY)));
        }
        let transient = |point: &Amplitude| {
            let emphasis = point.emphasis?;
            Some(Transient {
                time_s: point.time,
                amplitude: emphasis.amplitude,
                frequency_hz: profile.hertz_of(emphasis.frequency),
            })
        };
        Pattern {
            from_s,
            to_s,
            level: amplitude.iter().map(|p| Point::new(p.time, p.amplitude)).collect(),
            exponent: 1,
            frequency_hz,
            transients: amplitude.iter().filter_map(transient).collect(),
        }
    }

    /// Makes a file from a vibration whose levels are amplitudes. A transient becomes the emphasis
    /// of an amplitude point. If there is no amplitude point at the transient's time, a point is
    /// added. A transient before the start is moved to the start, and a transient after the end is
    /// moved to the end.
    #[must_use]
    pub fn from_pattern(pattern: &Pattern, profile: &Profile, metadata: Metadata) -> Self {
        let mut amplitude: Vec<Amplitude> = pattern.level.iter().map(plain).collect();
        if amplitude.is_empty() {
            let end_s = pattern.end_s();
            amplitude = [0.0, end_s].map(|time| plain(&Point::new(time, 0.0))).to_vec();
        }
        for transient in &pattern.transients {
            emphasise(&mut amplitude, transient, profile);
        }
        let frequency =
            |p: &Point| Frequency { time: p.time_s, frequency: profile.part_of(p.value) };
        Self {
            version: Version { major: 1, minor: 0, patch: 0 },
            metadata,
            signals: Signals {
                continuous: Continuous {
                    envelopes: Envelopes {
                        amplitude,
                        frequency: pattern.frequency_hz.iter().map(frequency).collect(),
                    },
                },
                impulses: None,
            },
        }
    }
}

impl Amplitude {
    fn check(&self, at: &str) -> Result<(), Fault> {
        let of = |key: &str| format!("{at}/{key}");
        within(|| of("amplitude"), "the amplitude", self.amplitude, 0.0..=1.0)?;
        let Some(emphasis) = self.emphasis else {
            return Ok(());
        };
        let range = self.amplitude..=1.0;
        within(|| of("emphasis/amplitude"), "the emphasis", emphasis.amplitude, range)?;
        within(|| of("emphasis/frequency"), "the frequency", emphasis.frequency, 0.0..=1.0)
    }
}

fn check_time(pointer: String, time: f64, before: f64) -> Result<(), Fault> {
    within(|| pointer.clone(), "the time", time, 0.0..=MOST_S)?;
    if time < before {
        let problem =
            format!("{time} s is before the {before} s of the point before; sort the points");
        return Err(Fault::new(pointer, problem));
    }
    Ok(())
}

fn plain(point: &Point) -> Amplitude {
    Amplitude { time: point.time_s, amplitude: point.value.clamp(0.0, 1.0), emphasis: None }
}

fn emphasise(points: &mut Vec<Amplitude>, transient: &Transient, profile: &Profile) {
    let (first, last) = match (points.first(), points.last()) {
        (Some(first), Some(last)) => (first.time, last.time),
        _ => return,
    };
    let time = transient.time_s.clamp(first, last);
    // If several points have this time, the last one counts, because it is the value after the
    // jump.
    let at = match points.iter().rposition(|point| point.time == time) {
        Some(at) => at,
        None => {
            let curve: Vec<Point> =
                points.iter().map(|p| Point::new(p.time, p.amplitude)).collect();
            let amplitude = value_at(&curve, time).unwrap_or(0.0);
            let at = points.partition_point(|point| point.time < time);
            points.insert(at, plain(&Point::new(time, amplitude)));
            at
        }
    };
    if let Some(point) = points.get_mut(at) {
        point.emphasis = Some(Emphasis {
            amplitude: transient.amplitude.clamp(point.amplitude, 1.0),
            frequency: profile.part_of(transient.frequency_hz),
        });
    }
}

/// Reads a file as a signal.
pub(crate) fn signal(bytes: &[u8], sampling: Sampling, profile: &Profile) -> Result<Signal, Fault> {
    let haptic = Haptic::from_bytes(bytes)?;
    Ok(Signal {
        samples: rendered_of_file(&[haptic.pattern(profile)], sampling.rate_hz, AMPLITUDE)?,
        left_out: haptic.left_out(),
    })
}
