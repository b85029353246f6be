//! Interpolation of parameters and level between exploration conditions as speed and force change. It retunes
//! the voice; no samples pass through this stage.

use htex_play::{Explored, Recorded};

use super::{Entry, Need, Place};
use crate::call::{Call, Part, Span};
use crate::file::Effect;

pub(crate) const ENTRY: Entry = Entry {
    effect: Effect::Interpolation,
    name: "interpolation",
    place: Place::Surface { need, build: None },
};

fn need(_: &Call, part: &Part) -> Need {
    let known = part.known;
    if known < 2 {
        return Need::no("the asset has one exploration condition");
    }
    let varies = |span: &Span, recorded: Recorded| {
        !span.is_point() && matches!(recorded, Recorded::Several { .. })
    };
    let Explored { speed, force } = part.explored;
    if varies(&part.speed_mm_s, speed) || varies(&part.force_n, force) {
        return Need::yes(format!(
            "speed ({}) and force ({}) change between {known} conditions",
            part.speed_mm_s.text("mm/s"),
            part.force_n.text("N"),
        ));
    }
    Need::no("the motion does not change: parameters are interpolated once")
}
