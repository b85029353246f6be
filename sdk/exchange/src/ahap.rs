//! `.ahap` of Apple's Core Haptics, version 1: events that are continuous or transient, and curves of control points that change them.
//!
//! Read of Apple's documentation (*Representing haptic patterns in AHAP files*; `CHHapticParameterCurve`, `CHHapticEvent.ParameterID`): an
//! intensity control multiplies, a sharpness control adds, a control applies to all events from its first point on and is linear between
//! points, whose times count from the curve's. Apple states neither what an intensity is nor a sharpness. Here an intensity is the square root of an
//! amplitude, as in Meta's conversion (core/haptic_data/src/ahap.rs of facebook/meta-haptics-sdk), and a sharpness the position in a range of
//! frequencies, as in the reference software of ISO/IEC 23090-31.

use serde::{Deserialize, Serialize};

use crate::curve::{Point, side, value_at};
use crate::error::Fault;
use crate::formats::{Context, Signal};
use crate::json::{self, within};
use crate::pattern::{MOST_S, Pattern, Transient, rendered};
use crate::profile::Profile;

/// Longest continuous event, seconds (documentation of `CHHapticEvent.EventType.hapticContinuous`).
pub const LONGEST_EVENT_S: f64 = 30.0;
/// Most control points that one curve is written with.
pub const POINTS_OF_A_CURVE: usize = 16;

/// A file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "PascalCase")]
pub struct Ahap {
    pub version: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub metadata: Option<serde_json::Map<String, serde_json::Value>>,
    pub pattern: Vec<Entry>,
}

/// An entry of the pattern.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Entry {
    Event(Event),
    Parameter(Parameter),
    ParameterCurve(Curve),
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "PascalCase")]
pub struct Event {
    /// Seconds.
    pub time: f64,
    pub event_type: EventType,
    /// Seconds, of a continuous event.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub event_duration: Option<f64>,
    #[serde(default)]
    pub event_parameters: Vec<Value>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum EventType {
    HapticContinuous,
    HapticTransient,
    AudioContinuous,
    AudioCustom,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Value {
    #[serde(rename = "ParameterID")]
    pub id: String,
    #[serde(rename = "ParameterValue")]
    pub value: f64,
}

/// A control that changes at once.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Parameter {
    #[serde(rename = "ParameterID")]
    pub id: String,
    #[serde(rename = "ParameterValue")]
    pub value: f64,
    #[serde(rename = "Time")]
    pub time: f64,
}

/// A control that follows lines.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Curve {
    #[serde(rename = "ParameterID")]
    pub id: String,
    /// Seconds; those of the points count from here.
    #[serde(rename = "Time")]
    pub time: f64,
    #[serde(rename = "ParameterCurveControlPoints")]
    pub points: Vec<ControlPoint>,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "PascalCase")]
pub struct ControlPoint {
    pub time: f64,
    pub parameter_value: f64,
}

const INTENSITY: &str = "HapticIntensity";
const SHARPNESS: &str = "HapticSharpness";
const INTENSITY_CONTROL: &str = "HapticIntensityControl";
const SHARPNESS_CONTROL: &str = "HapticSharpnessControl";

