//! Measures how much time short chains save, whether budgets are met, and how many voices one core
//! can play: `cargo run --release -p htex-scene --example chains`. Add `--` and `saved`, `live`,
//! `budgets`, `voices` or `fingers` for a single table.
//!
//! Times are the minimum over many short runs. All runs of a table are interleaved.
#![allow(clippy::unwrap_used)] // A program for developers: a failure may end it.

#[allow(dead_code)]
#[path = "../tests/it/common/mod.rs"]
mod common;

use std::time::Instant;

use common::{
    constant, display, file, grid, integer_file, loudspeaker, nine, planned, scene, single, trace,
    traced,
};
use htex_device::Capabilities;
use htex_play::Registry;
use htex_scene::file::{Budget, Effect, Motion, Switch};
use htex_scene::{Costs, Renderer, Response, Scene, plan};

const BLOCK: usize = 64;
const ROUNDS: usize = 150;
const STRETCH: usize = 32;

fn main() {
    let only = std::env::args().nth(1);
    let tables: [(&str, fn()); 6] = [
        ("stated", stated),
        ("saved", saved),
        ("live", live),
        ("budgets", budgets),
        ("voices", voices),
        ("fingers", fingers),
    ];
    for (name, table) in tables {
        if only.as_deref().is_none_or(|only| only == name) {
            table();
        }
    }
}

/// Six typical scenes.
fn typical() -> Vec<(&'static str, Scene, Capabilities)> {
    let swings = |t: f64| 15.0 * (std::f64::consts::TAU * t).sin();
    let presses = |t: f64| 0.45 + 0.1 * (3.0 * t).sin();
    let long = 1e4;
    let mut preview = scene(single(), constant(80.0, 0.4), long);
    preview.file.device.pitch = Some(2.0);
    let moved = |asset: &htex_play::Texture| {
        let mut moved = traced(asset, trace(600.0, swings, presses), 600.0);
        moved.file.surfaces[0].representation = "ar".to_owned();
        moved
    };
    let at_rate = Capabilities { default_rate_hz: 2_000.0, ..file() };
    let ar = |mut scene: Scene| {
        scene.file.surfaces[0].representation = "ar".to_owned();
        scene
    };
    let still = || ar(scene(single(), constant(80.0, 0.4), long));
    vec![
        ("file at the model's rate, constant", still(), at_rate),
        ("file of floats, constant", still(), file()),
        ("file of integers, constant", still(), integer_file()),
        ("preview by ear, constant", preview, loudspeaker()),
        ("file of floats, strokes over a grid", moved(grid()), file()),
        ("display, strokes at one condition", moved(single()), display()),
    ]
}

/// Returns the minimum time per sample of each renderer, nanoseconds. The renderers run in turns.
fn interleaved(renderers: &mut [Renderer]) -> Vec<f64> {
    let mut least = vec![f64::INFINITY; renderers.len()];
    let mut block = [0.0f32; BLOCK];
    for _ in 0..ROUNDS {
        for (renderer, least) in renderers.iter_mut().zip(&mut least) {
            let start = Instant::now();
            for _ in 0..STRETCH {
                renderer.render(std::hint::black_box(&mut block)).unwrap();
            }
            let ns = start.elapsed().as_nanos() as f64 / (STRETCH * BLOCK) as f64;
            *least = least.min(ns);
        }
    }
    least
}

/// Three variants of each typical scene: unchanged, with a compensated display response, and with
/// all effects on.
fn variants() -> Vec<(String, Scene, Capabilities)> {
    let mut all = Vec::new();
    for (name, scene, device) in typical() {
        let mut full = scene.clone();
        full.file.effects = Effect::ALL.map(|effect| (effect, Switch::On)).into();
        let mut compensated = scene.clone();
        compensated.response = Some(response());
        all.push((format!("{name}, compensated"), compensated, device.clone()));
        all.push((format!("{name}, all stages"), full, device.clone()));
        all.push((name.to_owned(), scene, device));
    }
    all
}

/// A display that resonates at 150 Hz.
fn response() -> Response {
    let frequency_hz: Vec<f64> = (1..=100).map(|i| f64::from(10 * i)).collect();
    let resonance = |hz: &f64| 1.0 + 3.0 / (1.0 + ((hz - 150.0) / 60.0).powi(2));
    Response {
        magnitude: frequency_hz.iter().map(resonance).collect(),
        phase_rad: vec![0.0; frequency_hz.len()],
        frequency_hz,
    }
}

