//! Computes the two time-dependent controls of an `.ahap` file, intensity and sharpness, and
//! applies them to the file's events.

use super::{
    ControlPoint, Entry, Event, INTENSITY, INTENSITY_CONTROL, SHARPNESS, SHARPNESS_CONTROL,
};
use crate::curve::{Point, side, value_at};
use crate::pattern::{Pattern, Transient};
use crate::profile::Profile;

/// The intensity control and the sharpness control.
pub(super) struct Controls {
    intensity: Control,
    sharpness: Control,
}

impl Controls {
    pub(super) fn new(entries: &[Entry]) -> Self {
        Self {
            intensity: Control::new(entries, INTENSITY_CONTROL, 1.0),
            sharpness: Control::new(entries, SHARPNESS_CONTROL, 0.0),
        }
    }

    /// Number of control points that change an event.
    pub(super) fn points_during(&self, event: &Event) -> usize {
        self.intensity.during(event).len() + self.sharpness.during(event).len()
    }

    /// Returns the vibration of a continuous event.
    pub(super) fn pattern(&self, event: &Event, profile: &Profile) -> Pattern {
        Pattern {
            from_s: event.time,
            to_s: event.end_s(),
            level: self.intensity.over(event, level(event)),
            exponent: 2,
            frequency_hz: self.sharpness.over(event, hertz(event, profile)),
            transients: Vec::new(),
        }
    }

    pub(super) fn transient(&self, event: &Event, profile: &Profile) -> Transient {
        Transient {
            time_s: event.time,
            amplitude: libm::pow(level(event)(self.intensity.value_at(event.time)), 2.0),
            frequency_hz: hertz(event, profile)(self.sharpness.value_at(event.time)),
        }
    }
}

/// Returns the level of an event as a function of the intensity control. The event's parameters are
/// looked up only once, not at each point.
fn level(event: &Event) -> impl Fn(f64) -> f64 {
    let intensity = event.parameter(INTENSITY, 1.0);
    move |control| (intensity * control).clamp(0.0, 1.0)
}

/// Returns the frequency of an event, hertz, as a function of the sharpness control.
fn hertz(event: &Event, profile: &Profile) -> impl Fn(f64) -> f64 {
    let sharpness = event.parameter(SHARPNESS, 0.5);
    move |control| profile.hertz_of((sharpness + control).clamp(0.0, 1.0))
}

/// The values of a control over time, including its value before the first point.
struct Control {
    points: Vec<Point>,
    usual: f64,
}

impl Control {
    fn new(entries: &[Entry], id: &str, usual: f64) -> Self {
        let mut curves: Vec<Vec<Point>> =
            entries.iter().filter_map(|entry| own_curve(entry, id)).collect();
        // Files may list curves in any order. The sort is stable, so curves with equal starts stay
        // in the order of the file.
        curves.sort_by(|a, b| start_s(a).total_cmp(&start_s(b)));
        let mut points: Vec<Point> = Vec::new();
        for curve in curves {
            // Between two curves, the control keeps its value.
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

    fn value_at(&self, time_s: f64) -> f64 {
        match self.points.first() {
            Some(first) if first.time_s <= time_s => {
                value_at(&self.points, time_s).unwrap_or(self.usual)
            }
            _ => self.usual,
        }
    }

    /// Returns the control's points during an event, and at the start and end of the event. `made`
    /// converts each value to the event's level or frequency.
    fn over(&self, event: &Event, made: impl Fn(f64) -> f64) -> Vec<Point> {
        let (from_s, to_s) = (event.time, event.end_s());
        let point = |time_s: f64, control: f64| Point::new(time_s, made(control));
        let mut over = vec![point(from_s, self.value_at(from_s))];
        let first = self.points.first();
        for (index, p) in self.during(event).iter().enumerate() {
            // At the control's first point, its value jumps from the default value.
            let begins = index == 0 && first.is_some_and(|first| first.time_s == p.time_s);
            if begins && self.usual != p.value {
                over.push(point(p.time_s, self.usual));
            }
            over.push(point(p.time_s, p.value));
        }
        let end = match first {
            // Takes the value just before the end, because a jump at the end belongs to the next
            // event.
            Some(first) if first.time_s < to_s => {
                side(&self.points, to_s, true).unwrap_or(self.usual)
            }
            _ => self.usual,
        };
        over.push(point(to_s, end));
        over
    }

    /// Returns the points between the start and the end of an event.
    fn during(&self, event: &Event) -> &[Point] {
        let from = self.points.partition_point(|p| p.time_s <= event.time);
        let to = self.points.partition_point(|p| p.time_s < event.end_s());
        self.points.get(from..to).unwrap_or_default()
    }
}

/// Returns the points of an entry, with absolute times, if the entry changes the control `id`.
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
