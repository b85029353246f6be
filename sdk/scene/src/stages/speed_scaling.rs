//! Temporal frequency in proportion to the scanning speed, f ∝ v: what a fixed surface does to a finger
//! that moves faster, where the asset knows only one speed.

use htex_dsp::warp::Warp;
use htex_play::{Explored, Recorded};

use super::{Entry, Need, Now, Place, Stage};
use crate::call::{Call, Part};
use crate::file::Effect;

pub(crate) const ENTRY: Entry = Entry {
    effect: Effect::SpeedScaling,
    name: "speed_scaling",
    place: Place::Surface {
        need,
        build: Some(build),
    },
};

fn need(_: &Call, part: &Part) -> Need {
    let known = part.explored.speed;
    match known {
        Recorded::Unknown => Need::no("the asset does not say at which speed it was recorded"),
        Recorded::Several { .. } => {
            Need::no("the asset knows several speeds, and is interpolated between them")
        }
        Recorded::One { .. } if part.speed_mm_s.changes(&known) => Need::yes(format!(
            "the asset knows {known} mm/s alone, and the speed is {}",
            part.speed_mm_s.text("mm/s")
        )),
        Recorded::One { .. } if part.speed_mm_s.is_as(&known) => Need::no(format!(
            "the speed is always the recorded one, {known} mm/s"
        )),
        Recorded::One { .. } => Need::no(format!(
            "the speed never changes: the resampler reads {:.3} times as fast",
            part.fixed_ratio
        )),
    }
}

fn build(_: &Call, part: &Part, neutral: bool) -> Box<dyn Stage> {
    let scales = part.explored.speed.is_one() && !neutral;
    Box::new(SpeedScaling {
        known: part.explored,
        warp: match scales {
            true => Warp::new(part.voice_top_hz / part.rate_hz),
            false => Warp::through(),
        },
        scales,
        ratio: 1.0,
        oversampling: part.oversampling,
    })
}

struct SpeedScaling {
    known: Explored,
    scales: bool,
    warp: Warp,
    ratio: f64,
    /// Samples given for each one of the source, so that a faster finger fits below half the rate.
    oversampling: f64,
}

impl Stage for SpeedScaling {
    fn follow(&mut self, now: &Now) {
        if self.scales && now.finger.slides() {
            self.ratio = self.known.speed_ratio(now.finger.speed_mm_s.abs());
        }
    }

    fn render(&mut self, out: &mut [f32], source: &mut dyn FnMut(&mut [f32])) {
        self.warp
            .process(self.ratio / self.oversampling, out, source);
    }
}
