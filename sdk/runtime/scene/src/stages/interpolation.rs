//! Interpolation of parameters and level between recorded conditions as speed and force change.
//! This stage changes the parameters of the voice, so no samples pass through it.

use htex_play::Interval;

use super::{Entry, Need, StagePlace};
use crate::file::Effect;
use crate::played::PlayedSurface;
use crate::requirements::{Requirements, Span};

pub(crate) const ENTRY: Entry = Entry {
    effect: Effect::Interpolation,
    name: "interpolation",
    place: StagePlace::Surface { need, build: None },
};

fn need(_: &Requirements, played: &PlayedSurface) -> Need {
    let known = played.known;
    if known < 2 {
        return Need::no("the asset has one exploration condition");
    }
    let varies = |span: &Span, recorded: Interval| {
        !span.is_point() && recorded.is_known() && !recorded.is_one()
    };
    let range = played.conditions.range();
    if varies(&played.speed_mm_s, range.speed) || varies(&played.force_n, range.force) {
        return Need::yes(format!(
            "speed ({}) and force ({}) change between {known} conditions",
            played.speed_mm_s.text("mm/s"),
            played.force_n.text("N"),
        ));
    }
    Need::no("the motion does not change: parameters are interpolated once")
}
