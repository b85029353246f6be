//! Third-party texture formats.

use htex_exchange::Naming;
use htex_exchange::haptic::Metadata;
use htex_exchange::hatt::{asset, read};
use htex_exchange::{
    Ahap, Export, Format, Haptic, Hjif, Import, MOST_S, PROFILES, Pattern, Physical, combined,
    export, import, recording_of,
};

use crate::promise::sentence;

/// Reads a model file of the Penn Haptic Texture Toolkit. If it is valid, it must become an asset
/// that opens and has finite magnitudes at each node.
pub fn hatt(input: &[u8]) -> bool {
    let imported = Naming { name: "fuzzed", tool: "fuzz" };
    let texture = match read(input) {
        Ok(texture) => texture,
        Err(fault) => return refused(&fault),
    };
    let made = match asset(&texture, &imported) {
        Ok(made) => made,
        Err(fault) => return refused(&fault),
    };
    let bytes = match made.to_bytes() {
        Ok(bytes) => bytes,
        Err(error) => return refused(&error),
    };
    let asset = htex::Texture::from_bytes(&bytes).expect("what was written opens");
    let representation = asset.representation(None).expect("it has one");
    let grid = asset.band().grid_hz();
    for node in &texture.nodes {
        let motion = htex::Motion::new(node.speed_mm_s, node.force_n);
        let magnitude = representation.recorded_magnitude(Some(motion), &grid);
        if let Ok(magnitude) = magnitude {
            assert!(magnitude.iter().all(|m| m.is_finite() && *m >= 0.0));
        }
    }
    true
}

/// Full scale of imported files.
const FULL_SCALE: f64 = 0.25;

/// Reads a Meta file. If it is valid, it must be a recording within its full scale, and be the same
/// after it is written and read again.
pub fn haptic(input: &[u8]) -> bool {
    let read = Haptic::from_bytes(input);
    if let Ok(file) = &read {
        let pattern = file.pattern(&PROFILES[0]);
        let metadata = Metadata::default();
        let again = Haptic::from_pattern(&pattern, &PROFILES[0], metadata).to_bytes();
        let again = Haptic::from_bytes(&again).expect("what was written is read");
        same_end(&pattern, &again.pattern(&PROFILES[0]));
    }
    recorded("fuzzed.haptic", input, read.is_ok())
}

/// Reads an Apple file, as [`haptic`].
pub fn ahap(input: &[u8]) -> bool {
    let read = Ahap::from_bytes(input);
    if let Ok(file) = &read {
        let patterns = file.patterns(&PROFILES[0]);
        // Combining patterns compares each one with all others, so a long file is not read again.
        let is_short = patterns.iter().all(|pattern| pattern.end_s() <= MOST_S);
        if patterns.len() < 100 && is_short {
            let pattern = combined(&patterns);
            let again = Ahap::from_pattern(&pattern, &PROFILES[0]).to_bytes();
            let again = Ahap::from_bytes(&again).expect("what was written is read");
            same_end(&pattern, &combined(&again.patterns(&PROFILES[0])));
        }
    }
    recorded("fuzzed.ahap", input, read.is_ok())
}

/// Reads an MPEG file, as [`haptic`].
pub fn hjif(input: &[u8]) -> bool {
    let read = Hjif::from_bytes(input);
    if let Ok(file) = &read {
        let again = Hjif::from_bytes(&file.to_bytes()).expect("what was written is read");
        assert_eq!(again.left_out(), file.left_out());
    }
    recorded("fuzzed.hjif", input, read.is_ok())
}

