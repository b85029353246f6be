//! Scenes of one surface, over which a finger follows a trace.

use std::path::PathBuf;

use htex::Texture;
use htex_author::recording::TraceColumns;
use htex_device::{Capabilities, Quantity, Rates, Settings};
use htex_scene::file::{Budget, DeviceChoice, Motion, SceneFile, Surface};
use htex_scene::{Costs, Plan, Renderer, Scene, Trace, plan};

/// A finger's places, 500 a second.
pub fn trace(seconds: f64, force_n: f64, place_mm: impl Fn(f64) -> [f64; 2]) -> Trace {
    let t_s: Vec<f64> = (0..=(seconds * 500.0) as usize).map(|row| row as f64 / 500.0).collect();
    Trace::new(TraceColumns {
        x_mm: t_s.iter().map(|&t| place_mm(t)[0]).collect(),
        y_mm: t_s.iter().map(|&t| place_mm(t)[1]).collect(),
        force_n: vec![force_n; t_s.len()],
        speed_mm_s: None,
        warnings: Vec::new(),
        t_s,
    })
}

/// A scene with one surface that covers everything, and a finger that follows a trace.
pub fn traced(asset: &Texture, trace: Trace) -> Scene {
    Scene {
        file: SceneFile {
            htex_scene: "1.0".to_owned(),
            surfaces: vec![Surface::everywhere("followed.htex".as_ref())],
            motion: Motion::Trace("trace.csv".into()),
            device: DeviceChoice::default(),
            duration_s: None,
            seed: 1,
            budget: Budget::default(),
            effects: Default::default(),
        },
        folder: PathBuf::new(),
        assets: vec![asset.clone()],
        trace: Some(trace),
        response: None,
        settings: Settings::default(),
        notes: Vec::new(),
    }
}

pub fn planned(scene: &Scene, rate_hz: f64) -> Plan {
    let file = Capabilities {
        quantity: Quantity::LateralForce,
        rates: Rates::Range { min_hz: 100.0, max_hz: 1e6 },
        default_rate_hz: rate_hz,
        limit: None,
        step: None,
        carrier_hz: None,
        paced: false,
        block_frames: 256,
    };
    plan(scene, &file, &Costs::embedded()).unwrap()
}

pub fn rendered(scene: &Scene, plan: &Plan) -> Vec<f32> {
    let mut renderer = Renderer::new(scene, plan).unwrap();
    let mut out = vec![0.0; renderer.frames_left().unwrap() as usize];
    assert_eq!(renderer.render(&mut out).unwrap(), out.len());
    out
}
