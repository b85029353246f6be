//! For each effect, tests two scenes that differ only in whether they need the effect. Its stage
//! must be in one plan and not in the other.

use crate::common;

use common::{
    constant, display, file, fluctuating, grid, integer_file, loudspeaker, planned, rendered,
    scene, single, surface, trace, traced,
};
use htex_device::Capabilities;
use htex_scene::file::{Effect, Motion, Region, Surface, Switch};
use htex_scene::{Renderer, Response, Scene};

type SceneOnDevice = (Scene, Capabilities);

/// A stroke at an average speed of 80 mm/s, which varies by the fraction `swing`.
fn strokes(asset: &htex_play::Texture, swing: f64) -> Scene {
    let x = move |t: f64| 80.0 * t + 80.0 * swing * (4.0 * t).sin() / 4.0;
    traced(asset, trace(0.5, x, |_| 0.4), 0.5)
}

/// Returns a scene with two surfaces of 30 mm side by side, and a stroke from x = 0 at `reach_mm`
/// per second.
fn two(reach_mm: f64) -> Scene {
    let mut scene = traced(single(), trace(0.5, move |t| reach_mm * t, |_| 0.4), 0.5);
    let at = |from: f64| Surface {
        region: Some(Region { x_mm: [from, from + 30.0], y_mm: [-1.0, 1.0] }),
        ..surface()
    };
    scene.file.surfaces = vec![at(0.0), at(30.0)];
    scene.assets = vec![single().clone(); 2];
    scene
}

fn plain() -> Scene {
    scene(single(), constant(80.0, 0.4), 0.5)
}

/// Returns a scene that does not need the effect, and a scene that needs it.
fn pair(effect: Effect) -> (SceneOnDevice, SceneOnDevice) {
    let forces = |change: f64| {
        let force = move |t: f64| 0.4 + change * (5.0 * t).sin();
        traced(single(), trace(0.5, |t| 80.0 * t, force), 0.5)
    };
    let with = |change: &dyn Fn(&mut Scene)| {
        let mut scene = plain();
        change(&mut scene);
        scene
    };
    let turning = traced(single(), trace(0.5, |t| (20.0 * t).sin(), |_| 0.4), 0.5);
    let resting = traced(single(), trace(0.5, |t| 80.0 * t.min(0.3), |_| 0.4), 0.5);
    let response = Response {
        frequency_hz: vec![20.0, 1_000.0],
        magnitude: vec![1.0, 0.2],
        phase_rad: vec![0.0; 2],
    };
    let model_rate = Capabilities { default_rate_hz: 2_000.0, ..file() };
    let ar = with(&|s| s.file.surfaces[0].representation = "ar".to_owned());
    match effect {
        Effect::Interpolation => {
            ((scene(grid(), constant(90.0, 0.5), 0.5), file()), (strokes(grid(), 0.2), file()))
        }
        Effect::FrequencyScaling => {
            ((strokes(single(), 0.0), file()), (strokes(single(), 0.2), file()))
        }
        Effect::LevelScaling => ((forces(0.0), file()), (forces(0.1), file())),
        Effect::Fluctuation => {
            let quiet = scene(&fluctuating(), constant(80.0, 0.4), 0.5);
            let mut asked = quiet.clone();
            asked.file.effects = [(effect, Switch::On)].into();
            ((quiet, file()), (asked, file()))
        }
        Effect::Crossfade => ((two(50.0), file()), (two(80.0), file())),
        Effect::Compensation => {
            ((plain(), display()), (with(&|s| s.response = Some(response.clone())), display()))
        }
        // sBeta renders at the requested rate; AR renders at its own.
        Effect::Resampling => {
            let sbeta = with(&|s| s.file.surfaces[0].representation = "sbeta".to_owned());
            ((sbeta, model_rate), (ar, file()))
        }
        Effect::Direction => ((strokes(single(), 0.2), file()), (turning, file())),
        Effect::Gain => ((plain(), file()), (with(&|s| s.file.device.gain_db = Some(6.0)), file())),
        Effect::SquareRoot => ((plain(), loudspeaker()), (plain(), display())),
        Effect::Contact => ((strokes(single(), 0.2), file()), (resting, file())),
        Effect::Carrier => {
            let without = Capabilities { carrier_hz: None, ..display() };
            ((plain(), without), (plain(), display()))
        }
        Effect::Limiter | Effect::Dither | Effect::Quantisation => {
            ((plain(), file()), (plain(), integer_file()))
        }
    }
}

#[test]
fn each_effect_is_included_only_where_it_is_needed() {
    for effect in Effect::ALL {
        let (without, with) = pair(effect);
        for ((scene, device), wanted) in [(&without, false), (&with, true)] {
            let plan = planned(scene, device);
            let stages: Vec<&str> = plan.stages.iter().map(|s| s.name).collect();
            assert_eq!(stages.contains(&effect.name()), wanted, "{effect:?}: {stages:?}");
            let out = plan.left_out.iter().find(|out| out.name == effect.name());
            assert!(out.is_some() != wanted || effect == Effect::Crossfade, "{effect:?}");
            assert!(plan.stages.iter().all(|s| !s.reason.is_empty() && s.rate_hz > 0.0));
        }
    }
}

#[test]
fn a_constant_motion_to_a_file_takes_three_stages_with_reasons() {
    for scene in [
        plain(),
        scene(single(), constant(120.0, 0.6), 0.5),
        scene(grid(), constant(90.0, 0.5), 0.5),
    ] {
        let plan = planned(&scene, &file());
        assert!(plan.stages.len() <= 3, "{:?}", plan.stages);
        assert!(plan.constant && plan.notes.iter().any(|n| n.contains("nothing changes")));
        let mut renderer = Renderer::new(&scene, &plan).unwrap();
        assert_eq!(rendered(&mut renderer).len(), 10_000);
        assert_eq!(renderer.stages_run().len(), plan.stages.len());
    }
}

#[test]
fn an_untouched_surface_is_left_out() {
    let plan = planned(&two(50.0), &file());
    assert_eq!(plan.representation.len(), 1);
    let out = plan.left_out.iter().find(|out| out.name == "synthesis").unwrap();
    assert_eq!(out.surface, Some(1));
}

#[test]
fn only_required_effects_cannot_be_switched_off() {
    let costs = htex_scene::Costs::embedded();
    for effect in Effect::ALL {
        let (_, (mut scene, device)) = pair(effect);
        scene.file.effects = [(effect, Switch::Off)].into();
        let result = htex_scene::plan(&scene, &device, &costs);
        let needed = matches!(effect, Effect::Resampling | Effect::SquareRoot | Effect::Carrier);
        match result {
            Ok(plan) => {
                assert!(!needed, "{effect:?}");
                assert!(plan.stages.iter().all(|s| s.name != effect.name()), "{effect:?}");
            }
            Err(error) => assert!(needed, "{effect:?}: {error}"),
        }
    }
}

#[test]
fn a_live_scene_includes_all_effects_of_motion() {
    let live = scene(single(), Motion::Live, 1.0);
    let plan = planned(&live, &file());
    let stages: Vec<&str> = plan.stages.iter().map(|s| s.name).collect();
    for wanted in ["frequency_scaling", "level_scaling", "direction", "contact"] {
        assert!(stages.contains(&wanted), "{wanted}: {stages:?}");
    }
    assert!(!plan.constant);
}
