//! Temporal frequency in proportion to the scanning speed, f ∝ v: what a fixed surface does to a finger
//! that moves faster, where the asset knows only one speed.

use htex_dsp::warp::Warp;

use super::{Entry, Need, Now, Place, Stage};
use crate::call::{Call, MAX_RATIO, MIN_RATIO, Part};
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
    let Some(known) = part.one_speed_mm_s() else {
        return Need::no(match part.speeds().is_point() {
            true => "the asset does not say at which speed it was recorded",
            false => "the asset knows several speeds, and is interpolated between them",
        });
    };
    if !part.speed_mm_s.is_point() {
        return Need::yes(format!(
            "the asset knows {known} mm/s alone, and the speed is {}",
            part.speed_mm_s.text("mm/s")
        ));
    }
    Need::no(match part.speed_mm_s.is_at(known) {
        true => format!("the speed is always the recorded one, {known} mm/s"),
        false => format!(
            "the speed never changes: the resampler reads {:.3} times as fast",
            part.fixed_ratio
        ),
    })
}

fn build(_: &Call, part: &Part, neutral: bool) -> Box<dyn Stage> {
    let known = part.one_speed_mm_s().filter(|_| !neutral);
    Box::new(SpeedScaling {
        known_mm_s: known,
        warp: if known.is_some() {
            Warp::new()
        } else {
            Warp::through()
        },
        ratio: 1.0,
        oversampling: part.oversampling,
    })
}

struct SpeedScaling {
    known_mm_s: Option<f64>,
    warp: Warp,
    ratio: f64,
    /// Samples given for each one of the source, so that a faster finger fits below half the rate.
    oversampling: f64,
}

impl Stage for SpeedScaling {
    fn follow(&mut self, now: &Now) {
        if let (Some(known), true) = (self.known_mm_s, now.finger.slides()) {
            let ratio = now.finger.speed_mm_s.abs() / known;
            self.ratio = ratio.clamp(MIN_RATIO, MAX_RATIO);
        }
    }

    fn render(&mut self, out: &mut [f32], source: &mut dyn FnMut(&mut [f32])) {
        self.warp
            .process(self.ratio / self.oversampling, out, source);
    }
}
