//! Parameters and level between exploration conditions, as speed and force change. The voice is
//! retuned; no samples pass through this stage.

use super::{Entry, Need, Place};
use crate::call::{Call, Part};
use crate::file::Effect;

pub(crate) const ENTRY: Entry = Entry {
    effect: Effect::Interpolation,
    name: "interpolation",
    place: Place::Surface { need, build: None },
};

fn need(_: &Call, part: &Part) -> Need {
    let known = part.conditions.len();
    if known < 2 {
        return Need::no("the asset knows one exploration condition");
    }
    let speeds = part.speeds();
    let forces = part.forces();
    let varies =
        |span: &crate::call::Span, known: &crate::call::Span| !span.is_point() && !known.is_point();
    if varies(&part.speed_mm_s, &speeds) || varies(&part.force_n, &forces) {
        return Need::yes(format!(
            "speed ({}) and force ({}) change between {known} known conditions",
            part.speed_mm_s.text("mm/s"),
            part.force_n.text("N"),
        ));
    }
    Need::no("the motion does not change: the parameters at it are mixed once")
}
