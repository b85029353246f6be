//! Rounding to the resolution of the device.

use super::{Entry, Need, Stage, StagePlace};
use crate::file::Effect;
use crate::requirements::Requirements;

pub(crate) const ENTRY: Entry = Entry {
    effect: Effect::Quantisation,
    name: "quantisation",
    place: StagePlace::Device { need, build },
};

fn need(required: &Requirements) -> Need {
    match required.device.step {
        Some(step) => {
            let unit = required.device.quantity.unit();
            Need::yes(format!("the device has steps of {step:.3e} {unit}"))
        }
        None => Need::no("the device takes floats"),
    }
}

fn build(required: &Requirements, neutral: bool) -> Box<dyn Stage> {
    let step = required.device.step.filter(|step| !neutral && *step > 0.0);
    Box::new(Quantisation { step, limit: required.device.limit.unwrap_or(f64::INFINITY) })
}

struct Quantisation {
    step: Option<f64>,
    limit: f64,
}

impl Stage for Quantisation {
    fn render(&mut self, out: &mut [f32], source: &mut dyn FnMut(&mut [f32])) {
        source(out);
        let Some(step) = self.step else { return };
        // Rounded down, so that no step is above the limit.
        let most = (self.limit / step).floor();
        for sample in out {
            // Ties to even have no mean error.
            let steps = (f64::from(*sample) / step).round_ties_even();
            *sample = (steps.clamp(-most, most) * step) as f32;
        }
    }
}