impl Ahap {
    /// Reads a file.
    ///
    /// # Errors
    /// When it is no JSON, has another version or shape, or a number is out of its range; with the place.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, Fault> {
        let ahap: Self = json::read(bytes)?;
        if ahap.version != 1.0 {
            let problem = format!("version {} is not known; version 1 is read", ahap.version);
            return Err(Fault::new("/Version", problem));
        }
        for (index, entry) in ahap.pattern.iter().enumerate() {
            entry.check(&format!("/Pattern/{index}"))?;
        }
        Ok(ahap)
    }

    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        json::written(self)
    }

    /// What of the file is not read, each a sentence.
    #[must_use]
    pub fn left_out(&self) -> Vec<String> {
        let events = || self.events();
        let has = |id: &str| events().any(|e| e.event_parameters.iter().any(|p| p.id == id));
        let mut left_out = Vec::new();
        if events().any(|e| !e.is_haptic()) {
            left_out.push("Its audio events are left out.".to_owned());
        }
        if ["AttackTime", "DecayTime", "ReleaseTime", "Sustained"]
            .into_iter()
            .any(has)
        {
            left_out.push("The attack, decay and release of its events are left out.".to_owned());
        }
        left_out
    }

    fn events(&self) -> impl Iterator<Item = &Event> {
        self.pattern.iter().filter_map(|entry| match entry {
            Entry::Event(event) => Some(event),
            _ => None,
        })
    }

    /// Returns the vibrations for an actuator: one for each continuous event, and one with all transients.
    #[must_use]
    pub fn patterns(&self, profile: &Profile) -> Vec<Pattern> {
        let intensity = Control::of(&self.pattern, INTENSITY_CONTROL, 1.0);
        let sharpness = Control::of(&self.pattern, SHARPNESS_CONTROL, 0.0);
        let mut patterns = Vec::new();
        let mut pulses = Pattern {
            exponent: 1,
            ..Pattern::default()
        };
        for event in self.events() {
            let level = |control: f64| (event.parameter(INTENSITY, 1.0) * control).clamp(0.0, 1.0);
            let hertz = |control: f64| {
                let sharp = (event.parameter(SHARPNESS, 0.5) + control).clamp(0.0, 1.0);
                profile.hertz_of(sharp)
            };
            match event.event_type {
                EventType::HapticContinuous => patterns.push(Pattern {
                    from_s: event.time,
                    to_s: event.end_s(),
                    level: intensity.over(event, level),
                    exponent: 2,
                    frequency_hz: sharpness.over(event, hertz),
                    transients: Vec::new(),
                }),
                EventType::HapticTransient => pulses.transients.push(Transient {
                    time_s: event.time,
                    amplitude: libm::pow(level(intensity.at(event.time)), 2.0),
                    frequency_hz: hertz(sharpness.at(event.time)),
                }),
                EventType::AudioContinuous | EventType::AudioCustom => {}
            }
        }
        if !pulses.transients.is_empty() {
            patterns.push(pulses);
        }
        patterns
    }

    /// Makes a file of a vibration whose levels are amplitudes: curves of at most [`POINTS_OF_A_CURVE`] points over events of at most
    /// [`LONGEST_EVENT_S`]. The controls change transients, too, so that an intensity of theirs is divided by the control there, up to 1.
    #[must_use]
    pub fn of(pattern: &Pattern, profile: &Profile) -> Self {
        let root = |p: &Point| Point::new(p.time_s, libm::sqrt(p.value.clamp(0.0, 1.0)));
        let levels: Vec<Point> = pattern.level.iter().map(root).collect();
        let part = |p: &Point| Point::new(p.time_s, profile.part_of(p.value));
        let parts: Vec<Point> = pattern.frequency_hz.iter().map(part).collect();
        let mut entries = curves(INTENSITY_CONTROL, &levels);
        entries.extend(curves(SHARPNESS_CONTROL, &parts));
        if pattern.to_s > pattern.from_s {
            entries.extend(events(pattern.from_s, pattern.to_s));
        }
        let transient = |t: &Transient| transient(t, &levels, &parts, profile);
        entries.extend(pattern.transients.iter().map(transient));
        Self {
            version: 1.0,
            metadata: None,
            pattern: entries,
        }
    }
}

