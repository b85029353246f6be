//! A texture in a library plays exactly as it does from its own file.

use htex::library::Library;
use htex::library::Writer;
use htex::{Error, Texture, VoiceOptions};

const VINYL: &[u8] = include_bytes!("../../../../../examples/scenes/vinyl.htex");

fn samples(asset: &Texture) -> [f32; 256] {
    let mut block = [0.0; 256];
    let mut voice = asset.voice(&VoiceOptions::default()).unwrap();
    voice.render(&mut block).unwrap();
    block
}

#[test]
fn a_texture_of_a_library_plays_as_its_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.htexlib");
    let mut writer = Writer::create(&path, "A").unwrap();
    writer.add("floor/vinyl", VINYL).unwrap();
    writer.finish().unwrap();
    let library = Library::open(&path).unwrap();
    let asset = Texture::from_library(&library, "floor/vinyl").unwrap();
    assert_eq!(samples(&asset), samples(&Texture::from_bytes(VINYL).unwrap()));
    let absent = Texture::from_library(&library, "vinyl").unwrap_err();
    assert!(matches!(&absent, Error::Library(_)), "{absent}");
}
