//! A planned chain gives the same samples as the full chain, in which every effect is switched on
//! and neutral if the scene does not need it.

use crate::common;

use common::{
    constant, display, file, grid, integer_file, loudspeaker, planned, scene, single, surface,
    trace, traced,
};
use htex_device::Capabilities;
use htex_play::{Motion, Registry};
use htex_scene::file::{Effect, Motion as SceneMotion, Region, Switch};
use htex_scene::{Plan, Renderer, Response, Scene};
use proptest::prelude::*;

#[derive(Debug, Clone)]
struct Case {
    grid: bool,
    surfaces: usize,
    motion: u8,
    speed_mm_s: f64,
    force_n: f64,
    turns_hz: f64,
    lifts: bool,
    device: u8,
    rate: u8,
    response: bool,
    gain_db: f64,
    model: usize,
    seed: u64,
    blocks: Vec<usize>,
}

fn cases() -> impl Strategy<Value = Case> {
    let what = (
        any::<bool>(),
        1usize..4,
        0u8..3,
        prop_oneof![Just(80.0), 20.0..300.0],
        prop_oneof![Just(0.4), 0.1..1.0],
        0.5..8.0,
        any::<bool>(),
    );
    let how = (
        0u8..4,
        0u8..4,
        any::<bool>(),
        prop_oneof![Just(0.0), -12.0..12.0],
        0..Registry::builtin_names().len(),
        any::<u64>(),
        prop::collection::vec(1usize..700, 1..5),
    );
    (what, how).prop_map(|(what, how)| {
        let (grid, surfaces, motion, speed_mm_s, force_n, turns_hz, lifts) = what;
        let (device, rate, response, gain_db, model, seed, blocks) = how;
        Case {
            grid,
            surfaces,
            motion,
            speed_mm_s,
            force_n,
            turns_hz,
            lifts,
            device,
            rate,
            response,
            gain_db,
            model,
            seed,
            blocks,
        }
    })
}

const SECONDS: f64 = 0.2;

/// Number of scenes that are tried: a sample, unless all are requested.
fn count() -> u32 {
    if xtask::prove::whole() { 2_000 } else { 100 }
}

impl Case {
    fn scene(&self) -> Scene {
        let asset = if self.grid { grid() } else { single() };
        let mut scene = match self.motion {
            0 => scene(asset, constant(self.speed_mm_s, self.force_n), SECONDS),
            1 => traced(asset, self.trace(), SECONDS),
            _ => scene(asset, SceneMotion::Live, SECONDS),
        };
        // A constant motion has no position here, so it needs a surface that covers everything.
        if self.surfaces > 1 && self.motion != 0 {
            self.tile(&mut scene);
        }
        for surface in &mut scene.file.surfaces {
            let models = Registry::builtin_names();
            surface.representation = models[self.model].to_owned();
        }
        scene.file.seed = self.seed;
        if self.response {
            scene.response = Some(Response {
                frequency_hz: vec![0.0, 100.0, 400.0, 1_000.0],
                magnitude: vec![1.0, 0.8, 1.4, 0.1],
                phase_rad: vec![0.0; 4],
            });
        }
        match self.device {
            2 => scene.file.device.drive_v = Some(90.0),
            3 => scene.file.device.pitch = Some(1.5),
            _ => scene.file.device.gain_db = Some(self.gain_db),
        }
        scene
    }

    fn trace(&self) -> htex_scene::Trace {
        let reach = self.speed_mm_s / (std::f64::consts::TAU * self.turns_hz);
        let x = |t: f64| reach * (std::f64::consts::TAU * self.turns_hz * t).sin();
        let force = |t: f64| {
            if self.lifts && (0.1..0.15).contains(&t) {
                0.0
            } else {
                self.force_n * (1.0 + 0.3 * (20.0 * t).sin())
            }
        };
        trace(SECONDS, x, force)
    }

    /// Places surfaces of 3 mm width side by side, with an empty region to their right.
    fn tile(&self, scene: &mut Scene) {
        let asset = scene.assets[0].clone();
        scene.assets = vec![asset; self.surfaces];
        let tile = |i: usize| {
            let left = -4.0 + 3.0 * i as f64;
            let region = Region { x_mm: [left, left + 3.0], y_mm: [-1.0, 1.0] };
            htex_scene::file::Surface { region: Some(region), gain: 1.0 + i as f64, ..surface() }
        };
        scene.file.surfaces = (0..self.surfaces).map(tile).collect();
    }

