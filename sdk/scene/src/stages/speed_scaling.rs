//! Scaling of temporal frequencies with the scanning speed, f ∝ v, as on a fixed surface under a faster
//! finger, for assets with a single speed.

use htex_dsp::warp::Warp;
use htex_play::{Explored, Recorded};

use super::{Context, Entry, FOLLOWS, Need, Stage, StagePlace};
use crate::file::Effect;
use crate::played::PlayedSurface;
use crate::requirements::Requirements;

pub(crate) const ENTRY: Entry = Entry {
    effect: Effect::SpeedScaling,
    name: "speed_scaling",
    place: StagePlace::Surface {
        need,
        build: Some(build),
    },
};

fn need(_: &Requirements, played: &PlayedSurface) -> Need {
    let known = played.explored.speed;
    match known {
        _ if played.follows_motion => Need::no(FOLLOWS),
        Recorded::Unknown => Need::no("the asset does not state the speed of its recording"),
        Recorded::Several { .. } => {
            Need::no("the asset has several speeds, and is interpolated between them")
        }
        Recorded::One { .. } if played.speed_mm_s.changes(&known) => Need::yes(format!(
            "the asset has the speed {known} mm/s only, and the speed is {}",
            played.speed_mm_s.text("mm/s")
        )),
        Recorded::One { .. } if played.speed_mm_s.is_as(&known) => Need::no(format!(
            "the speed is always the recorded one, {known} mm/s"
        )),
        Recorded::One { .. } => Need::no(format!(
            "the speed never changes: the resampler reads {:.3} times as fast",
            played.fixed_ratio
        )),
    }
}

fn build(_: &Requirements, played: &PlayedSurface, neutral: bool) -> Box<dyn Stage> {
    let scales = played.explored.speed.is_one() && !neutral;
    Box::new(SpeedScaling {
        known: played.explored,
        warp: match scales {
            true => Warp::new(played.voice_top_hz / played.rate_hz),
            false => Warp::through(),
        },
        scales,
        ratio: 1.0,
        oversampling: played.oversampling,
    })
}

struct SpeedScaling {
    known: Explored,
    scales: bool,
    warp: Warp,
    ratio: f64,
    /// Output samples per source sample, so that higher frequencies of a faster finger stay below the Nyquist
    /// frequency.
    oversampling: f64,
}

impl Stage for SpeedScaling {
    fn follow(&mut self, context: &Context) {
        if self.scales && context.finger.slides() {
            self.ratio = self.known.speed_ratio(context.finger.speed_mm_s.abs());
        }
    }

    fn render(&mut self, out: &mut [f32], source: &mut dyn FnMut(&mut [f32])) {
        self.warp
            .process(self.ratio / self.oversampling, out, source);
    }
}
