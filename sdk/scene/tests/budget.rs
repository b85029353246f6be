//! Budgets move the choice of representation along the asset's measured front.
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

mod common;

use common::{constant, file, planned, scene, single};
use htex_format::ErrorMeasure;
use htex_scene::file::Budget;
use htex_scene::{Costs, Plan, SceneError, plan};

/// Safety factor of a plan.
const RESERVE: f64 = 1.5;

/// Error of each representation, and the time budget needed by the plan with it alone.
fn measured(measure: ErrorMeasure) -> Vec<(String, f64, f64)> {
    let manifest = single().manifest();
    let one = |r: &htex_format::Representation| {
        let mut scene = scene(single(), constant(80.0, 0.4), 1.0);
        scene.scene.surfaces[0].representation = r.model.clone();
        let error_db = measure.of(r.at[0].quality.as_ref().unwrap()).unwrap();
        let ns = RESERVE * planned(&scene, &file()).ns_per_sample_total;
        (r.model.clone(), error_db, ns)
    };
    manifest.representations.iter().map(one).collect()
}

fn within(budget: Budget) -> Result<Plan, SceneError> {
    let mut scene = scene(single(), constant(80.0, 0.4), 1.0);
    scene.scene.budget = budget;
    plan(&scene, &file(), &Costs::embedded())
}

fn error_of(all: &[(String, f64, f64)], plan: &Plan) -> f64 {
    let model = &plan.representation[0].model;
    all.iter().find(|(id, ..)| id == model).unwrap().1
}

#[test]
fn a_smaller_time_budget_never_reduces_the_error() {
    let all = measured(ErrorMeasure::NineBand);
    let dearest = all.iter().map(|(.., ns)| *ns).fold(0.0, f64::max);
    let cheapest = all.iter().map(|(.., ns)| *ns).fold(f64::INFINITY, f64::min);
    let (mut last_error, mut choices) = (0.0, std::collections::BTreeSet::new());
    for step in 0..=100 {
        let ns = dearest * 1.01 - f64::from(step) / 100.0 * (dearest - cheapest * 0.98);
        let budget = Budget {
            ns_per_sample: Some(ns),
            ..Budget::default()
        };
        match within(budget) {
            Ok(plan) => {
                assert!(RESERVE * plan.ns_per_sample_total <= ns);
                let error_db = error_of(&all, &plan);
                assert!(
                    error_db >= last_error,
                    "{ns} ns: {error_db} dB after {last_error} dB"
                );
                // No representation of smaller error is within the time budget.
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
    assert!(
        choices.len() >= 2,
        "the front has more than one point: {choices:?}, {all:?}"
    );
}

#[test]
fn a_larger_error_budget_never_takes_more_time() {
    for error in ErrorMeasure::ALL {
        let all = measured(error);
        let mut last_ns = f64::INFINITY;
        for step in 0..200 {
            let most_db = 0.1 * 1.05f64.powi(step);
            let budget = Budget {
                max_error_db: Some(most_db),
                error,
                ..Budget::default()
            };
            match within(budget) {
                Ok(plan) => {
                    assert!(error_of(&all, &plan) <= most_db);
                    assert!(plan.representation[0].why.contains(error.name()));
                    let ns = RESERVE * plan.ns_per_sample_total;
                    assert!(ns <= last_ns);
                    last_ns = ns;
                }
                Err(refused) => {
                    assert!(
                        matches!(refused, SceneError::NotNearEnough { .. }),
                        "{refused}"
                    );
                    assert!(all.iter().all(|(_, e, _)| *e > most_db));
                }
            }
        }
        let near = all.iter().filter(|(_, e, _)| *e <= 0.1 * 1.05f64.powi(199));
        let cheapest = near.map(|(.., ns)| *ns).fold(f64::INFINITY, f64::min);
        assert_eq!(last_ns, cheapest);
    }
}