    fn device(&self) -> Capabilities {
        let device = match self.device {
            0 => file(),
            1 => integer_file(),
            2 => display(),
            _ => loudspeaker(),
        };
        // 2,000 Hz is the rate of the AR model.
        let rate_hz = [20_000.0, 44_100.0, 16_384.0, 2_000.0][usize::from(self.rate)];
        Capabilities {
            default_rate_hz: rate_hz,
            carrier_hz: device.carrier_hz.map(|hz| hz.min(0.4 * rate_hz)),
            ..device
        }
    }

    /// Returns all samples, rendered in blocks of the given sizes. A live motion changes in
    /// between.
    fn samples(&self, renderer: &mut Renderer, blocks: &[usize]) -> Vec<f32> {
        let frames = renderer.frames_left().unwrap() as usize;
        let mut samples = vec![0.0f32; frames];
        let (mut done, mut sizes) = (0, blocks.iter().cycle());
        while done < frames {
            // A live motion changes at fixed frames, whatever the blocks.
            let (part, end) = (done / 1_024, (done / 1_024 + 1) * 1_024);
            if done % 1_024 == 0 {
                renderer.set_motion(self.live(part)).unwrap();
            }
            let size = (*sizes.next().unwrap()).min(end - done).min(frames - done);
            let rendered = renderer.render(&mut samples[done..done + size]).unwrap();
            assert_eq!(rendered, size);
            done += size;
        }
        assert_eq!(renderer.render(&mut [0.0; 8]).unwrap(), 0, "no samples after the end");
        samples
    }

    fn live(&self, part: usize) -> Motion {
        let phase = part as f64 * self.turns_hz;
        let force_n = if self.lifts && part == 2 { 0.0 } else { self.force_n };
        Motion::new(self.speed_mm_s * phase.cos(), force_n).with_place_mm([4.0 * phase.sin(), 0.0])
    }
}

fn names(plan: &Plan) -> Vec<(&'static str, Option<usize>)> {
    plan.stages.iter().map(|s| (s.name, s.surface)).collect()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: count(), failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn the_planned_chain_gives_the_samples_of_the_full_one(case in cases()) {
        let (scene, device) = (case.scene(), case.device());
        let mut full = scene.clone();
        full.file.effects = Effect::ALL.map(|effect| (effect, Switch::On)).into();
        let (short_plan, full_plan) = (planned(&scene, &device), planned(&full, &device));

        let mut short = Renderer::new(&scene, &short_plan).unwrap();
        let mut full = Renderer::new(&full, &full_plan).unwrap();
        let short_samples = case.samples(&mut short, &case.blocks);
        let full_samples = case.samples(&mut full, &[64]);
        let peak = full_samples.iter().fold(0.0f32, |peak, x| peak.max(x.abs()));
        let full_scale = device.limit.map_or(peak, |limit| limit as f32);
        for (i, (a, b)) in short_samples.iter().zip(&full_samples).enumerate() {
            prop_assert!(a.is_finite() && (a - b).abs() <= 1e-6 * full_scale, "{i}: {a} {b}");
        }

        // The stages that ran are the planned ones. A full chain has every effect for each surface.
        for (renderer, plan) in [(&short, &short_plan), (&full, &full_plan)] {
            let runs = renderer.stages_run();
            let ran: Vec<_> = runs.iter().map(|run| (run.name, run.surface)).collect();
            prop_assert_eq!(ran, names(plan));
            // With several surfaces, the finger may stay on one for less than a sample of its
            // model.
            prop_assert!(case.surfaces > 1 || runs.iter().all(|run| run.blocks > 0), "{:?}", runs);
        }
        prop_assert!(short_plan.stages.len() <= full_plan.stages.len());
        let effects = |plan: &Plan| Effect::ALL.iter().filter(|e| {
            plan.stages.iter().any(|s| s.name == e.name())
        }).count();
        if !full_plan.representation.is_empty() {
            prop_assert_eq!(effects(&full_plan), Effect::ALL.len());
        }
    }
}
