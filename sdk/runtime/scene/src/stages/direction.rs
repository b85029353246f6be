//! The sign of the friction: friction opposes the motion, so its sign changes with the stroke.

use htex_device::Quantity;
use htex_dsp::glide::Glide;

use super::{Context, Entry, Need, Stage, StagePlace};
use crate::file::Effect;
use crate::requirements::Requirements;

/// Duration of a change of sign, seconds.
const RAMP_S: f64 = 0.010;

pub(crate) const ENTRY: Entry = Entry {
    effect: Effect::Direction,
    name: "direction",
    place: StagePlace::Device { need, build },
};

fn need(required: &Requirements) -> Need {
    match required.device.quantity {
        Quantity::DisplayVoltage => {
            Need::no("friction on an electrovibration display opposes the motion by itself")
        }
        Quantity::Sound => Need::no("the sign of a sound is inaudible"),
        Quantity::LateralForce if required.live => Need::yes("a live motion may reverse"),
        Quantity::LateralForce if required.turns_round => {
            Need::yes("the finger reverses its direction")
        }
        Quantity::LateralForce => Need::no("the finger never reverses its direction"),
        _ => Need::no("only a lateral force has a direction opposite to the stroke"),
    }
}

fn build(required: &Requirements, neutral: bool) -> Box<dyn Stage> {
    Box::new(Direction {
        neutral,
        sign: Glide::new(1.0, (RAMP_S * required.rate_hz).ceil() as u32),
    })
}

struct Direction {
    neutral: bool,
    sign: Glide,
}

impl Stage for Direction {
    fn follow(&mut self, context: &Context) {
        // A resting finger keeps the sign of its last stroke.
        if !self.neutral && context.finger.slides() {
            self.sign.set(if context.finger.speed_mm_s < 0.0 { -1.0 } else { 1.0 });
        }
    }

    fn render(&mut self, out: &mut [f32], source: &mut dyn FnMut(&mut [f32])) {
        source(out);
        self.sign.apply(out);
    }
}
