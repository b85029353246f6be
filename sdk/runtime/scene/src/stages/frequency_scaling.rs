//! Scales frequencies by the asset's scaling law if the scanning speed is outside the recorded
//! range.

use std::sync::Arc;

use htex_dsp::warp::Warp;
use htex_play::Conditions;
use htex_play::exploration::CEILING;

use super::{Context, Entry, FOLLOWS, Need, Stage, StagePlace};
use crate::file::Effect;
use crate::played::PlayedSurface;
use crate::requirements::Requirements;

pub(crate) const ENTRY: Entry = Entry {
    effect: Effect::FrequencyScaling,
    name: "frequency_scaling",
    place: StagePlace::Surface { need, build: Some(build) },
};

fn need(_: &Requirements, played: &PlayedSurface) -> Need {
    let range = played.conditions.range();
    let (known, law) = (range.speed, range.law.frequency_speed);
    match played.frequency {
        _ if played.follows_motion => Need::no(FOLLOWS),
        _ if !known.is_known() => Need::no("the asset does not state the speed of its recording"),
        _ if !range.moves_frequencies() => Need::no(format!(
            "frequencies of the texture do not change with the speed (its law, {})",
            law.source.name()
        )),
        span if !span.is_point() => Need::yes(format!(
            "the recorded speed is {known} mm/s, and the speed is {}",
            played.speed_mm_s.text("mm/s")
        )),
        span if span.is_one() => {
            Need::no(format!("the speed is always a recorded one, {known} mm/s"))
        }
        _ => Need::no(format!(
            "the speed never changes: the resampler reads {:.3} times as fast",
            played.fixed_ratio
        )),
    }
}

fn build(_: &Requirements, played: &PlayedSurface, neutral: bool) -> Box<dyn Stage> {
    let scales = played.conditions.range().moves_frequencies() && !neutral;
    Box::new(FrequencyScaling {
        conditions: Arc::clone(&played.conditions),
        warp: if scales {
            Warp::new(played.voice_top_hz / played.rate_hz)
        } else {
            Warp::through()
        },
        scales,
        ratio: 1.0,
        oversampling: played.oversampling,
    })
}

struct FrequencyScaling {
    conditions: Arc<Conditions>,
    scales: bool,
    warp: Warp,
    ratio: f64,
    /// Output samples per source sample. With a faster finger, frequencies rise; oversampling keeps
    /// them below the Nyquist frequency.
    oversampling: f64,
}

impl Stage for FrequencyScaling {
    fn follow(&mut self, context: &Context) {
        // A resting finger has no speed that could set the ratio, so the last ratio stays.
        if self.scales && context.finger.slides() {
            self.ratio =
                self.conditions.scaling(context.finger.without_direction(), CEILING).frequency;
        }
    }

    fn render(&mut self, out: &mut [f32], source: &mut dyn FnMut(&mut [f32])) {
        self.warp.process(self.ratio / self.oversampling, out, source);
    }
}
