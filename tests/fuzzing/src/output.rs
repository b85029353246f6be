//! Names of scenes and formats, which determine the name of the output file.

use std::path::{Component, Path, PathBuf};

use htex_scene::{DeviceOverride, Scene};
use serde_json::json;

use crate::scene::{around, folder};

/// The output file of a scene with this name and format must lie in the current folder, whether the
/// caller or the scene chooses the format. The format follows a line feed. The first byte chooses
/// whether the scene is rehearsed.
pub fn output_name(input: &[u8]) -> bool {
    let Some((&first, rest)) = input.split_first() else {
        return false;
    };
    let mut parts = rest.splitn(2, |byte| *byte == b'\n');
    let scene = path(parts.next().unwrap_or_default());
    let format = String::from_utf8_lossy(parts.next().unwrap_or_default());
    is_here(&htex_scene::output_name(&scene, &format), &format);
    let device = DeviceOverride { rehearsal: first % 2 == 1, ..DeviceOverride::default() };
    let json = json!({
        "htex_scene": "1.0",
        "surfaces": [{ "asset": "vinyl.htex" }],
        "motion": { "constant": { "speed_mm_s": 80, "force_n": 0.4 } },
        "device": { "settings": { "format": format } },
    });
    let place = folder().join(scene.file_name().unwrap_or("x".as_ref()));
    match Scene::from_bytes(&place, json.to_string().as_bytes(), &around(), &device) {
        Ok(loaded) => is_here(loaded.settings.text("path"), &format),
        Err(error) => crate::promise::sentence(&error),
    }
    !rest.is_empty()
}

/// Asserts that it is a single name in the current folder, is not hidden, and has an extension: the
/// format's, if the format is a plain word.
fn is_here(name: &str, format: &str) {
    let parts: Vec<Component<'_>> = Path::new(name).components().collect();
    assert_eq!(parts, [Component::Normal(name.as_ref())], "{name:?}");
    assert!(!name.starts_with('.') && !name.contains(['/', '\\']), "{name:?}");
    let (stem, ending) = name.rsplit_once('.').expect("an ending");
    assert!(!stem.is_empty() && !ending.is_empty(), "{name:?}");
    let is_plain = ending.bytes().all(|byte| byte.is_ascii_alphanumeric());
    assert!(is_plain && ending.len() <= 8, "{name:?}");
    let known = ["wav", "csv", "npy", "raw"];
    assert!(!known.contains(&format) || ending == format, "{name:?} in {format}");
}

#[cfg(unix)]
fn path(bytes: &[u8]) -> PathBuf {
    use std::os::unix::ffi::OsStrExt;
    std::ffi::OsStr::from_bytes(bytes).into()
}

#[cfg(not(unix))]
fn path(bytes: &[u8]) -> PathBuf {
    String::from_utf8_lossy(bytes).into_owned().into()
}
