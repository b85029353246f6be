//! Choice of the representation of each surface.

use crate::SceneError;
use crate::error::OfSurface;
use crate::file::Budget;
use crate::load::LoadedScene;
use crate::played::PlayedSurface;
use crate::requirements::Requirements;

/// Safety factor of a plan over the measured times of its stages. The fastest chain takes 1.3 times their sum
/// in blocks of 64 (the example `chains`), because of the calls between stages and the peak measurement.
const RESERVE: f64 = 1.5;

/// A representation and the reason for its choice.
#[derive(Debug, Clone)]
pub(crate) struct Choice {
    pub(crate) played: PlayedSurface,
    pub(crate) why: String,
}

/// The candidate representations of a surface.
struct Candidates {
    surface: usize,
    options: Vec<PlayedSurface>,
    /// Whether the scene names the model.
    named: bool,
}

/// Chooses a representation for each surface that is touched. `cost` gives the time of a set of representations,
/// nanoseconds per sample.
pub(crate) fn choose(
    scene: &LoadedScene,
    required: &Requirements,
    cost: &dyn Fn(&[PlayedSurface]) -> f64,
) -> Result<Vec<Choice>, SceneError> {
    let touched = (0..scene.assets.len()).filter(|&i| required.touches[i].share > 0.0);
    let all: Vec<Candidates> = touched
        .map(|surface| candidates(scene, required, surface))
        .collect::<Result<_, _>>()?;
    let budget = scene.scene.budget;
    let options = within(&all, &budget, cost)?;
    let why = |(played, from): (PlayedSurface, &Candidates)| Choice {
        why: reason(&played, from, &budget),
        played,
    };
    Ok(options.into_iter().zip(&all).map(why).collect())
}

/// Reference level if levels are not normalised, in the assets' unit: the scene's, else that of the strongest
/// representation of the surfaces that are touched, whichever plays them.
pub(crate) fn reference_rms(scene: &LoadedScene, required: &Requirements) -> f64 {
    if let Some(given_n) = scene.scene.device.reference_rms {
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
    scene: &LoadedScene,
    required: &Requirements,
    surface: usize,
) -> Result<Candidates, SceneError> {
    let (asset, wanted) = (
        &scene.assets[surface],
        &scene.scene.surfaces[surface].representation,
    );
    let models = asset
        .manifest()
        .representations
        .iter()
        .map(|r| &r.model[..]);
    if wanted != "auto" {
        let id = asset
            .representation_id(Some(wanted))
            .of_surface(surface, scene)?;
        return Ok(Candidates {
            surface,
            options: vec![PlayedSurface::new(scene, required, surface, id)?],
            named: true,
        });
    }
    let known = models.clone().filter(|id| asset.knows_model(id));
    let mut options = known
        .map(|id| PlayedSurface::new(scene, required, surface, id))
        .collect::<Result<Vec<_>, _>>()?;
    if options.is_empty() {
        return Err(SceneError::NoModel {
            surface,
            there: models.collect::<Vec<_>>().join(", "),
        });
    }
    options.sort_by(|a, b| a.error_db.total_cmp(&b.error_db));
    Ok(Candidates {
        surface,
        options,
        named: false,
    })
}

/// Chooses one representation per surface within the budget.
fn within(
    all: &[Candidates],
    budget: &Budget,
    cost: &dyn Fn(&[PlayedSurface]) -> f64,
) -> Result<Vec<PlayedSurface>, SceneError> {
    if let Some(error_db) = budget.max_error_db {
        check_error(all, error_db)?;
    }
    match (budget.max_error_db, budget.ns_per_sample) {
        (None, None) => Ok(all.iter().map(|c| c.options[0].clone()).collect()),
        (Some(error_db), None) => Ok(quickest(all, error_db, cost)),
        (error_db, Some(ns)) => nearest_within(all, error_db, ns, cost),
    }
}

/// Parts with the smallest error bound for which the fastest choice is within the time limit.
fn nearest_within(
    all: &[Candidates],
    error_db: Option<f64>,
    ns: f64,
    cost: &dyn Fn(&[PlayedSurface]) -> f64,
) -> Result<Vec<PlayedSurface>, SceneError> {
    let mut bounds: Vec<f64> = all
        .iter()
        .flat_map(|c| c.options.iter().map(|p| p.error_db))
        .filter(|bound| error_db.is_none_or(|most| *bound <= most))
        .collect();
    bounds.sort_by(f64::total_cmp);
    // Below this bound, some surface has no representation.
    let least = all.iter().filter(|c| !c.named);
    let least = least.map(|c| c.options[0].error_db).fold(0.0, f64::max);
    let mut quickest_ns = f64::INFINITY;
    for bound in bounds.into_iter().filter(|bound| *bound >= least) {
        let options = quickest(all, bound, cost);
        let takes = RESERVE * cost(&options);
        if takes <= ns {
            return Ok(options);
        }
        quickest_ns = quickest_ns.min(takes);
    }
    if all.is_empty() {
        return Ok(Vec::new());
    }
    Err(match error_db {
        None => SceneError::TooSlow {
            wanted_ns: ns,
            quickest_ns,
        },
        Some(wanted_db) => SceneError::Budgets {
            wanted_db,
            wanted_ns: ns,
            quickest_ns,
        },
    })
}

/// The fastest representation of each surface with an error of at most `error_db`.
fn quickest(
    all: &[Candidates],
    error_db: f64,
    cost: &dyn Fn(&[PlayedSurface]) -> f64,
) -> Vec<PlayedSurface> {
    let one = |c: &Candidates| {
        let near = c
            .options
            .iter()
            .filter(|p| c.named || p.error_db <= error_db);
        let alone = |played: &&PlayedSurface| cost(std::slice::from_ref(*played));
        let best = near.min_by(|a, b| alone(a).total_cmp(&alone(b)));
        best.unwrap_or(&c.options[0]).clone()
    };
    all.iter().map(one).collect()
}

fn check_error(all: &[Candidates], wanted_db: f64) -> Result<(), SceneError> {
    let far = |c: &&Candidates| c.options[0].error_db > wanted_db;
    match all.iter().find(far) {
        None => Ok(()),
        Some(c) => Err(SceneError::NotNearEnough {
            surface: c.surface,
            wanted_db,
            model: c.options[0].model.clone(),
            nearest_db: c.options[0].error_db,
        }),
    }
}

fn reason(played: &PlayedSurface, from: &Candidates, budget: &Budget) -> String {
    let error = format!("{} {:.2} dB", budget.error, played.error_db);
    let of = from.options.len();
    match (from.named, budget.max_error_db, budget.ns_per_sample) {
        (true, _, _) => format!("named by the scene; {error}"),
        (_, None, None) => format!("the smallest error of {of}: {error}"),
        (_, Some(most), None) => format!("the fastest of {of} within {most} dB: {error}"),
        (_, _, Some(ns)) => format!("the smallest error of {of} within {ns} ns a sample: {error}"),
    }
}