impl Entry {
    fn check(&self, at: &str) -> Result<(), Fault> {
        let seconds = |key: &str, value: f64| {
            within(|| format!("{at}/{key}"), "the time", value, 0.0..=MOST_S)
        };
        match self {
            Self::Event(event) => event.check(&format!("{at}/Event")),
            Self::Parameter(parameter) => {
                seconds("Parameter/Time", parameter.time)?;
                within(
                    || format!("{at}/Parameter/ParameterValue"),
                    "the value",
                    parameter.value,
                    -1.0..=1.0,
                )
            }
            Self::ParameterCurve(curve) => {
                seconds("ParameterCurve/Time", curve.time)?;
                let mut before = 0.0;
                for (index, point) in curve.points.iter().enumerate() {
                    let of = format!("ParameterCurve/ParameterCurveControlPoints/{index}");
                    seconds(&format!("{of}/Time"), point.time)?;
                    if point.time < before {
                        let problem = format!(
                            "{} s is before the point before; sort the points",
                            point.time
                        );
                        return Err(Fault::new(format!("{at}/{of}/Time"), problem));
                    }
                    before = point.time;
                    within(
                        || format!("{at}/{of}/ParameterValue"),
                        "the value",
                        point.parameter_value,
                        -1.0..=1.0,
                    )?;
                }
                Ok(())
            }
        }
    }
}

impl Event {
    fn check(&self, at: &str) -> Result<(), Fault> {
        within(|| format!("{at}/Time"), "the time", self.time, 0.0..=MOST_S)?;
        if self.event_type == EventType::HapticContinuous && self.event_duration.is_none() {
            return Err(Fault::new(
                at,
                "a continuous event has no EventDuration; give it in seconds",
            ));
        }
        let duration = self.event_duration.unwrap_or(0.0);
        within(
            || format!("{at}/EventDuration"),
            "the duration",
            duration,
            0.0..=MOST_S,
        )?;
        for (index, parameter) in self.event_parameters.iter().enumerate() {
            let of = || format!("{at}/EventParameters/{index}/ParameterValue");
            let range = match &parameter.id[..] {
                INTENSITY | SHARPNESS => 0.0..=1.0,
                _ => -MOST_S..=MOST_S,
            };
            within(of, "the value", parameter.value, range)?;
        }
        Ok(())
    }

    fn is_haptic(&self) -> bool {
        matches!(
            self.event_type,
            EventType::HapticContinuous | EventType::HapticTransient
        )
    }

    fn parameter(&self, id: &str, usual: f64) -> f64 {
        let own = self.event_parameters.iter().find(|p| p.id == id);
        own.map_or(usual, |parameter| parameter.value)
    }

    fn end_s(&self) -> f64 {
        self.time + self.event_duration.unwrap_or(0.0)
    }
}

/// A control over time, and its value before its first point.
struct Control {
    points: Vec<Point>,
    usual: f64,
}

impl Control {
    fn of(entries: &[Entry], id: &str, usual: f64) -> Self {
        let mut curves: Vec<Vec<Point>> = entries
            .iter()
            .filter_map(|entry| own_curve(entry, id))
            .collect();
        curves.sort_by(|a, b| start_s(a).total_cmp(&start_s(b)));
        let mut points: Vec<Point> = Vec::new();
        for curve in curves {
            // Between curves the control stays.
            if let (Some(last), Some(first)) = (points.last().copied(), curve.first())
                && last.time_s < first.time_s
            {
                points.push(Point::new(first.time_s, last.value));
            }
            points.extend(curve);
        }
        points.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
        points.dedup();
        Self { points, usual }
    }

    fn at(&self, time_s: f64) -> f64 {
        match self.points.first() {
            Some(first) if first.time_s <= time_s => {
                value_at(&self.points, time_s).unwrap_or(self.usual)
            }
            _ => self.usual,
        }
    }

    /// The control's points during an event and at its ends, each changed to what it makes of the event.
    fn over(&self, event: &Event, made: impl Fn(f64) -> f64) -> Vec<Point> {
        let (from_s, to_s) = (event.time, event.end_s());
        let point = |time_s: f64, control: f64| Point::new(time_s, made(control));
        let mut over = vec![point(from_s, self.at(from_s))];
        let inner = self
            .points
            .iter()
            .filter(|p| from_s < p.time_s && p.time_s < to_s);
        for (index, p) in inner.enumerate() {
            // A jump from the usual value to that of the first point.
            let begins = index == 0
                && self
                    .points
                    .first()
                    .is_some_and(|first| first.time_s == p.time_s);
            if begins && self.usual != p.value {
                over.push(point(p.time_s, self.usual));
            }
            over.push(point(p.time_s, p.value));
        }
        let end = match self.points.first() {
            Some(first) if first.time_s < to_s => {
                side(&self.points, to_s, true).unwrap_or(self.usual)
            }
            _ => self.usual,
        };
        over.push(point(to_s, end));
        over
    }
}