/// Compares each plan's stated cost, computed from costs measured here, with the time that its
/// chain takes.
fn stated() {
    let costs = Costs::measure(&Registry::builtin(), "this machine").unwrap();
    println!(
        "ns a sample                                          stated    takes   stated / takes"
    );
    for (name, scene, device) in variants() {
        let plan = plan(&scene, &device, &costs).unwrap();
        let takes = over_strokes(&mut Renderer::new(&scene, &plan).unwrap());
        let total = plan.ns_per_sample_total;
        println!("{name:50} {total:8.2} {takes:8.2} {:8.2}", total / takes);
    }
}

/// Returns the minimum time per sample, nanoseconds, over whole strokes during which the motion
/// changes.
fn over_strokes(renderer: &mut Renderer) -> f64 {
    let blocks = (renderer.rate_hz() * STROKES_S / BLOCK as f64).ceil() as usize;
    let mut block = [0.0f32; BLOCK];
    let mut least = f64::INFINITY;
    for _ in 0..ROUNDS {
        let start = Instant::now();
        for _ in 0..blocks {
            renderer.render(std::hint::black_box(&mut block)).unwrap();
        }
        let ns = start.elapsed().as_nanos() as f64 / (blocks * BLOCK) as f64;
        least = least.min(ns);
    }
    least
}

/// Duration of a back-and-forth stroke, seconds.
const STROKES_S: f64 = 1.0;

