//! Checks whether a scene's motion stays within the speeds and forces at which its textures were
//! recorded.

use htex_base::finding::Findings;
use htex_play::{Conditions, Coverage, Effects, Motion, Texture};

use crate::file::{self, Effect, SceneFile, Surface, Switch};
use crate::motion::topmost;
use crate::rules as rule;
use crate::trace::Trace;

/// Fraction of the time on a surface during which the motion may be outside the recorded range
/// without a warning. It is above 0 because strokes slow down where they turn.
const MOST: f64 = 0.1;
/// Maximum number of trace rows that are checked, evenly spaced. Each row is compared with all
/// conditions, so checking more rows would be slow.
const MOST_ROWS: usize = 20_000;

/// Warns about surfaces whose motion lies outside the recorded range and is played as a different
/// motion.
pub(crate) fn check(
    scene: &SceneFile,
    assets: &[Texture],
    trace: Option<&Trace>,
    findings: &mut Findings,
) {
    let fingers = fingers(scene, trace);
    for (i, asset) in assets.iter().enumerate() {
        // An asset that cannot be used already has a finding.
        let Ok(conditions) = conditions(asset, &scene.surfaces[i]) else {
            continue;
        };
        let here = |finger: &&Motion| match trace {
            Some(_) => topmost(&scene.surfaces, finger) == Some(i),
            None => true,
        };
        let (share, farthest) = beyond(fingers.iter().filter(here), &conditions, effects(scene));
        if let (true, Some(farthest)) = (share > MOST, farthest) {
            let percent = 100.0 * share;
            let message =
                format!("surface {i}: {percent:.0} % of the motion on it, at most: {farthest}");
            findings.add(rule::MOTION_BEYOND_RECORDED, "/motion", message);
        }
    }
}

fn conditions(asset: &Texture, surface: &Surface) -> Result<Conditions, htex_play::Error> {
    let name = surface.representation.as_str();
    asset.representation((name != "auto").then_some(name))?.conditions()
}

fn effects(scene: &SceneFile) -> Effects {
    let is_on = |effect| scene.effects.get(&effect) != Some(&Switch::Off);
    Effects::default()
        .with_frequency_scaling(is_on(Effect::FrequencyScaling))
        .with_level_scaling(is_on(Effect::LevelScaling))
}

/// Returns the finger's motion at the rows of a trace, or the single constant motion. Empty if the
/// motion is live.
fn fingers(scene: &SceneFile, trace: Option<&Trace>) -> Vec<Motion> {
    match (&scene.motion, trace) {
        (file::Motion::Constant(constant), _) => {
            let motion = Motion::new(constant.speed_mm_s, constant.force_n);
            vec![motion.with_place_mm(constant.from_mm)]
        }
        (file::Motion::Trace(_), Some(trace)) => {
            // `step_by` panics at 0, which an empty trace would give.
            let every = trace.t_s.len().div_ceil(MOST_ROWS).max(1);
            let points = trace.t_s.iter().step_by(every).map(|t| trace.point_at(*t));
            let finger = |point: crate::trace::TracePoint| {
                let motion = Motion::new(point.speed_mm_s, point.force_n);
                motion.with_place_mm([point.x_mm, point.y_mm])
            };
            points.map(finger).collect()
        }
        _ => Vec::new(),
    }
}

/// Looks only at the motions at which the finger slides. Returns the fraction of them that is
/// played as a different motion, and the coverage of the motion farthest from the recorded range.
fn beyond<'a>(
    fingers: impl Iterator<Item = &'a Motion>,
    conditions: &Conditions,
    effects: Effects,
) -> (f64, Option<Coverage>) {
    let (mut all, mut beyond, mut farthest) = (0.0, 0.0, None::<Coverage>);
    for finger in fingers.filter(|finger| finger.slides()) {
        let coverage = conditions.coverage(finger.without_direction(), effects);
        all += 1.0;
        if coverage.excess() > 0.0 {
            beyond += 1.0;
            let least = farthest.map_or(0.0, |coverage| coverage.excess());
            farthest = Some(coverage).filter(|c| c.excess() > least).or(farthest);
        }
    }
    (if all > 0.0 { beyond / all } else { 0.0 }, farthest)
}
