//! Scene files, which name the assets, the trace and the response in `examples/scenes`.

use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

use htex::{Motion, Registry};
use htex_base::finding::Findings;
use htex_device::{Capabilities, Devices, Quantity, Rates};
use htex_device_builtin::file::FileAdapter;
use htex_scene::{
    Costs, DeviceOverride, Limits, Renderer, Scene, SceneError, Surroundings, plan, read_scene,
};

use crate::promise::{findings, finite, refusal, sentence};

/// Number of rendered blocks.
const BLOCKS: usize = 4;

/// Reads a scene, opens the files it names, plans it for each kind of device, and renders its
/// start.
pub fn scene(input: &[u8]) -> bool {
    read_twice(input);
    let place = folder().join("fuzzed.scene.json");
    match Scene::from_bytes(&place, input, &around(), &DeviceOverride::default()) {
        Ok(scene) => {
            findings(&scene.notes);
            devices_of(&scene).iter().for_each(|device| play(&scene, device));
            true
        }
        Err(SceneError::Invalid { findings: found }) => {
            findings(&found);
            false
        }
        Err(error) => panic!("nothing was to be read here: {error}"),
    }
}

/// The built-in models and the file device.
pub(crate) fn around() -> Surroundings<'static> {
    static AROUND: OnceLock<(Registry, Devices)> = OnceLock::new();
    let (models, devices) =
        AROUND.get_or_init(|| (Registry::builtin(), Devices::new(vec![Arc::new(FileAdapter)])));
    Surroundings { models, embedded: false, devices: Some(devices), signers: None }
}

/// The folder of the assets that the scenes name.
pub(crate) fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/scenes")
}

/// A valid scene is the same after it is written and read again.
fn read_twice(input: &[u8]) {
    let mut findings = Findings::default();
    let scene = read_scene(input, &Limits::default(), &mut findings);
    assert!(scene.is_some() || findings.has_errors(), "no scene, and no reason");
    if let (Some(scene), false) = (scene, findings.has_errors()) {
        let text = serde_json::to_vec(&scene).expect("a scene is JSON");
        let again = read_scene(&text, &Limits::default(), &mut Findings::default());
        assert_eq!(again, Some(scene));
    }
}

/// One device for each quantity.
fn devices_of(scene: &Scene) -> [Capabilities; 3] {
    let file = Capabilities {
        quantity: Quantity::LateralForce,
        rates: Rates::Range { min_hz: 100.0, max_hz: 1e6 },
        default_rate_hz: 8000.0,
        limit: None,
        step: None,
        carrier_hz: None,
        paced: false,
        block_frames: 256,
    };
    let display = Capabilities {
        quantity: Quantity::DisplayVoltage,
        limit: Some(150.0),
        step: Some(0.01),
        carrier_hz: scene.file.seed.is_multiple_of(2).then_some(3000.0),
        ..file.clone()
    };
    let loudspeaker = Capabilities { quantity: Quantity::Sound, limit: Some(1.0), ..file.clone() };
    [file, display, loudspeaker]
}

fn play(scene: &Scene, device: &Capabilities) {
    let made = plan(scene, device, &Costs::embedded())
        .and_then(|plan| Ok((Renderer::new(scene, &plan)?, plan)));
    let mut renderer = match made {
        Ok((renderer, _)) => renderer,
        Err(error) => return refused(&error),
    };
    let mut block = [f32::NAN; 64];
    for i in 0..BLOCKS {
        let motion = Motion::new(40.0 * i as f64, 0.4).with_place_mm([10.0 * i as f64, 5.0]);
        if let Err(error) = renderer.set_motion(motion) {
            refused(&error);
        }
        let left = renderer.frames_left().map_or(block.len(), |left| left as usize);
        let frames = renderer.render(&mut block).unwrap_or_else(|error| {
            refused(&error);
            left.min(block.len())
        });
        finite("sample", block[..frames].iter().map(|x| f64::from(*x)));
        let most = device.limit.unwrap_or(f64::MAX) * (1.0 + 1e-6);
        assert!(block[..frames].iter().all(|x| f64::from(x.abs()) <= most), "above the limit");
    }
}

fn refused(error: &SceneError) {
    sentence(error);
    if let SceneError::Surface { source, .. } = error {
        refusal(source);
    }
}
