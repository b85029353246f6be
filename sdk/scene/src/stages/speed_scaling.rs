//! Scaling of temporal frequencies with the scanning speed, f ∝ v, as on a fixed surface under a faster
//! finger, for assets with a single speed.

use htex_dsp::warp::Warp;
use htex_play::{Explored, Recorded};

use super::{Entry, FOLLOWS, Need, Now, Place, Stage};
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
        _ if part.follows_motion => Need::no(FOLLOWS),
        Recorded::Unknown => Need::no("the asset does not state the speed of its recording"),
        Recorded::Several { .. } => {
            Need::no("the asset has several speeds, and is interpolated between them")
        }
        Recorded::One { .. } if part.speed_mm_s.changes(&known) => Need::yes(format!(
            "the asset has the speed {known} mm/s only, and the speed is {}",
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
    /// Output samples per source sample, so that higher frequencies of a faster finger stay below the Nyquist
    /// frequency.
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
