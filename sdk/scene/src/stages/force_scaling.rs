//! Scaling of the level with the normal force, as for friction, for assets with a single force.

use htex_dsp::glide::Glide;
use htex_play::{Explored, Recorded};

use super::{Context, Entry, FOLLOWS, Need, Stage, StagePlace};
use crate::file::Effect;
use crate::played::PlayedSurface;
use crate::requirements::Requirements;

/// Duration of a change, seconds.
const RAMP_S: f64 = 0.010;

pub(crate) const ENTRY: Entry = Entry {
    effect: Effect::ForceScaling,
    name: "force_scaling",
    place: StagePlace::Surface {
        need,
        build: Some(build),
    },
};

fn need(_: &Requirements, played: &PlayedSurface) -> Need {
    let known = played.explored.force;
    match known {
        _ if played.follows_motion => Need::no(FOLLOWS),
        Recorded::Unknown => Need::no("the asset does not state the force of its recording"),
        Recorded::Several { .. } => {
            Need::no("the asset has several forces, and is interpolated between them")
        }
        Recorded::One { .. } if played.force_n.changes(&known) => Need::yes(format!(
            "the asset has the force {known} N only, and the force is {}",
            played.force_n.text("N")
        )),
        Recorded::One { .. } if played.force_n.is_as(&known) => {
            Need::no(format!("the force is always the recorded one, {known} N"))
        }
        Recorded::One { .. } => Need::no(format!(
            "the force never changes: the level is multiplied by {:.3}",
            played.fixed_force_gain
        )),
    }
}

fn build(_: &Requirements, played: &PlayedSurface, neutral: bool) -> Box<dyn Stage> {
    let ramp = (RAMP_S * played.rate_hz).ceil() as u32;
    Box::new(ForceScaling {
        known: Some(played.explored).filter(|_| !neutral),
        gain: Glide::new(1.0, ramp),
    })
}

struct ForceScaling {
    known: Option<Explored>,
    gain: Glide,
}

impl Stage for ForceScaling {
    fn follow(&mut self, context: &Context) {
        if let Some(known) = &self.known {
            self.gain
                .set(known.force_gain(context.finger.force_n) as f32);
        }
    }

    fn render(&mut self, out: &mut [f32], source: &mut dyn FnMut(&mut [f32])) {
        source(out);
        self.gain.apply(out);
    }
}
