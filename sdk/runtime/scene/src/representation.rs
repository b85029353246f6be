//! Chooses the representation of each surface.

use std::cmp::Ordering;

use crate::SceneError;
use crate::file::Budget;
use crate::load::Scene;
use crate::played::PlayedSurface;
use crate::requirements::Requirements;

/// Safety factor for the measured times of the stages in a plan. In blocks of 64 samples, the
/// fastest chain takes 1.3 times as long as its stages together (the example `chains`). The rest is
/// calls between stages and the measurement of the peak.
const RESERVE: f64 = 1.5;

/// A representation and the reason for its choice.
#[derive(Debug, Clone)]
pub(crate) struct Choice {
    pub(crate) played: PlayedSurface,
    pub(crate) why: String,
}

/// Computes the time that a choice of representations takes, nanoseconds per sample. Fails if they
/// cannot be planned.
type Cost<'a> = &'a dyn Fn(&[PlayedSurface]) -> Result<f64, SceneError>;

/// The candidate representations of a surface. Without a budget, the first one is chosen.
#[derive(Clone)]
struct Candidates {
    surface: usize,
    options: Vec<PlayedSurface>,
    /// Whether the scene names the model.
    named: bool,
}

/// Chooses a representation for each surface that the finger touches.
pub(crate) fn choose(
    scene: &Scene,
    required: &Requirements,
    cost: Cost<'_>,
) -> Result<Vec<Choice>, SceneError> {
    let touched = (0..scene.assets.len()).filter(|&i| required.touches[i].share > 0.0);
    let all: Vec<Candidates> =
        touched.map(|surface| candidates(scene, required, surface)).collect::<Result<_, _>>()?;
    let budget = scene.file.budget;
    let options = within(&all, &budget, cost)?;
    let why = |(played, from): (PlayedSurface, &Candidates)| Choice {
        why: reason(&played, from, &budget),
        played,
    };
    Ok(options.into_iter().zip(&all).map(why).collect())
}

/// Returns the reference level for levels that are not normalised, in the assets' unit. If the
/// scene does not set the reference level, it is the level of the strongest representation of all
/// touched surfaces. It does not depend on which representations play.
pub(crate) fn reference_rms(scene: &Scene, required: &Requirements) -> f64 {
    if let Some(given_n) = scene.file.device.reference_rms {
        return given_n;
    }
    let mut strongest_rms = 0.0f64;
    for surface in (0..scene.assets.len()).filter(|&i| required.touches[i].share > 0.0) {
        let asset = &scene.assets[surface];
        for r in &asset.manifest().representations {
            // Representations without an available model do not count.
            if let Ok(played) = PlayedSurface::new(scene, required, surface, &r.model) {
                strongest_rms = strongest_rms.max(played.level_rms);
            }
        }
    }
    strongest_rms
}

fn candidates(
    scene: &Scene,
    required: &Requirements,
    surface: usize,
) -> Result<Candidates, SceneError> {
    let (asset, wanted) = (&scene.assets[surface], &scene.file.surfaces[surface].representation);
    let all = &asset.manifest().representations;
    if wanted != "auto" {
        let named = asset.representation(&wanted[..]);
        let id = named.map_err(SceneError::for_surface(surface, scene))?.id();
        return Ok(Candidates {
            surface,
            options: vec![PlayedSurface::new(scene, required, surface, id)?],
            named: true,
        });
    }
    // All programs choose in this order.
    let ranked = asset.ranked(scene.file.budget.error).into_iter();
    let options = ranked
        .filter(|representation| representation.is_runnable())
        .map(|representation| PlayedSurface::new(scene, required, surface, representation.id()))
        .collect::<Result<Vec<_>, _>>()?;
    if options.is_empty() {
        let there: Vec<&str> = all.iter().map(|r| &r.model[..]).collect();
        return Err(SceneError::NoModel { surface, there: there.join(", ") });
    }
    Ok(Candidates { surface, options, named: false })
}

/// Chooses one representation per surface within the budget.
fn within(
    all: &[Candidates],
    budget: &Budget,
    cost: Cost<'_>,
) -> Result<Vec<PlayedSurface>, SceneError> {
    let limited = |c: &Candidates| match budget.max_error_db {
        None => Ok(c.clone()),
        Some(most_db) => c.within(most_db),
    };
    let near = all.iter().map(limited).collect::<Result<Vec<_>, _>>()?;
    match (budget.max_error_db, budget.ns_per_sample) {
        (None, None) => Ok(near.iter().map(|c| c.options[0].clone()).collect()),
        (Some(_), None) => quickest(&near, None, cost),
        (error_db, Some(ns)) => nearest_within(&near, error_db, ns, cost),
    }
}

