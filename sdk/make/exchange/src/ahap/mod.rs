//! Reads and writes Apple's Core Haptics files, `.ahap` version 1. A file contains continuous
//! events, transient events, and controls. Controls change the events. The values of a control over
//! time form a curve between control points.
//!
//! The code follows Apple's documentation (*Representing haptic patterns in AHAP files*;
//! `CHHapticParameterCurve`, `CHHapticEvent.ParameterID`). The intensity control multiplies the
//! intensity of events. The sharpness control is added to the sharpness of events. From its first
//! point on, a control applies to all events. Between points, the value of a control is linear. The
//! times of a curve's points are relative to the start of the curve. Apple does not define physical
//! meanings of intensity and sharpness. This module uses two existing conventions. An intensity is
//! the square root of an amplitude, as in Meta's conversion (core/haptic_data/src/ahap.rs of
//! facebook/meta-haptics-sdk). A sharpness is a position in a range of frequencies, as in the
//! reference software of ISO/IEC 23090-31.

mod control;
mod write;

use std::ops::RangeInclusive;

use serde::{Deserialize, Serialize};

use crate::error::Fault;
use crate::format::{Sampling, Signal};
use crate::json::{self, within};
use crate::pattern::{MOST_S, Pattern, rendered_of_file};
use crate::profile::Profile;
use control::Controls;

/// Longest allowed continuous event, seconds (documentation of
/// `CHHapticEvent.EventType.hapticContinuous`).
pub(crate) const LONGEST_EVENT_S: f64 = 30.0;
/// Largest number of control points that are written into one curve.
pub(crate) const POINTS_OF_A_CURVE: usize = 16;

/// An `.ahap` file.
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
    /// Time, seconds.
    pub time: f64,
    pub event_type: EventType,
    /// Duration of a continuous event, seconds.
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

/// A new value of a control, which takes effect immediately.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Parameter {
    #[serde(rename = "ParameterID")]
    pub id: String,
    #[serde(rename = "ParameterValue")]
    pub value: f64,
    #[serde(rename = "Time")]
    pub time: f64,
}

/// Values of a control over time: points with straight lines between them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Curve {
    #[serde(rename = "ParameterID")]
    pub id: String,
    /// Start of the curve, seconds. The times of the curve's points are relative to this time.
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

/// Largest allowed number of curve points during events. A point counts once for each event that it
/// changes.
const MOST_POINTS: usize = 1_000_000;
/// Largest allowed total duration of all events, seconds.
const MOST_TOGETHER_S: f64 = 4_000.0;

const INTENSITY: &str = "HapticIntensity";
const SHARPNESS: &str = "HapticSharpness";
const INTENSITY_CONTROL: &str = "HapticIntensityControl";
const SHARPNESS_CONTROL: &str = "HapticSharpnessControl";

impl Ahap {
    /// Reads an `.ahap` file.
    ///
    /// # Errors
    /// Returns an error if the file is not JSON, if its version or structure is unknown, or if a
    /// number is out of range. The fault names the place in the file.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, Fault> {
        let ahap: Self = json::read(bytes)?;
        if ahap.version != 1.0 {
            let problem = format!("version {} is not known; version 1 is read", ahap.version);
            return Err(Fault::new("/Version", problem));
        }
        for (index, entry) in ahap.pattern.iter().enumerate() {
            entry.check(&format!("/Pattern/{index}"))?;
        }
        ahap.check_work()?;
        Ok(ahap)
    }

    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        json::written(self)
    }

    /// Returns what the reader ignores in this file, as a list of sentences.
    #[must_use]
    pub fn left_out(&self) -> Vec<String> {
        let events = || self.events();
        let has = |id: &str| events().any(|e| e.event_parameters.iter().any(|p| p.id == id));
        let mut left_out = Vec::new();
        if events().any(|e| !e.is_haptic()) {
            left_out.push("Its audio events are left out.".to_owned());
        }
        if ["AttackTime", "DecayTime", "ReleaseTime", "Sustained"].into_iter().any(has) {
            left_out.push("The attack, decay and release of its events are left out.".to_owned());
        }
        let known = [INTENSITY_CONTROL, SHARPNESS_CONTROL];
        let controls = self.pattern.iter().filter_map(Entry::control);
        if controls.into_iter().any(|id| !known.contains(&id)) {
            left_out.push("Its controls beside intensity and sharpness are left out.".to_owned());
        }
        left_out
    }

    fn events(&self) -> impl Iterator<Item = &Event> {
        self.pattern.iter().filter_map(|entry| match entry {
            Entry::Event(event) => Some(event),
            _ => None,
        })
    }

    /// Returns the file's vibrations, as an actuator with this profile plays them. Each continuous
    /// event becomes one vibration. All transients together become one further vibration.
    #[must_use]
    pub fn patterns(&self, profile: &Profile) -> Vec<Pattern> {
        let controls = Controls::new(&self.pattern);
        let of = |kind: EventType| self.events().filter(move |e| e.event_type == kind);
        let continuous = of(EventType::HapticContinuous).map(|e| controls.pattern(e, profile));
        let transients = of(EventType::HapticTransient).map(|e| controls.transient(e, profile));
        let pulses =
            Pattern { exponent: 1, transients: transients.collect(), ..Pattern::default() };
        let pulses = Some(pulses).filter(|pulses| !pulses.transients.is_empty());
        continuous.chain(pulses).collect()
    }

    /// Returns a fault if the events and curves together would take too much time to render.
    fn check_work(&self) -> Result<(), Fault> {
        let controls = Controls::new(&self.pattern);
        let points: usize = self.events().map(|event| controls.points_during(event)).sum();
        let seconds: f64 = self.events().filter_map(|event| event.event_duration).sum();
        if points > MOST_POINTS || seconds > MOST_TOGETHER_S {
            let problem = format!(
                "its events have {points} points of curves and last {seconds} s together; at most {MOST_POINTS} and {MOST_TOGETHER_S} s are read"
            );
            return Err(Fault::new("/Pattern", problem));
        }
        Ok(())
    }
}

