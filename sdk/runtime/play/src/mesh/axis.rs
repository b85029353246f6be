//! One axis of a mesh: speeds or forces, with equal values merged into one.

use htex_format::Condition;

use super::ON_SIDE;

/// Largest coordinate, so that all computed numbers stay finite.
const FAR: f64 = 1e100;

/// Maps speeds or forces to coordinates, relative to the largest recorded value. Coordinates ascend
/// with the value. Values that count as equal have the same coordinate.
#[derive(Debug, Clone)]
pub(super) struct Axis {
    groups: Vec<Group>,
    scale: f64,
}

/// Recorded values that share a coordinate, from the lowest to the highest.
#[derive(Debug, Clone)]
struct Group {
    low: f64,
    high: f64,
    place: f64,
}

impl Axis {
    /// Makes an axis from one or more recorded values, which must not be negative. If `merged` is
    /// true, values that are equal within the tolerance share a coordinate.
    pub(super) fn new(mut values: Vec<f64>, merged: bool) -> Self {
        htex_dsp::order::sort_by(&mut values, f64::total_cmp);
        let largest = values.last().copied().unwrap_or(0.0);
        // The reciprocal of the smallest numbers would be infinite.
        let scale = if largest > 0.0 { (1.0 / largest).min(f64::MAX) } else { 1.0 };
        let is_one = |a: &f64, x: f64| a == &x || (merged && Condition::is_same(*a, x));
        let mut groups: Vec<Group> = Vec::new();
        for x in values {
            match groups.last_mut() {
                // Compared with the lowest value of the group, so that a row of close values cannot
                // become one wide group.
                Some(group) if is_one(&group.low, x) => group.high = x,
                _ => groups.push(Group { low: x, high: x, place: 0.0 }),
            }
        }
        for group in &mut groups {
            group.place = 0.5 * (group.low + group.high) * scale;
        }
        Self { groups, scale }
    }

    /// Returns the speed or force at a coordinate. If several values share the coordinate, returns
    /// the value nearest to `x`. Beyond the recorded values, returns the last recorded value.
    pub(super) fn value(&self, place: f64, x: f64) -> f64 {
        let is_at = |group: &&Group| (group.place - place).abs() <= ON_SIDE;
        if let Some(group) = self.groups.iter().find(is_at) {
            return x.clamp(group.low, group.high);
        }
        let next = self.groups.partition_point(|group| group.place < place);
        let before = next.checked_sub(1).map(|i| &self.groups[i]);
        match (before, self.groups.get(next)) {
            (Some(below), Some(above)) => {
                let part = (place - below.place) / (above.place - below.place);
                below.high + part * (above.low - below.high)
            }
            (None, Some(first)) => first.low,
            (Some(last), None) => last.high,
            (None, None) => x,
        }
    }

    /// Returns the coordinate of a speed or force. Does not allocate.
    pub(super) fn place(&self, x: f64) -> f64 {
        let next = self.groups.partition_point(|group| group.high < x);
        let before = next.checked_sub(1).map(|i| &self.groups[i]);
        match (before, self.groups.get(next)) {
            (_, Some(group)) if x >= group.low => group.place,
            (Some(below), Some(above)) => {
                let part = (x - below.high) / (above.low - below.high);
                below.place + part * (above.place - below.place)
            }
            (None, Some(first)) => first.place - (first.low - x) * self.scale,
            (Some(last), None) => (last.place + (x - last.high) * self.scale).min(FAR),
            (None, None) => 0.0,
        }
    }
}