impl Candidates {
    /// Keeps only the representations whose largest error is within the limit.
    fn within(&self, wanted_db: f64) -> Result<Self, SceneError> {
        let is_within =
            |p: &&PlayedSurface| p.largest_error_db.is_some_and(|error_db| error_db <= wanted_db);
        let options: Vec<PlayedSurface> = self.options.iter().filter(is_within).cloned().collect();
        if !options.is_empty() {
            return Ok(Self { options, ..*self });
        }
        let measured =
            self.options.iter().filter_map(|p| Some((p.model.clone(), p.largest_error_db?)));
        Err(SceneError::NotNearEnough {
            surface: self.surface,
            wanted_db,
            nearest: measured.min_by(|a, b| a.1.total_cmp(&b.1)),
        })
    }
}

/// Finds the smallest error bound for which the fastest choice of representations meets the time
/// limit, and returns the representations for this bound.
fn nearest_within(
    all: &[Candidates],
    error_db: Option<f64>,
    wanted_ns: f64,
    cost: Cost<'_>,
) -> Result<Vec<PlayedSurface>, SceneError> {
    let errors = all.iter().flat_map(|c| &c.options).map(|p| p.error_db);
    let mut bounds: Vec<Option<f64>> = errors.collect();
    bounds.sort_by(|a, b| by_error(*a, *b));
    // Below this bound, at least one surface has no representation.
    let unnamed = all.iter().filter(|c| !c.named);
    let least =
        unnamed.map(|c| c.options[0].error_db).max_by(|a, b| by_error(*a, *b)).unwrap_or(Some(0.0));
    let mut quickest_ns: Option<f64> = None;
    for bound in bounds.into_iter().filter(|bound| by_error(*bound, least).is_ge()) {
        let options = quickest(all, bound, cost)?;
        let takes_ns = RESERVE * cost(&options)?;
        if takes_ns <= wanted_ns {
            return Ok(options);
        }
        quickest_ns = Some(quickest_ns.map_or(takes_ns, |least_ns| least_ns.min(takes_ns)));
    }
    // If no surface is touched, there are no bounds and nothing to choose.
    let Some(quickest_ns) = quickest_ns else {
        return Ok(Vec::new());
    };
    Err(match error_db {
        None => SceneError::TooSlow { wanted_ns, quickest_ns },
        Some(wanted_db) => SceneError::Budgets { wanted_db, wanted_ns, quickest_ns },
    })
}

/// Returns the fastest representation of each surface among those with an error of at most `bound`.
/// A `bound` of `None` accepts any error.
///
/// # Errors
/// Returns an error if none of a surface's representations can be planned.
fn quickest(
    all: &[Candidates],
    bound: Option<f64>,
    cost: Cost<'_>,
) -> Result<Vec<PlayedSurface>, SceneError> {
    let one = |c: &Candidates| {
        let is_near = |p: &&PlayedSurface| c.named || by_error(p.error_db, bound).is_le();
        let mut best: Option<(f64, &PlayedSurface)> = None;
        let mut refused = None;
        for played in c.options.iter().filter(is_near) {
            match cost(std::slice::from_ref(played)) {
                Ok(ns) if best.is_none_or(|(least_ns, _)| ns < least_ns) => {
                    best = Some((ns, played));
                }
                Ok(_) => {}
                Err(error) => refused = refused.or(Some(error)),
            }
        }
        match (best, refused) {
            (Some((_, played)), _) => Ok(played.clone()),
            (None, Some(error)) => Err(error),
            (None, None) => Ok(c.options[0].clone()),
        }
    };
    all.iter().map(one).collect()
}

/// Orders errors. An error that was not measured comes last.
fn by_error(a: Option<f64>, b: Option<f64>) -> Ordering {
    let order = |error_db: Option<f64>| (error_db.is_none(), error_db.unwrap_or_default());
    let (a, b) = (order(a), order(b));
    a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
}

fn reason(played: &PlayedSurface, from: &Candidates, budget: &Budget) -> String {
    let error = match (played.error_db, played.largest_error_db) {
        (Some(error_db), Some(largest_db)) if largest_db > error_db => {
            format!("{} {error_db:.2} dB, at most {largest_db:.2} dB", budget.error)
        }
        (Some(error_db), _) => format!("{} {error_db:.2} dB", budget.error),
        (None, _) => format!("{} not measured", budget.error),
    };
    let of = from.options.len();
    match (from.named, budget.max_error_db, budget.ns_per_sample) {
        (true, _, _) => format!("named by the scene; {error}"),
        (_, None, None) => format!("the smallest error of {of}: {error}"),
        (_, Some(most), None) => format!("the fastest of {of} within {most} dB: {error}"),
        (_, _, Some(ns)) => format!("the smallest error of {of} within {ns} ns a sample: {error}"),
    }
}
