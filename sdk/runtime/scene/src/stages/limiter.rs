//! Clips samples at the device's limit and, for an electrovibration display, at the drive voltage.
//! The stage counts clipped samples and replaces NaN by zero.

use htex_device::Quantity;

use super::{Entry, Need, Stage, StagePlace, Statistics};
use crate::file::Effect;
use crate::requirements::Requirements;

pub(crate) const ENTRY: Entry =
    Entry { effect: Effect::Limiter, name: "limiter", place: StagePlace::Device { need, build } };

fn need(required: &Requirements) -> Need {
    let unit = required.device.quantity.unit();
    match (limit(required), required.device.limit) {
        (Some(drive), Some(most)) if drive < most => {
            Need::yes(format!("the drive is {drive} {unit} at most"))
        }
        (Some(limit), _) => Need::yes(format!("the device takes at most {limit} {unit}")),
        (None, _) => Need::no("the device has no limit"),
    }
}

/// Returns the largest absolute value that a sample may have.
fn limit(required: &Requirements) -> Option<f64> {
    match (required.device.quantity, required.device.limit) {
        // Use the highest step of the device within the limit, so that rounding never exceeds the
        // limit.
        (Quantity::DisplayVoltage, Some(limit)) => {
            let most = limit.min(required.drive_v);
            let step = required.device.step.unwrap_or(0.0);
            // If rounding puts the quotient just below a whole number, one step is lost, which is
            // safe.
            let steps = (most / step).floor();
            Some(if step > 0.0 && steps > 0.0 { steps * step } else { most })
        }
        (_, limit) => limit,
    }
}

fn build(required: &Requirements, neutral: bool) -> Box<dyn Stage> {
    let limit = limit(required).filter(|_| !neutral);
    Box::new(Limiter { limit: limit.map_or(f32::INFINITY, at_most), held: 0 })
}

/// Returns the largest 32-bit float that is not above `limit`.
fn at_most(limit: f64) -> f32 {
    // `as` rounds to the nearest float, which may be above the limit.
    let near = limit as f32;
    if f64::from(near) > limit { near.next_down() } else { near }
}

struct Limiter {
    limit: f32,
    held: u64,
}

impl Stage for Limiter {
    fn render(&mut self, out: &mut [f32], source: &mut dyn FnMut(&mut [f32])) {
        source(out);
        let (limit, mut held) = (self.limit, 0);
        for sample in out {
            held += u64::from(sample.is_nan() || sample.abs() > limit);
            // `clamp` would let NaN through.
            *sample = if sample.is_nan() { 0.0 } else { sample.clamp(-limit, limit) };
        }
        self.held += held;
    }

    fn count(&self, statistics: &mut Statistics) {
        statistics.limited += self.held;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_beyond_the_limit_are_clipped_and_counted() {
        let (limit, mut statistics) = (at_most(0.1), Statistics::default());
        let mut limiter = Limiter { limit, held: 0 };
        let given = [0.05, -0.2, f32::INFINITY, f32::NEG_INFINITY, f32::NAN, -0.0];
        let mut out = given;
        limiter.render(&mut out, &mut |out| out.copy_from_slice(&given));
        assert_eq!(out, [0.05, -limit, limit, -limit, 0.0, 0.0]);
        limiter.count(&mut statistics);
        assert_eq!(statistics.limited, 4);
    }
}
