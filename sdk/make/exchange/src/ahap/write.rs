//! Writes a vibration as an `.ahap` file.

use super::{
    Ahap, ControlPoint, Curve, Entry, Event, EventType, INTENSITY, INTENSITY_CONTROL,
    LONGEST_EVENT_S, POINTS_OF_A_CURVE, SHARPNESS, SHARPNESS_CONTROL, Value,
};
use crate::curve::{Point, value_at};
use crate::pattern::{Pattern, Transient};
use crate::profile::Profile;

impl Ahap {
    /// Makes a file from a vibration whose levels are amplitudes. The file has curves of at most 16
    /// points, and events of at most 30 s. The curves also change transients. To compensate for
    /// this, the intensity of each transient is divided by the curve's value at the transient's
    /// time, and limited to 1.
    #[must_use]
    pub fn from_pattern(pattern: &Pattern, profile: &Profile) -> Self {
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
        Self { version: 1.0, metadata: None, pattern: entries }
    }

    /// Sets a description in the metadata, unless `description` is empty.
    #[must_use]
    pub(crate) fn with_description(mut self, description: &str) -> Self {
        if !description.is_empty() {
            let metadata = self.metadata.get_or_insert_default();
            metadata.insert("Description".to_owned(), description.into());
        }
        self
    }
}

/// Splits a curve into parts. Each part begins with the last point of the previous part. Otherwise
/// the control would keep its value between the parts instead of following the line.
fn curves(id: &'static str, points: &[Point]) -> Vec<Entry> {
    // The last point of a curve is also the first point of the next one. Otherwise the control
    // would stand still between them.
    let step = POINTS_OF_A_CURVE - 1;
    let count = points.len().saturating_sub(1).div_ceil(step).max(1);
    let part = |index: usize| {
        let from = index * step;
        let part = points.get(from..points.len().min(from + POINTS_OF_A_CURVE))?;
        let time = part.first()?.time_s;
        let point = |p: &Point| ControlPoint { time: p.time_s - time, parameter_value: p.value };
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
            // Controls multiply the intensity and are added to the sharpness. With the values 1 and
            // 0 here, intensity and sharpness depend only on the curves.
            event_parameters: parameters(1.0, 0.0),
        })
    })
}

fn parameters(intensity: f64, sharpness: f64) -> Vec<Value> {
    let value = |id: &str, value: f64| Value { id: id.to_owned(), value };
    vec![value(INTENSITY, intensity), value(SHARPNESS, sharpness)]
}

fn transient(t: &Transient, levels: &[Point], parts: &[Point], profile: &Profile) -> Entry {
    let control = |points: &[Point], usual: f64| match points.first() {
        Some(first) if first.time_s <= t.time_s => value_at(points, t.time_s).unwrap_or(usual),
        _ => usual,
    };
    // Controls also change transients, so the event states the intensity that gives the right
    // amplitude after the control was applied.
    let intensity = libm::sqrt(t.amplitude.clamp(0.0, 1.0)) / control(levels, 1.0).max(1e-6);
    let sharpness = profile.part_of(t.frequency_hz) - control(parts, 0.0);
    Entry::Event(Event {
        time: t.time_s,
        event_type: EventType::HapticTransient,
        event_duration: None,
        event_parameters: parameters(intensity.min(1.0), sharpness.clamp(0.0, 1.0)),
    })
}
