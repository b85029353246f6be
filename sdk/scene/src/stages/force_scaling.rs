//! Scaling of the level with the normal force, as for friction, for assets with a single force.

use htex_dsp::glide::Glide;
use htex_play::{Explored, Recorded};

use super::{Entry, FOLLOWS, Need, Now, Place, Stage};
use crate::call::{Call, Part};
use crate::file::Effect;

/// Duration of a change, seconds.
const RAMP_S: f64 = 0.010;

pub(crate) const ENTRY: Entry = Entry {
    effect: Effect::ForceScaling,
    name: "force_scaling",
    place: Place::Surface {
        need,
        build: Some(build),
    },
};

fn need(_: &Call, part: &Part) -> Need {
    let known = part.explored.force;
    match known {
        _ if part.follows_motion => Need::no(FOLLOWS),
        Recorded::Unknown => Need::no("the asset does not state the force of its recording"),
        Recorded::Several { .. } => {
            Need::no("the asset has several forces, and is interpolated between them")
        }
        Recorded::One { .. } if part.force_n.changes(&known) => Need::yes(format!(
            "the asset has the force {known} N only, and the force is {}",
            part.force_n.text("N")
        )),
        Recorded::One { .. } if part.force_n.is_as(&known) => {
            Need::no(format!("the force is always the recorded one, {known} N"))
        }
        Recorded::One { .. } => Need::no(format!(
            "the force never changes: the level is multiplied by {:.3}",
            part.fixed_force_gain
        )),
    }
}

fn build(_: &Call, part: &Part, neutral: bool) -> Box<dyn Stage> {
    let ramp = (RAMP_S * part.rate_hz).ceil() as u32;
    Box::new(ForceScaling {
        known: Some(part.explored).filter(|_| !neutral),
        gain: Glide::new(1.0, ramp),
    })
}

struct ForceScaling {
    known: Option<Explored>,
    gain: Glide,
}

impl Stage for ForceScaling {
    fn follow(&mut self, now: &Now) {
        if let Some(known) = &self.known {
            self.gain.set(known.force_gain(now.finger.force_n) as f32);
        }
    }

    fn render(&mut self, out: &mut [f32], source: &mut dyn FnMut(&mut [f32])) {
        source(out);
        self.gain.apply(out);
    }
}
