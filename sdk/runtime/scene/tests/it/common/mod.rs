//! Scenes of simulated surfaces in memory.

pub(crate) mod cases;

use std::path::PathBuf;
use std::sync::OnceLock;

use htex_author::recording::TraceColumns;
use htex_author::simulate::{SimulationOptions, Surface as Simulated, simulate};
use htex_author::{AssetRequest, Exploration, ModelRequest, Take, fit_asset};
use htex_device::{Capabilities, Quantity, Rates, Settings};
use htex_format::Fluctuation;
use htex_play::{Registry, Texture};
use htex_scene::file::{Budget, Constant, DeviceChoice, Motion, SceneFile, Surface};
use htex_scene::{Costs, Plan, Renderer, Scene, Trace, plan};

/// An asset with one condition, 80 mm/s and 0.4 N.
pub(crate) fn single() -> &'static Texture {
    static ASSET: OnceLock<Texture> = OnceLock::new();
    ASSET.get_or_init(|| asset(Simulated::Sandpaper, &[(80.0, 0.4)]))
}

/// An asset with four conditions, 60 and 120 mm/s by 0.3 and 0.6 N.
pub(crate) fn grid() -> &'static Texture {
    static ASSET: OnceLock<Texture> = OnceLock::new();
    let known = [(60.0, 0.3), (120.0, 0.3), (60.0, 0.6), (120.0, 0.6)];
    ASSET.get_or_init(|| asset(Simulated::CoarseFabric, &known))
}

/// An asset with nine conditions, 60, 90 and 120 mm/s by 0.3, 0.45 and 0.6 N.
pub(crate) fn nine() -> &'static Texture {
    static ASSET: OnceLock<Texture> = OnceLock::new();
    let known = |i: usize| {
        let (speed, force) = ((i % 3) as f64, (i / 3) as f64);
        (60.0 + 30.0 * speed, 0.3 + 0.15 * force)
    };
    ASSET.get_or_init(|| asset(Simulated::CoarseFabric, &[0, 1, 2, 3, 4, 5, 6, 7, 8].map(known)))
}

/// An asset with three speeds and computed conditions between them.
pub(crate) fn three_speeds() -> &'static Texture {
    static ASSET: OnceLock<Texture> = OnceLock::new();
    let known = [(40.0, 0.4), (80.0, 0.4), (160.0, 0.4)];
    ASSET.get_or_init(|| asset(Simulated::Sandpaper, &known))
}

fn asset(surface: Simulated, conditions: &[(f64, f64)]) -> Texture {
    let take = |&(speed_mm_s, force_n): &(f64, f64)| {
        let options = SimulationOptions::new(surface)
            .with_speed_mm_s(speed_mm_s)
            .with_force_n(force_n)
            .with_duration_s(4.0);
        Take {
            recording: simulate(&options).unwrap().to_recording("simulated").unwrap(),
            given: Exploration { speed_mm_s: Some(speed_mm_s), force_n: Some(force_n) },
        }
    };
    let request = AssetRequest::new("simulated")
        .with_models(Registry::builtin().models().iter().map(ModelRequest::new));
    let takes: Vec<Take> = conditions.iter().map(take).collect();
    let mut fitted = fit_asset(&takes, &request).unwrap();
    // An asset that fluctuates plays other samples if the scene switches this effect on.
    fitted.asset.manifest.fluctuation = None;
    Texture::from_bytes(&fitted.asset.to_bytes().unwrap()).unwrap()
}

/// The asset of [`single`] with a fluctuation.
pub(crate) fn fluctuating() -> Texture {
    let mut asset = single().data().clone();
    asset.manifest.fluctuation = Fluctuation::from_db([4.0, 3.0]);
    Texture::from_bytes(&asset.to_bytes().unwrap()).unwrap()
}

/// A scene with one surface without a region.
pub(crate) fn scene(asset: &Texture, motion: Motion, duration_s: f64) -> Scene {
    Scene {
        file: SceneFile {
            htex_scene: "1.0".to_owned(),
            surfaces: vec![surface()],
            motion,
            device: DeviceChoice::default(),
            duration_s: Some(duration_s),
            seed: 1,
            budget: Budget::default(),
            effects: Default::default(),
        },
        folder: PathBuf::new(),
        assets: vec![asset.clone()],
        trace: None,
        response: None,
        settings: Settings::default(),
        notes: Vec::new(),
    }
}

pub(crate) fn surface() -> Surface {
    Surface {
        asset: PathBuf::from("simulated.htex"),
        region: None,
        layer: 0,
        gain: 1.0,
        representation: "auto".to_owned(),
    }
}

pub(crate) fn constant(speed_mm_s: f64, force_n: f64) -> Motion {
    Motion::Constant(Constant { speed_mm_s, force_n, from_mm: None, direction_deg: 0.0 })
}

/// A trace with 200 rows per second. Position along x (mm) and force (newtons) are functions of
/// time.
pub(crate) fn trace(
    duration_s: f64,
    x_mm: impl Fn(f64) -> f64,
    force_n: impl Fn(f64) -> f64,
) -> Trace {
    let t_s: Vec<f64> = (0..=(duration_s * 200.0) as usize + 1).map(|i| i as f64 / 200.0).collect();
    Trace::new(TraceColumns {
        x_mm: t_s.iter().map(|t| x_mm(*t)).collect(),
        y_mm: vec![0.0; t_s.len()],
        force_n: t_s.iter().map(|t| force_n(*t)).collect(),
        speed_mm_s: None,
        t_s,
        warnings: Vec::new(),
    })
}

/// A scene with a trace as its motion.
pub(crate) fn traced(asset: &Texture, trace: Trace, duration_s: f64) -> Scene {
    Scene { trace: Some(trace), ..scene(asset, Motion::Trace("trace.csv".into()), duration_s) }
}

/// A file of 32-bit floats, newtons.
pub(crate) fn file() -> Capabilities {
    Capabilities {
        quantity: Quantity::LateralForce,
        rates: Rates::Range { min_hz: 100.0, max_hz: 1e6 },
        default_rate_hz: 20_000.0,
        limit: None,
        step: None,
        carrier_hz: None,
        paced: false,
        block_frames: 256,
    }
}

/// A file of 16-bit integers, 4 N full scale.
pub(crate) fn integer_file() -> Capabilities {
    Capabilities { limit: Some(4.0), step: Some(4.0 / 32_768.0), ..file() }
}

/// An electrovibration display behind a 16-bit converter.
pub(crate) fn display() -> Capabilities {
    Capabilities {
        quantity: Quantity::DisplayVoltage,
        limit: Some(150.0),
        step: Some(20.0 / 65_536.0 * 50.0),
        carrier_hz: Some(7_000.0),
        paced: true,
        ..file()
    }
}

pub(crate) fn loudspeaker() -> Capabilities {
    Capabilities {
        quantity: Quantity::Sound,
        default_rate_hz: 48_000.0,
        limit: Some(1.0),
        paced: true,
        ..file()
    }
}

pub(crate) fn planned(scene: &Scene, device: &Capabilities) -> Plan {
    plan(scene, device, &Costs::embedded()).unwrap()
}

/// Renders a scene to its end and returns all samples.
pub(crate) fn rendered(renderer: &mut Renderer) -> Vec<f32> {
    let mut all = Vec::new();
    let mut block = [0.0f32; 64];
    loop {
        let frames = renderer.render(&mut block).unwrap();
        all.extend_from_slice(&block[..frames]);
        if frames < block.len() {
            return all;
        }
    }
}
