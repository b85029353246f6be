//! Scales the level by the asset's scaling law if the speed or the normal force is outside the
//! recorded range.

use std::sync::Arc;

use htex_dsp::glide::Glide;
use htex_play::Conditions;
use htex_play::exploration::CEILING;

use super::{Context, Entry, FOLLOWS, Need, Stage, StagePlace};
use crate::file::Effect;
use crate::played::PlayedSurface;
use crate::requirements::Requirements;

/// Duration of a change, seconds.
const RAMP_S: f64 = 0.010;

pub(crate) const ENTRY: Entry = Entry {
    effect: Effect::LevelScaling,
    name: "level_scaling",
    place: StagePlace::Surface { need, build: Some(build) },
};

fn need(_: &Requirements, played: &PlayedSurface) -> Need {
    let range = played.conditions.range();
    let known = format!("{} mm/s and {} N", range.speed, range.force);
    match played.level {
        _ if played.follows_motion => Need::no(FOLLOWS),
        _ if !(range.speed.is_known() || range.force.is_known()) => {
            Need::no("the asset does not state the motion of its recording")
        }
        _ if !range.moves_level() => {
            Need::no("the level of the texture does not change with the motion (its law)")
        }
        span if !span.is_point() => Need::yes(format!(
            "recorded are {known}; the speed is {}, and the force {}",
            played.speed_mm_s.text("mm/s"),
            played.force_n.text("N")
        )),
        span if span.is_one() => Need::no(format!("the motion is always a recorded one, {known}")),
        _ => Need::no(format!(
            "the motion never changes: the level is multiplied by {:.3}",
            played.fixed_gain
        )),
    }
}

fn build(_: &Requirements, played: &PlayedSurface, neutral: bool) -> Box<dyn Stage> {
    let ramp = (RAMP_S * played.rate_hz).ceil() as u32;
    Box::new(LevelScaling {
        conditions: Some(Arc::clone(&played.conditions)).filter(|_| !neutral),
        gain: Glide::new(1.0, ramp),
    })
}

struct LevelScaling {
    conditions: Option<Arc<Conditions>>,
    gain: Glide,
}

impl Stage for LevelScaling {
    fn follow(&mut self, context: &Context) {
        let Some(conditions) = self.conditions.as_ref().filter(|_| context.finger.slides()) else {
            return;
        };
        let scaling = conditions.scaling(context.finger.without_direction(), CEILING);
        self.gain.set(scaling.level as f32);
    }

    fn render(&mut self, out: &mut [f32], source: &mut dyn FnMut(&mut [f32])) {
        source(out);
        self.gain.apply(out);
    }
}
