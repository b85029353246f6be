//! What the shortest chain saves, whether budgets are met, and how many voices one core plays:
//! `cargo run --release -p htex-scene --example chains`.
//!
//! Times are the least of many short stretches, all of a table interleaved in one run.
#![allow(clippy::unwrap_used)] // A program for developers: a failure may end it.

#[path = "../tests/common/mod.rs"]
mod common;

use std::time::Instant;

use common::{
    constant, display, file, grid, integer_file, loudspeaker, nine, planned, scene, single, trace,
    traced,
};
use htex_device::Capabilities;
use htex_play::Registry;
use htex_scene::file::{Budget, Effect, Motion, Switch};
use htex_scene::{Costs, Finger, LoadedScene, Renderer, plan};

const BLOCK: usize = 64;
const ROUNDS: usize = 150;
const STRETCH: usize = 32;
const MODELS: [&str; 6] = ["ar", "mfcc", "speak", "sbeta", "sslope", "bands"];

fn main() {
    saved();
    live();
    budgets();
    voices();
}

/// Six scenes as people have them.
fn typical() -> Vec<(&'static str, LoadedScene, Capabilities)> {
    let swings = |t: f64| 15.0 * (std::f64::consts::TAU * t).sin();
    let presses = |t: f64| 0.45 + 0.1 * (3.0 * t).sin();
    let long = 1e4;
    let mut preview = scene(single(), constant(80.0, 0.4), long);
    preview.scene.device.pitch = Some(2.0);
    let moved = |asset: &htex_play::Asset| {
        let mut moved = traced(asset, trace(600.0, swings, presses), 600.0);
        moved.scene.surfaces[0].representation = "ar".to_owned();
        moved
    };
    let at_rate = Capabilities {
        default_rate_hz: 2_000.0,
        ..file()
    };
    let ar = |mut scene: LoadedScene| {
        scene.scene.surfaces[0].representation = "ar".to_owned();
        scene
    };
    let still = || ar(scene(single(), constant(80.0, 0.4), long));
    vec![
        ("file at the model's rate, constant", still(), at_rate),
        ("file of floats, constant", still(), file()),
        ("file of integers, constant", still(), integer_file()),
        ("preview by ear, constant", preview, loudspeaker()),
        ("file of floats, strokes over a grid", moved(grid()), file()),
        (
            "display, strokes at one condition",
            moved(single()),
            display(),
        ),
    ]
}

/// The least time of a sample for each renderer, nanoseconds, taken in turns.
fn interleaved(renderers: &mut [Renderer]) -> Vec<f64> {
    let mut least = vec![f64::INFINITY; renderers.len()];
    let mut block = [0.0f32; BLOCK];
    for _ in 0..ROUNDS {
        for (renderer, least) in renderers.iter_mut().zip(&mut least) {
            let start = Instant::now();
            for _ in 0..STRETCH {
                renderer.render(std::hint::black_box(&mut block));
            }
            let ns = start.elapsed().as_nanos() as f64 / (STRETCH * BLOCK) as f64;
            *least = least.min(ns);
        }
    }
    least
}

fn saved() {
    println!("ns a sample                          stages  planned  all stages   ratio");
    for (name, scene, device) in typical() {
        let mut full = scene.clone();
        full.scene.effects = Effect::ALL.map(|effect| (effect, Switch::On)).into();
        let plans = [planned(&scene, &device), planned(&full, &device)];
        let mut renderers = [
            Renderer::new(&scene, &plans[0]).unwrap(),
            Renderer::new(&full, &plans[1]).unwrap(),
        ];
        let ns = interleaved(&mut renderers);
        println!(
            "{name:36} {:2} / {:2}  {:7.2}  {:10.2}  {:5.2}x",
            plans[0].stages.len(),
            plans[1].stages.len(),
            ns[0],
            ns[1],
            ns[1] / ns[0]
        );
    }
}

