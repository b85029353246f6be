//! Level in proportion to the normal force, as friction goes, where the asset knows only one force.

use htex_dsp::glide::Glide;

use super::{Entry, Need, Now, Place, Stage};
use crate::call::{Call, Part};
use crate::file::Effect;

/// Length of a change, seconds.
const RAMP_S: f64 = 0.010;
/// Largest gain: no finger presses harder, and a gain that is no number would be in every sample.
const MOST: f64 = 1e6;

pub(crate) const ENTRY: Entry = Entry {
    effect: Effect::ForceScaling,
    name: "force_scaling",
    place: Place::Surface {
        need,
        build: Some(build),
    },
};

fn need(_: &Call, part: &Part) -> Need {
    let Some(known) = part.one_force_n() else {
        return Need::no(match part.forces().is_point() {
            true => "the asset does not say at which force it was recorded",
            false => "the asset knows several forces, and is interpolated between them",
        });
    };
    if !part.force_n.is_point() {
        return Need::yes(format!(
            "the asset knows {known} N alone, and the force is {}",
            part.force_n.text("N")
        ));
    }
    Need::no(match part.force_n.is_at(known) {
        true => format!("the force is always the recorded one, {known} N"),
        false => format!(
            "the force never changes: the level is multiplied by {:.3}",
            part.fixed_force_gain
        ),
    })
}

fn build(_: &Call, part: &Part, neutral: bool) -> Box<dyn Stage> {
    let ramp = (RAMP_S * part.rate_hz).ceil() as u32;
    Box::new(ForceScaling {
        known_n: part.one_force_n().filter(|_| !neutral),
        gain: Glide::new(1.0, ramp),
    })
}

/// Gain at a force, where the asset knows one.
pub(crate) fn force_gain(force_n: f64, known_n: f64) -> f64 {
    (force_n / known_n).min(MOST)
}

struct ForceScaling {
    known_n: Option<f64>,
    gain: Glide,
}

impl Stage for ForceScaling {
    fn follow(&mut self, now: &Now) {
        if let Some(known) = self.known_n {
            self.gain.set(force_gain(now.finger.force_n, known) as f32);
        }
    }

    fn render(&mut self, out: &mut [f32], source: &mut dyn FnMut(&mut [f32])) {
        source(out);
        self.gain.apply(out);
    }
}
