//! Tests how budgets of time and error change which representation is chosen.

use crate::common;

use common::{constant, file, grid, nine, planned, scene, single, three_speeds};
use htex_format::ErrorMeasure;
use htex_play::Texture;
use htex_scene::file::Budget;
use htex_scene::{Costs, Plan, SceneError, plan};

/// Safety factor of a plan.
const RESERVE: f64 = 1.5;

/// Returns the error of each representation, and the time budget that a plan with only this
/// representation needs.
fn measured(measure: ErrorMeasure) -> Vec<(String, f64, f64)> {
    let manifest = single().manifest();
    let one = |r: &htex_format::Representation| {
        let mut scene = scene(single(), constant(80.0, 0.4), 1.0);
        scene.file.surfaces[0].representation = r.model.clone();
        let error_db = measure.error_in(r.at[0].quality.as_ref().unwrap()).unwrap();
        let ns = RESERVE * planned(&scene, &file()).ns_per_sample_total;
        (r.model.clone(), error_db, ns)
    };
    manifest.representations.iter().map(one).collect()
}

fn within(budget: Budget) -> Result<Plan, SceneError> {
    let mut scene = scene(single(), constant(80.0, 0.4), 1.0);
    scene.file.budget = budget;
    plan(&scene, &file(), &Costs::embedded())
}

fn error_of(all: &[(String, f64, f64)], plan: &Plan) -> f64 {
    let model = &plan.representation[0].model;
    all.iter().find(|(id, ..)| id == model).unwrap().1
}

#[test]
fn a_smaller_time_budget_never_reduces_the_error() {
    let all = measured(ErrorMeasure::NineBand);
    let cheapest = all.iter().map(|(.., ns)| *ns).fold(f64::INFINITY, f64::min);
    let (mut last_error, mut choices) = (0.0, std::collections::BTreeSet::new());
    // Slightly above and slightly below the time that each representation takes.
    let mut budgets: Vec<f64> =
        all.iter().flat_map(|(.., ns)| [1.0001 * ns, 0.9999 * ns]).collect();
    budgets.sort_by(|a, b| b.total_cmp(a));
    for ns in budgets {
        let budget = Budget { ns_per_sample: Some(ns), ..Budget::default() };
        match within(budget) {
            Ok(plan) => {
                assert!(RESERVE * plan.ns_per_sample_total <= ns);
                let error_db = error_of(&all, &plan);
                assert!(error_db >= last_error, "{ns} ns: {error_db} dB after {last_error} dB");
                // No representation with a smaller error meets the time budget.
                let nearer = all.iter().find(|(_, e, t)| *e < error_db && *t <= ns);
                assert!(nearer.is_none(), "{nearer:?}");
                last_error = error_db;
                choices.insert(plan.representation[0].model.clone());
            }
            Err(error) => {
                assert!(matches!(error, SceneError::TooSlow { .. }), "{error}");
                assert!(ns < cheapest, "{ns}");
            }
        }
    }
    assert!(choices.len() >= 2, "the front has more than one point: {choices:?}, {all:?}");
}

#[test]
fn a_larger_error_budget_never_takes_more_time() {
    for error in ErrorMeasure::ALL {
        let all = measured(error);
        let mut last_ns = f64::INFINITY;
        for step in 0..200 {
            let most_db = 0.1 * 1.05f64.powi(step);
            let budget = Budget { max_error_db: Some(most_db), error, ..Budget::default() };
            match within(budget) {
                Ok(plan) => {
                    assert!(error_of(&all, &plan) <= most_db);
                    assert!(plan.representation[0].why.contains(error.name()));
                    let ns = RESERVE * plan.ns_per_sample_total;
                    assert!(ns <= last_ns);
                    last_ns = ns;
                }
                Err(refused) => {
                    assert!(matches!(refused, SceneError::NotNearEnough { .. }), "{refused}");
                    assert!(all.iter().all(|(_, e, _)| *e > most_db));
                }
            }
        }
        let near = all.iter().filter(|(_, e, _)| *e <= 0.1 * 1.05f64.powi(199));
        let cheapest = near.map(|(.., ns)| *ns).fold(f64::INFINITY, f64::min);
        assert_eq!(last_ns, cheapest);
    }
}

/// Without a budget, a scene plays the same representation as a voice. This also holds if
/// conditions were computed, or if no condition was measured.
#[test]
fn a_scene_chooses_as_a_voice_does() {
    let computed = |asset: &Texture| {
        let all = asset.manifest().representations.iter();
        all.flat_map(|r| &r.at).any(|at| at.quality.is_none())
    };
    assert!(computed(three_speeds()));
    let mut unmeasured = three_speeds().data().clone();
    let all = unmeasured.manifest.representations.iter_mut();
    all.flat_map(|r| &mut r.at).for_each(|at| at.quality = None);
    let mut later = three_speeds().data().clone();
    for representation in &mut later.manifest.representations {
        representation.at[0].quality = None;
    }
    let (unmeasured, later) = (Texture::new(unmeasured), Texture::new(later));
    for asset in [single(), grid(), nine(), three_speeds(), &unmeasured, &later] {
        let chosen = planned(&scene(asset, constant(80.0, 0.4), 1.0), &file());
        let voice = asset.representation(None).unwrap().id();
        assert_eq!(chosen.representation[0].model, voice);
        assert!(!chosen.representation[0].why.contains("inf"));
    }
    // Bands has the smallest error for sandpaper. Comparing by infinity would choose the first in
    // the file.
    let first = &later.manifest().representations[0].model;
    assert_ne!(later.representation(None).unwrap().id(), first);
    assert_eq!(unmeasured.representation(None).unwrap().id(), first);
}

/// The budget limits the largest error over the measured conditions.
#[test]
fn computed_conditions_do_not_break_a_budget() {
    let with = |asset: &Texture, most_db: f64| {
        let mut scene = scene(asset, constant(80.0, 0.4), 1.0);
        scene.file.budget.max_error_db = Some(most_db);
        plan(&scene, &file(), &Costs::embedded())
    };
    let asset = three_speeds();
    let all = asset.manifest().representations.iter();
    let largest = all.map(|r| r.largest_error_db(ErrorMeasure::NineBand).unwrap());
    let least_db = largest.min_by(f64::total_cmp).unwrap();
    assert!(with(asset, least_db + 1e-9).is_ok());
    let refused = with(asset, least_db - 1e-9).unwrap_err().to_string();
    assert!(refused.contains(&format!("at {least_db:.2} dB")), "{refused}");
    let mut unmeasured = asset.data().clone();
    let all = unmeasured.manifest.representations.iter_mut();
    all.flat_map(|r| &mut r.at).for_each(|at| at.quality = None);
    let refused = with(&Texture::new(unmeasured), 100.0).unwrap_err().to_string();
    assert!(refused.contains("states no such error"), "{refused}");
}
