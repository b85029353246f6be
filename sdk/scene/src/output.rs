//! What a file is called that a scene goes to when nobody names one.

use std::path::Path;

/// Longest ending of a file's name, characters.
const LONGEST_ENDING: usize = 8;

/// The file in the current folder that a scene, or an asset, goes to when nobody names one: its own name with the ending
/// of the format, which is `wav` where that is `auto` or no plain word. Whatever both hold, this is one name in
/// the current folder, and no hidden file's.
///
/// ```
/// # use htex_scene::output_name;
/// assert_eq!(output_name("swatches/.two.scene.json".as_ref(), "csv"), "two.csv");
/// assert_eq!(output_name("..".as_ref(), "../x"), "scene.wav");
/// ```
pub fn output_name(scene: &Path, format: &str) -> String {
    named(&stem(scene), format)
}

/// The name of the scene or asset in `path` without its ending; no hidden file's, whatever it is called.
pub(crate) fn stem(path: &Path) -> String {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let stem = [".scene.json", ".json", ".htex"]
        .iter()
        .find_map(|ending| name.strip_suffix(ending));
    match stem.unwrap_or(&name).trim_start_matches('.') {
        "" => "scene".to_owned(),
        // A separator elsewhere.
        stem => stem.replace('\\', "_"),
    }
}

/// A stem with the ending of a format.
pub(crate) fn named(stem: &str, format: &str) -> String {
    let is_word = |text: &str| text.bytes().all(|byte| byte.is_ascii_alphanumeric());
    let ending = match format {
        "" | "auto" => "wav",
        word if is_word(word) && word.len() <= LONGEST_ENDING => word,
        _ => "wav",
    };
    format!("{stem}.{ending}")
}