fn saved() {
    println!("ns a sample                          stages  planned  all stages   ratio");
    for (name, scene, device) in typical() {
        let mut full = scene.clone();
        full.file.effects = Effect::ALL.map(|effect| (effect, Switch::On)).into();
        let plans = [planned(&scene, &device), planned(&full, &device)];
        let mut renderers =
            [Renderer::new(&scene, &plans[0]).unwrap(), Renderer::new(&full, &plans[1]).unwrap()];
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

/// Compares the cost of a live motion, which is set before every block, with the cost of a constant
/// motion.
fn live() {
    println!(
        "\nns a sample, blocks of 64 at 20 kHz     constant  live, one condition  live, nine conditions"
    );
    for model in Registry::builtin_names() {
        let named = |asset, motion| {
            let mut scene = scene(asset, motion, 1e4);
            scene.file.duration_s = None;
            scene.file.surfaces[0].representation = model.to_owned();
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
        println!("{model:38} {:8.2} {:20.2} {:22.2}", least[0], least[1], least[2]);
    }
}

/// Number of consecutive runs. Together they cover a path over the grid.
const STRETCHES: usize = 10;

/// Returns the time per sample of a live renderer, nanoseconds: the mean over several runs.
fn stretches(renderer: &mut [Renderer; 1]) -> f64 {
    let mut block = [0.0f32; BLOCK];
    let [renderer] = renderer;
    let blocks = STRETCHES * STRETCH;
    let start = Instant::now();
    for i in 0..blocks {
        let t = i as f64 / blocks as f64;
        renderer.set_motion(finger(t)).unwrap();
        renderer.render(std::hint::black_box(&mut block)).unwrap();
    }
    start.elapsed().as_nanos() as f64 / (blocks * BLOCK) as f64
}

fn budgets() {
    let costs = Costs::measure(&Registry::builtin(), "this machine").unwrap();
    println!("\nbudget, ns  chosen             planned  rendered  of the budget");
    for ns in [100.0, 20.0, 12.0, 10.0, 9.0, 8.0, 6.0, 4.0, 3.5, 3.3, 3.1, 2.9] {
        let mut scene = scene(single(), constant(80.0, 0.4), 1e4);
        scene.file.budget = Budget { ns_per_sample: Some(ns), ..Budget::default() };
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

/// Prints the time per sample of one voice among many, each with its own chain and resampler. Also
/// prints how many voices one core can play at 20 kHz, extrapolated from the cost with 5,000
/// voices. Voices start at different times, like independent fingers.
fn voices() {
    println!(
        "\nns a sample, blocks of 64 at 20 kHz   1 voice  1,000  5,000  10,000  \
         in real time  slowest block of 5,000"
    );
    for model in Registry::builtin_names() {
        row(&format!("{model}, scene"), |seed| {
            let mut renderer = scene_voice(model, seed);
            move |block: &mut [f32]| {
                renderer.render(block).unwrap();
            }
        });
        row(&format!("{model}, app"), |seed| {
            let mut voice = app_voice(model, seed);
            move |block: &mut [f32]| voice.render(block).unwrap()
        });
    }
}

fn row<V: FnMut(&mut [f32])>(name: &str, make: impl Fn(u64) -> V) {
    let mut many: Vec<V> = Vec::new();
    let mut costs = Vec::new();
    for count in [1, 1_000, 5_000, 10_000] {
        while many.len() < count {
            let mut voice = make(many.len() as u64);
            // The voices start at different points of the period in which each voice computes one
            // frame.
            voice(&mut vec![0.0; BLOCK * (many.len() * 61 % FRAME_BLOCKS)]);
            many.push(voice);
        }
        costs.push(among(&mut many));
    }
    let (ns, slowest_ms) = costs[2];
    println!(
        "{name:36} {:8.2} {:6.2} {ns:6.2} {:7.2}  {:12.0}  {slowest_ms:6.2} ms of 3.20",
        costs[0].0,
        costs[1].0,
        costs[3].0,
        1e9 / (20_000.0 * ns)
    );
}

fn scene_voice(model: &str, seed: u64) -> Renderer {
    let mut scene = scene(single(), constant(80.0, 0.4), 1e4);
    scene.file.surfaces[0].representation = model.to_owned();
    scene.file.seed = seed;
    Renderer::new(&scene, &planned(&scene, &file())).unwrap()
}

fn app_voice(model: &str, seed: u64) -> htex_play::Voice {
    let options = htex_play::VoiceOptions::default().with_seed(seed);
    single().representation(model).unwrap().voice(&options).unwrap()
}

/// Blocks in 0.36 s of sound. In this time each voice computes one frame.
const FRAME_BLOCKS: usize = 112;

/// Renders the voices in turn. Returns the time per sample, nanoseconds, and the time of the
/// slowest block, milliseconds. Both are the minimum over several runs.
fn among<V: FnMut(&mut [f32])>(voices: &mut [V]) -> (f64, f64) {
    let mut block = [0.0f32; BLOCK];
    let mut least = (f64::INFINITY, f64::INFINITY);
    for _ in 0..(8_000 / voices.len()).clamp(4, 400) {
        let (mut slowest_s, start) = (0.0f64, Instant::now());
        for _ in 0..FRAME_BLOCKS {
            let start = Instant::now();
            for voice in &mut *voices {
                voice(std::hint::black_box(&mut block));
            }
            slowest_s = slowest_s.max(start.elapsed().as_secs_f64());
        }
        let samples = (FRAME_BLOCKS * BLOCK * voices.len()) as f64;
        let ns = 1e9 * start.elapsed().as_secs_f64() / samples;
        least = (least.0.min(ns), least.1.min(1e3 * slowest_s));
    }
    least
}

/// Measures a thousand live voices of each model over nine conditions. Each voice has its own start
/// time and its own motion, which changes all the time.
fn fingers() {
    println!("\n1,000 live voices over nine conditions, blocks of 64 at 20 kHz: part of one core");
    for model in Registry::builtin_names() {
        let mut many: Vec<_> = (0..1_000).map(|i| live_voice(model, i)).collect();
        for (i, voice) in many.iter_mut().enumerate() {
            (0..i * 61 % FRAME_BLOCKS).for_each(|_| voice(&mut [0.0; BLOCK]));
        }
        let (ns, slowest_ms) = among(&mut many);
        let part = ns * 1e-9 * 20_000.0 * many.len() as f64;
        println!("{model:8} {part:6.2}, slowest block {slowest_ms:5.2} ms of 3.20");
    }
}

fn live_voice(model: &str, seed: u64) -> impl FnMut(&mut [f32]) {
    let mut scene = scene(nine(), Motion::Live, 1e4);
    scene.file.duration_s = None;
    scene.file.seed = seed;
    scene.file.surfaces[0].representation = model.to_owned();
    let mut renderer = Renderer::new(&scene, &planned(&scene, &file())).unwrap();
    let mut block = seed as f64;
    move |out| {
        renderer.set_motion(finger(block / 320.0)).unwrap();
        renderer.render(out).unwrap();
        block += 1.0;
    }
}

/// A finger at time `t` of its path over the nine conditions.
fn finger(t: f64) -> htex_play::Motion {
    htex_play::Motion::new(90.0 + 35.0 * (17.0 * t).sin(), 0.45 + 0.2 * (11.0 * t).cos())
}