/// The points of an entry that changes a control, at their own times.
fn own_curve(entry: &Entry, id: &str) -> Option<Vec<Point>> {
    match entry {
        Entry::ParameterCurve(curve) if curve.id == id => {
            let at = |p: &ControlPoint| Point::new(curve.time + p.time, p.parameter_value);
            Some(curve.points.iter().map(at).collect())
        }
        Entry::Parameter(parameter) if parameter.id == id => {
            Some(vec![Point::new(parameter.time, parameter.value)])
        }
        _ => None,
    }
}

fn start_s(curve: &[Point]) -> f64 {
    curve.first().map_or(0.0, |point| point.time_s)
}

/// A curve in parts, of which each begins with the last point of the one before: between curves a control stays.
fn curves(id: &'static str, points: &[Point]) -> Vec<Entry> {
    let step = POINTS_OF_A_CURVE - 1;
    let count = points.len().saturating_sub(1).div_ceil(step).max(1);
    let part = |index: usize| {
        let from = index * step;
        let part = points.get(from..points.len().min(from + POINTS_OF_A_CURVE))?;
        let time = part.first()?.time_s;
        let point = |p: &Point| ControlPoint {
            time: p.time_s - time,
            parameter_value: p.value,
        };
        Some(Entry::ParameterCurve(Curve {
            id: id.to_owned(),
            time,
            points: part.iter().map(point).collect(),
        }))
    };
    (0..count).filter_map(part).collect()
}

fn events(from_s: f64, to_s: f64) -> impl Iterator<Item = Entry> {
    let count = libm::ceil((to_s - from_s) / LONGEST_EVENT_S).max(1.0) as usize;
    (0..count).map(move |index| {
        let time = from_s + index as f64 * LONGEST_EVENT_S;
        Entry::Event(Event {
            time,
            event_type: EventType::HapticContinuous,
            event_duration: Some((to_s - time).min(LONGEST_EVENT_S)),
            event_parameters: parameters(1.0, 0.0),
        })
    })
}

fn parameters(intensity: f64, sharpness: f64) -> Vec<Value> {
    let value = |id: &str, value: f64| Value {
        id: id.to_owned(),
        value,
    };
    vec![value(INTENSITY, intensity), value(SHARPNESS, sharpness)]
}

fn transient(t: &Transient, levels: &[Point], parts: &[Point], profile: &Profile) -> Entry {
    let control = |points: &[Point], usual: f64| match points.first() {
        Some(first) if first.time_s <= t.time_s => value_at(points, t.time_s).unwrap_or(usual),
        _ => usual,
    };
    let intensity = libm::sqrt(t.amplitude.clamp(0.0, 1.0)) / control(levels, 1.0).max(1e-6);
    let sharpness = profile.part_of(t.frequency_hz) - control(parts, 0.0);
    Entry::Event(Event {
        time: t.time_s,
        event_type: EventType::HapticTransient,
        event_duration: None,
        event_parameters: parameters(intensity.min(1.0), sharpness.clamp(0.0, 1.0)),
    })
}

/// Reads a file as a signal.
pub(crate) fn signal(bytes: &[u8], context: &Context<'_>) -> Result<Signal, Fault> {
    let ahap = Ahap::from_bytes(bytes)?;
    let patterns = ahap.patterns(context.profile);
    crate::pattern::check_work(&patterns, context.rate_hz)?;
    Ok(Signal {
        samples: rendered(&patterns, context.rate_hz),
        left_out: ahap.left_out(),
    })
}
