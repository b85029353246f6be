//! Default names of output files.

use std::path::Path;

/// Maximum length of a file extension, characters.
const LONGEST_ENDING: usize = 8;

/// Returns the default output file of a scene or an asset: its name with the extension of the
/// format. The extension is `wav` if the format is `auto` or not a plain word. The result is always
/// a plain file name, so the file is in the current folder. The name never begins with a dot, so
/// the file is not hidden.
///
/// ```
/// # use htex_scene::output_name;
/// assert_eq!(output_name("swatches/.two.scene.json".as_ref(), "csv"), "two.csv");
/// assert_eq!(output_name("..".as_ref(), "../x"), "scene.wav");
/// ```
pub fn output_name(scene: &Path, format: &str) -> String {
    file_name(&stem(scene), format)
}

/// Returns the file name of the scene or asset in `path` without its extension. The result is never
/// a hidden file's name.
pub(crate) fn stem(path: &Path) -> String {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let stem =
        [".scene.json", ".json", ".htex"].iter().find_map(|ending| name.strip_suffix(ending));
    match stem.unwrap_or(&name).trim_start_matches('.') {
        "" => "scene".to_owned(),
        // Path separators of other systems.
        stem => stem.replace('\\', "_"),
    }
}

/// Adds the extension of a format to a stem.
pub(crate) fn file_name(stem: &str, format: &str) -> String {
    let is_word = |text: &str| text.bytes().all(|byte| byte.is_ascii_alphanumeric());
    let ending = match format {
        "" | "auto" => "wav",
        word if is_word(word) && word.len() <= LONGEST_ENDING => word,
        _ => "wav",
    };
    format!("{stem}.{ending}")
}