impl Entry {
    /// Returns the control that this entry changes, if any.
    fn control(&self) -> Option<&str> {
        match self {
            Self::Event(_) => None,
            Self::Parameter(parameter) => Some(&parameter.id),
            Self::ParameterCurve(curve) => Some(&curve.id),
        }
    }

    fn check(&self, at: &str) -> Result<(), Fault> {
        match self {
            Self::Event(event) => event.check(&format!("{at}/Event")),
            Self::Parameter(parameter) => {
                let at = format!("{at}/Parameter");
                check_time(&at, parameter.time)?;
                check_value(&at, parameter.value, -1.0..=1.0)
            }
            Self::ParameterCurve(curve) => curve.check(&format!("{at}/ParameterCurve")),
        }
    }
}

fn check_time(at: &str, seconds: f64) -> Result<(), Fault> {
    within(|| format!("{at}/Time"), "the time", seconds, 0.0..=MOST_S)
}

fn check_value(at: &str, value: f64, range: RangeInclusive<f64>) -> Result<(), Fault> {
    within(|| format!("{at}/ParameterValue"), "the value", value, range)
}

impl Curve {
    fn check(&self, at: &str) -> Result<(), Fault> {
        check_time(at, self.time)?;
        let mut before = 0.0;
        for (index, point) in self.points.iter().enumerate() {
            let at = format!("{at}/ParameterCurveControlPoints/{index}");
            check_time(&at, point.time)?;
            if point.time < before {
                let problem =
                    format!("{} s is before the point before; sort the points", point.time);
                return Err(Fault::new(format!("{at}/Time"), problem));
            }
            before = point.time;
            check_value(&at, point.parameter_value, -1.0..=1.0)?;
        }
        Ok(())
    }
}

impl Event {
    fn check(&self, at: &str) -> Result<(), Fault> {
        check_time(at, self.time)?;
        if self.event_type == EventType::HapticContinuous && self.event_duration.is_none() {
            let problem = "a continuous event has no EventDuration; give it in seconds";
            return Err(Fault::new(at, problem));
        }
        let duration = self.event_duration.unwrap_or(0.0);
        let of = || format!("{at}/EventDuration");
        within(of, "the duration", duration, 0.0..=MOST_S)?;
        for (index, parameter) in self.event_parameters.iter().enumerate() {
            let range = match &parameter.id[..] {
                INTENSITY | SHARPNESS => 0.0..=1.0,
                _ => -MOST_S..=MOST_S,
            };
            check_value(&format!("{at}/EventParameters/{index}"), parameter.value, range)?;
        }
        Ok(())
    }

    fn is_haptic(&self) -> bool {
        matches!(self.event_type, EventType::HapticContinuous | EventType::HapticTransient)
    }

    fn parameter(&self, id: &str, usual: f64) -> f64 {
        let own = self.event_parameters.iter().find(|p| p.id == id);
        own.map_or(usual, |parameter| parameter.value)
    }

    fn end_s(&self) -> f64 {
        self.time + self.event_duration.unwrap_or(0.0)
    }
}

/// Reads a file as a signal.
pub(crate) fn signal(bytes: &[u8], sampling: Sampling, profile: &Profile) -> Result<Signal, Fault> {
    let ahap = Ahap::from_bytes(bytes)?;
    Ok(Signal {
        samples: rendered_of_file(&ahap.patterns(profile), sampling.rate_hz, "/Pattern")?,
        left_out: ahap.left_out(),
    })
}
