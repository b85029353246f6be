//! A program that takes the samples itself gets the same samples as the file device.

use std::path::Path;
use std::sync::Arc;

use htex_device::Devices;
use htex_device_builtin::file::FileAdapter;
use htex_play::Registry;
use htex_scene::{Costs, DeviceOverride, Renderer, Scene, SceneErrorKind, Surroundings, plan};

const RATE_HZ: f64 = 16_000.0;
const ADAPTER: &str = "org.htex.file";

fn example(name: &str) -> String {
    format!("{}/../../../examples/scenes/{name}", env!("CARGO_MANIFEST_DIR"))
}

fn two_seconds(mut renderer: Renderer) -> Vec<f32> {
    let mut samples = vec![0.0; 2 * RATE_HZ as usize];
    assert_eq!(renderer.render(&mut samples).unwrap(), samples.len());
    samples
}

#[test]
fn a_scene_without_a_device_has_the_samples_of_a_file() {
    let path = example("two-swatches.scene.json");
    let (models, devices) = (Registry::builtin(), Devices::new(vec![Arc::new(FileAdapter)]));
    let around =
        Surroundings { models: &models, embedded: true, devices: Some(&devices), signers: None };
    let device = DeviceOverride {
        adapter: Some(ADAPTER.to_owned()),
        rehearsal: true,
        rate_hz: Some(RATE_HZ),
        ..DeviceOverride::default()
    };
    let scene = Scene::open_with(Path::new(&path), &around, &device).unwrap();
    let adapter = &devices.find_output(ADAPTER).unwrap().adapter;
    let able = adapter.capabilities(&scene.settings).unwrap();
    let plan = plan(&scene, &able, &Costs::embedded()).unwrap();
    let filed = two_seconds(Renderer::new(&scene, &plan).unwrap());
    assert!(filed.iter().any(|x| *x != 0.0));

    // The device of a scene is ignored, even a display.
    for name in ["two-swatches.scene.json", "electrovibration.scene.json"] {
        let scene = Scene::open(example(name)).unwrap();
        let samples = two_seconds(scene.renderer(RATE_HZ).unwrap());
        assert!(samples.iter().any(|x| *x != 0.0), "{name}");
        assert!(name != "two-swatches.scene.json" || samples == filed);
        let refused = scene.renderer(50.0).err().unwrap();
        assert_eq!(refused.kind(), SceneErrorKind::InvalidScene, "{refused}");
    }
    let missing = Scene::open(example("none.scene.json")).unwrap_err();
    assert_eq!(missing.kind(), SceneErrorKind::Io, "{missing}");
}