/// Reads a glTF file. If it carries an asset, writing and reading it again must give the same
/// bytes.
pub fn gltf(input: &[u8]) -> bool {
    let read = htex_exchange::gltf::read(input);
    if let Ok(texture) = &read {
        assert!(texture.bytes.len() <= input.len(), "bytes from nowhere");
    }
    let registry = htex::Registry::builtin();
    let imported = match import("fuzzed.glb", input, &Import::default(), &registry) {
        Ok(imported) => imported,
        Err(error) => return refused(&error),
    };
    let bytes = imported.to_bytes().expect("it is held");
    assert_eq!(read.ok().map(|texture| texture.bytes).as_ref(), Some(&bytes));
    let format = Format::find("gltf").expect("it is in the table");
    let mut how = Export::new(format);
    how.file = Some(&bytes);
    let asset = htex::Texture::with_registry(imported.asset, registry);
    let again = match export(&asset, &how) {
        Ok(exported) => exported.bytes,
        Err(error) => return refused(&error),
    };
    let again = htex_exchange::gltf::read(&again).expect("what was written is read");
    assert_eq!(again.bytes, bytes);
    true
}

/// Reads an image of a friction map. If it is valid, it has at most 255 by 255 pixels, is unchanged
/// pixel by pixel after it is written and read again, and plays within bounds.
pub fn png(input: &[u8]) -> bool {
    let image = match htex_exchange::map::read(input) {
        Ok(image) => image,
        Err(fault) => return refused(&fault),
    };
    let (width, rows) = (image.width, image.grey.len() / image.width);
    assert!((1..=255).contains(&width) && (1..=255).contains(&rows));
    assert_eq!(image.grey.len(), width * rows);
    let how = Import {
        name: "fuzzed",
        physical: Physical {
            full_scale: Some(FULL_SCALE),
            speed_mm_s: Some(80.0),
            force_n: Some(0.4),
            pitch_mm: Some(image.pitch_mm.unwrap_or(0.1)),
            ..Physical::default()
        },
        ..Import::default()
    };
    let imported = match import("fuzzed.png", input, &how, &htex::Registry::builtin()) {
        Ok(imported) => imported,
        Err(error) => return refused(&error),
    };
    let bytes = imported.to_bytes().expect("an asset is written");
    let asset = htex::Texture::from_bytes(&bytes).expect("what was written opens");
    let format = Format::find("png").expect("it is in the table");
    let again = export(&asset, &Export::new(format)).expect("a map is exported");
    let again = htex_exchange::map::read(&again.bytes).expect("what was written is read");
    assert_eq!((again.width, again.grey), (image.width, image.grey));
    let mut voice = asset.voice(&htex::VoiceOptions::default()).expect("a map is played");
    let mut samples = [0.0; 500];
    for step in 0..4 {
        let motion =
            htex::Motion::new(80.0, 0.4).with_place_mm([f64::from(step), 0.7 * f64::from(step)]);
        voice.set_motion(motion).expect("a motion in range");
        voice.render(&mut samples).expect("a map is rendered");
        // The cubic interpolation and the filters at the band's edges overshoot.
        assert!(samples.iter().all(|x| f64::from(x.abs()) <= 4.0 * FULL_SCALE));
    }
    true
}

fn same_end(before: &Pattern, after: &Pattern) {
    if before.to_s > before.from_s {
        assert!((before.to_s - after.to_s).abs() < 1e-6, "{before:?} {after:?}");
    }
}

/// Reads a file as a recording. If `is_read` is false, no reader may accept it.
fn recorded(name: &str, input: &[u8], is_read: bool) -> bool {
    let physical = Physical {
        full_scale: Some(FULL_SCALE),
        speed_mm_s: Some(80.0),
        force_n: Some(0.4),
        ..Physical::default()
    };
    match recording_of(name, input, &physical, None) {
        Ok(recording) => {
            assert!(is_read, "{name} is read and is not");
            let samples = recording.axes.iter().flatten();
            assert!(samples.into_iter().all(|x| x.abs() <= FULL_SCALE));
            for warning in &recording.warnings {
                sentence(warning);
            }
            true
        }
        Err(error) => refused(&error),
    }
}

fn refused(error: &impl std::fmt::Display) -> bool {
    sentence(error);
    false
}
