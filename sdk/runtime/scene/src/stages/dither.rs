//! Adds triangular dither of up to one step in either direction. The dither makes the rounding
//! error of integer files independent of the signal.

use htex_device::Quantity;
use rand_core::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::{Entry, Need, Stage, StagePlace};
use crate::file::Effect;
use crate::requirements::Requirements;

pub(crate) const ENTRY: Entry =
    Entry { effect: Effect::Dither, name: "dither", place: StagePlace::Device { need, build } };

fn need(required: &Requirements) -> Need {
    match (required.device.step, required.device.quantity) {
        (None, _) => Need::no("the device takes floats"),
        (Some(_), Quantity::DisplayVoltage) => {
            Need::no("the steps of a converter before an amplifier are imperceptible")
        }
        (Some(_), _) if required.device.paced => {
            Need::no("the device is not a file that may be processed further")
        }
        (Some(_), _) => {
            Need::yes("the samples are rounded to integers and may be processed further")
        }
    }
}

fn build(required: &Requirements, neutral: bool) -> Box<dyn Stage> {
    let step = required.device.step.filter(|_| !neutral).unwrap_or(0.0);
    let limit = required.device.limit.filter(|_| !neutral);
    Box::new(Dither {
        step: step as f32,
        limit: limit.map_or(f32::INFINITY, |limit| limit as f32),
        // The constant is `dither` in ASCII. Voices also use the scene's seed, and must not get the
        // same random numbers.
        random: Xoshiro256PlusPlus::seed_from_u64(required.seed ^ 0x6469_7468_6572),
    })
}

struct Dither {
    step: f32,
    limit: f32,
    random: Xoshiro256PlusPlus,
}

impl Stage for Dither {
    fn render(&mut self, out: &mut [f32], source: &mut dyn FnMut(&mut [f32])) {
        source(out);
        for sample in out {
            let bits = self.random.next_u64();
            // 24 bits fit a 32-bit float exactly, so the result never rounds up to 1.
            let uniform = |bits: u64| (bits & 0xff_ffff) as f32 / 16_777_216.0;
            let noise = uniform(bits) - uniform(bits >> 32);
            // The limiter comes before this stage, so the noise could exceed the limit again.
            *sample = (*sample + self.step * noise).clamp(-self.limit, self.limit);
        }
    }
}
