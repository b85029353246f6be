//! A player without the sandbox can play an asset with an embedded module: it plays the
//! representations of built-in models.

use htex::author::simulate::{SimulationOptions, Surface, simulate};
use htex::author::{AssetRequest, Exploration, ModelRequest, Take, fit_asset};
use htex::format::{Asset, Measure, Plugin};
use htex::{Error, Registry, Texture, VoiceOptions};

/// An id that no built-in model has.
const ELSEWHERE: &str = "org.example.elsewhere";

/// An asset with an AR and an sBeta representation. The first one gets the id [`ELSEWHERE`], the
/// smallest error, and an embedded module.
fn asset() -> Asset {
    let options = SimulationOptions::new(Surface::Sandpaper).with_duration_s(3.0);
    let take = Take {
        recording: simulate(&options).unwrap().to_recording("simulated").unwrap(),
        given: Exploration { speed_mm_s: Some(80.0), force_n: Some(0.4) },
    };
    let registry = Registry::builtin();
    let model = |name: &str| ModelRequest::new(registry.find(name).unwrap());
    let request = AssetRequest::new("simulated").with_models([model("ar"), model("sbeta")]);
    let mut asset = fit_asset(&[take], &request).unwrap().asset;
    let brought = &mut asset.manifest.representations[0];
    let version = brought.model_version.clone();
    brought.model = ELSEWHERE.to_owned();
    let quality = brought.at[0].quality.as_mut().unwrap();
    *quality.by_magnitude.get_mut(Measure::NineBand) = Some(0.0);
    asset.manifest.plugins.push(Plugin {
        model: ELSEWHERE.to_owned(),
        version,
        file: format!("plugins/{ELSEWHERE}.wasm"),
        blake3: "0".repeat(64),
        signature: None,
    });
    asset.plugins.push(b"\0asm\x01\0\0\0".to_vec());
    asset
}

#[test]
fn other_representations_play() {
    let asset = Texture::new(asset()).with_embedded();
    assert_eq!(asset.representation(None).unwrap().id(), "org.htex.sbeta");
    let mut voice = asset.voice(&VoiceOptions::default()).unwrap();
    let mut block = [0.0f32; 256];
    voice.render(&mut block).unwrap();
    assert!(block.iter().any(|x| *x != 0.0));

    let elsewhere = asset.representation(ELSEWHERE).unwrap();
    let Err(Error::Model(error)) = elsewhere.voice(&VoiceOptions::default()) else {
        panic!("a module ran without a sandbox");
    };
    assert!(error.to_string().contains("wasm"), "{error}");
}
