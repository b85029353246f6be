//! Silences the output while the finger has no contact or does not slide. On a device that people
//! touch or hear, this stage also fades in at the start and fades out at the end of a scene.

use htex_device::Quantity;
use htex_dsp::glide::Glide;
use htex_play::exploration::CONTACT_RAMP_S;

use super::{Context, Entry, Need, Stage, StagePlace};
use crate::file::Effect;
use crate::requirements::Requirements;

pub(crate) const ENTRY: Entry =
    Entry { effect: Effect::Contact, name: "contact", place: StagePlace::Device { need, build } };

fn need(required: &Requirements) -> Need {
    if required.live {
        return Need::yes("a live finger may start and end contact");
    }
    if required.breaks_contact {
        return Need::yes("the finger rests or is lifted");
    }
    match required.device.quantity {
        Quantity::DisplayVoltage => Need::yes("a voltage starts at zero and ends at zero"),
        Quantity::Sound => Need::yes("a sound starts and ends without a click"),
        _ => Need::no("the finger slides all the time"),
    }
}

fn build(required: &Requirements, neutral: bool) -> Box<dyn Stage> {
    let ramp = (CONTACT_RAMP_S * required.rate_hz).ceil() as u32;
    // The gain starts at 0, so that a scene fades in.
    Box::new(Contact { neutral, ramp, gain: Glide::new(if neutral { 1.0 } else { 0.0 }, ramp) })
}

struct Contact {
    neutral: bool,
    ramp: u32,
    gain: Glide,
}

impl Stage for Contact {
    fn follow(&mut self, context: &Context) {
        if self.neutral {
            return;
        }
        match context.ends_in {
            Some(left) if left <= u64::from(self.ramp) => {
                // The last sample is zero, like the first sample of a scene.
                self.gain.set_within(0.0, (left as u32).saturating_sub(1));
            }
            _ => self.gain.set(if context.finger.slides() { 1.0 } else { 0.0 }),
        }
    }

    fn render(&mut self, out: &mut [f32], source: &mut dyn FnMut(&mut [f32])) {
        source(out);
        self.gain.apply(out);
    }
}
