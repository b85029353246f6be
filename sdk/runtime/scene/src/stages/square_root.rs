//! Shifts the samples and takes their square root. The friction that an electrovibration display
//! adds is proportional to the square of its voltage, so for the samples y the voltage is V = V_g
//! sqrt(y + |min y|) cos(2 pi f_c t). (The paper, under "Electrovibration rendering", prints min|y|
//! instead, which allows negative radicands.)
//!
//! The minimum of a stream is not known in advance. Therefore, the stage uses [`HEADROOM`] times
//! the RMS of the scene's loudest surface in place of |min y|. Radicands that are still negative
//! are set to zero and counted.
//!
//! This shift does not follow the actual minimum of the stream, because the finger would feel
//! changes of the shift.

use htex_device::Quantity;

use super::{Drive, Entry, HEADROOM, Need, Stage, StagePlace, Statistics};
use crate::file::Effect;
use crate::requirements::Requirements;

pub(crate) const ENTRY: Entry = Entry {
    effect: Effect::SquareRoot,
    name: "square_root",
    place: StagePlace::Device { need, build },
};

fn need(required: &Requirements) -> Need {
    match required.device.quantity {
        Quantity::DisplayVoltage => Need::yes(format!(
            "friction is proportional to the square of the voltage; the shift is {HEADROOM} times the RMS"
        )),
        _ => Need::no("the device is not an electrovibration display"),
    }
}

fn build(required: &Requirements, neutral: bool) -> Box<dyn Stage> {
    if neutral {
        Box::new(PassThrough)
    } else {
        Box::new(SquareRoot { shift: Drive::new(required).shift as f32, held: 0 })
    }
}

/// A stage that passes samples unchanged.
struct PassThrough;

impl Stage for PassThrough {
    fn render(&mut self, out: &mut [f32], source: &mut dyn FnMut(&mut [f32])) {
        source(out);
    }
}

struct SquareRoot {
    shift: f32,
    held: u64,
}

impl Stage for SquareRoot {
    fn render(&mut self, out: &mut [f32], source: &mut dyn FnMut(&mut [f32])) {
        source(out);
        let mut held = 0;
        for sample in out {
            let radicand = *sample + self.shift;
            held += u64::from(radicand < 0.0);
            // `max` also turns NaN into 0.
            *sample = radicand.max(0.0).sqrt();
        }
        self.held += held;
    }

    fn count(&self, statistics: &mut Statistics) {
        statistics.rooted += self.held;
    }
}
