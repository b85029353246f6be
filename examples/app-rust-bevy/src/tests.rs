//! Compares the samples of entities with the samples of voices.

use std::path::{Path, PathBuf};

use bevy_asset::AssetServer;
use htex::library::Writer;
use htex::{Motion, Texture, VoiceOptions};

use super::haptics::{BLOCK, Block, Playing, Slide, Surface};
use super::*;

const SLIDE: Slide = Slide { speed_mm_s: 90.0, force_n: 0.5 };

fn scenes() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes")
}

/// Runs an app with one entity per asset, and returns the first 20 blocks after all are loaded.
fn play(folder: &Path, assets: &[&str]) -> Vec<f32> {
    let mut app = app(folder.to_str().unwrap());
    let server = app.world().resource::<AssetServer>().clone();
    let handles: Vec<_> = assets.iter().map(|asset| server.load(asset.to_string())).collect();
    for _ in 0..10_000 {
        if handles.iter().all(|handle| server.is_loaded(handle)) {
            break;
        }
        app.update();
        std::thread::sleep(Duration::from_millis(1));
    }
    app.world_mut().spawn_batch(handles.into_iter().map(|handle| (Surface(handle), SLIDE)));
    let mut samples = Vec::new();
    for _ in 0..20 {
        app.update();
        samples.extend(app.world().resource::<Block>().0);
    }
    assert_eq!(app.world_mut().query::<&Playing>().iter(app.world()).count(), assets.len());
    samples
}

/// Returns the same samples without Bevy.
fn expected(textures: &[&str]) -> Vec<f32> {
    let mut samples = vec![0.0; 20 * BLOCK];
    for name in textures {
        let texture = Texture::open(scenes().join(name)).unwrap();
        let options = VoiceOptions::default()
            .with_rate_hz(48_000.0)
            .with_gain(0.1 / texture.level_rms(None).unwrap())
            .with_limit(0.9);
        let mut voice = texture.voice(&options).unwrap();
        voice.set_motion(Motion::new(SLIDE.speed_mm_s, SLIDE.force_n)).unwrap();
        voice.render_add(&mut samples, 1.0).unwrap();
    }
    samples
}

fn assert_equal_bits(a: &[f32], b: &[f32]) {
    assert!(a.iter().map(|x| x.to_bits()).eq(b.iter().map(|x| x.to_bits())));
    assert!(a.iter().any(|sample| sample.abs() > 0.1));
}

#[test]
fn entities_play_the_samples_of_their_textures() {
    let names = ["vinyl.htex", "coarse-fabric.htex"];
    assert_equal_bits(&play(&scenes(), &names), &expected(&names));
}

#[test]
fn an_entity_plays_a_texture_of_a_library() {
    let folder = tempfile::tempdir().unwrap();
    let mut writer = Writer::create(&folder.path().join("scenes.htexlib"), "Scenes").unwrap();
    for (name, file) in [("hard/vinyl", "vinyl.htex"), ("soft/fabric", "coarse-fabric.htex")] {
        writer.add(name, &std::fs::read(scenes().join(file)).unwrap()).unwrap();
    }
    writer.finish().unwrap();
    let samples = play(folder.path(), &["scenes.htexlib#soft/fabric"]);
    assert_equal_bits(&samples, &expected(&["coarse-fabric.htex"]));
}

/// An entity that gets another texture gets another voice, and an entity without a texture is
/// silent.
#[test]
fn a_voice_goes_with_its_texture() {
    let folder = scenes();
    let mut app = app(folder.to_str().unwrap());
    let server = app.world().resource::<AssetServer>().clone();
    let [vinyl, fabric] = ["vinyl.htex", "coarse-fabric.htex"].map(|name| server.load(name));
    while !(server.is_loaded(&vinyl) && server.is_loaded(&fabric)) {
        app.update();
    }
    let entity = app.world_mut().spawn((Surface(vinyl), SLIDE)).id();
    app.update();
    app.world_mut().entity_mut(entity).insert(Surface(fabric));
    app.update();
    assert_equal_bits(
        &app.world().resource::<Block>().0,
        &expected(&["coarse-fabric.htex"])[..BLOCK],
    );
    app.world_mut().entity_mut(entity).remove::<Surface>();
    app.update();
    assert!(!app.world().entity(entity).contains::<Playing>());
    assert_eq!(app.world().resource::<Block>().0, [0.0; BLOCK]);
}