/// A finger that moves all the time, looked at before every block: what it costs over a constant one.
fn live() {
    println!(
        "\nns a sample, blocks of 64 at 20 kHz     constant  live, one condition  live, nine conditions"
    );
    for model in MODELS {
        let named = |asset, motion| {
            let mut scene = scene(asset, motion, 1e4);
            scene.scene.duration_s = None;
            scene.scene.surfaces[0].representation = model.to_owned();
            Renderer::new(&scene, &planned(&scene, &file())).unwrap()
        };
        let mut still = [named(single(), constant(80.0, 0.4))];
        let mut one = [named(single(), Motion::Live)];
        let mut nine = [named(nine(), Motion::Live)];
        let mut least = [f64::INFINITY; 3];
        for _ in 0..ROUNDS / STRETCHES {
            least[0] = least[0].min(stretches(&mut still));
            least[1] = least[1].min(stretches(&mut one));
            least[2] = least[2].min(stretches(&mut nine));
        }
        println!(
            "{model:38} {:8.2} {:20.2} {:22.2}",
            least[0], least[1], least[2]
        );
    }
}

/// Stretches in a row, so that every part of a path over the grid is in them.
const STRETCHES: usize = 10;

/// The time of a sample of a live renderer, nanoseconds: the mean over some stretches.
fn stretches(renderer: &mut [Renderer; 1]) -> f64 {
    let mut block = [0.0f32; BLOCK];
    let [renderer] = renderer;
    let blocks = STRETCHES * STRETCH;
    let start = Instant::now();
    for i in 0..blocks {
        let t = i as f64 / blocks as f64;
        let finger = Finger {
            speed_mm_s: 90.0 + 35.0 * (17.0 * t).sin(),
            force_n: 0.45 + 0.2 * (11.0 * t).cos(),
            at_mm: None,
        };
        renderer.set_motion(finger).unwrap();
        renderer.render(std::hint::black_box(&mut block));
    }
    start.elapsed().as_nanos() as f64 / (blocks * BLOCK) as f64
}

fn budgets() {
    let costs = Costs::measure(&Registry::builtin(), "this machine").unwrap();
    println!("\nbudget, ns  chosen             planned  rendered  of the budget");
    for ns in [
        100.0, 20.0, 12.0, 10.0, 9.0, 8.0, 6.0, 4.0, 3.5, 3.3, 3.1, 2.9,
    ] {
        let mut scene = scene(single(), constant(80.0, 0.4), 1e4);
        scene.scene.budget = Budget {
            ns_per_sample: Some(ns),
            ..Budget::default()
        };
        match plan(&scene, &file(), &costs) {
            Err(error) => println!("{ns:10}  {error}"),
            Ok(plan) => {
                let mut renderer = [Renderer::new(&scene, &plan).unwrap()];
                let rendered = interleaved(&mut renderer)[0];
                println!(
                    "{ns:10}  {:18} {:7.2}  {rendered:8.2}  {:12.2}",
                    plan.representation[0].model,
                    plan.ns_per_sample_total,
                    rendered / ns
                );
            }
        }
    }
}

/// Voices that one core plays at 20 kHz, each a chain of its own with a resampler of its own.
fn voices() {
    println!("\nmodel    voices in real time at 20 kHz, blocks of 64");
    for model in MODELS {
        println!("{model:8} {:6}", most_voices(model));
    }
}

fn most_voices(model: &str) -> usize {
    let mut many: Vec<Renderer> = Vec::new();
    let mut block = [0.0f32; BLOCK];
    let period_s = BLOCK as f64 / 20_000.0;
    loop {
        for _ in 0..250 {
            let mut scene = scene(single(), constant(80.0, 0.4), 1e4);
            scene.scene.surfaces[0].representation = model.to_owned();
            scene.scene.seed = many.len() as u64;
            many.push(Renderer::new(&scene, &planned(&scene, &file())).unwrap());
        }
        // Half a second of sound: as long as real time, on the whole.
        let periods = (0.5 / period_s) as usize;
        let start = Instant::now();
        for _ in 0..periods {
            for voice in &mut many {
                voice.render(std::hint::black_box(&mut block));
            }
        }
        let took = start.elapsed().as_secs_f64() / (periods as f64 * period_s);
        if took > 1.0 {
            return (many.len() as f64 / took) as usize;
        }
    }
}
