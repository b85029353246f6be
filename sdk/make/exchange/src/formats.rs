//! The table of all formats. Commands, help texts, messages and documents use this table.

use crate::error::{ExchangeError, list, unknown_name};
use crate::format::{Format, Reads, Writes};
use crate::{ahap, gltf, haptic, hatt, hjif, rights, writers};

/// All formats.
pub const FORMATS: &[Format] = &[
    Format {
        name: "hatt",
        title: "Penn Haptic Texture Toolkit, XML",
        extensions: &["xml"],
        reads: Some(Reads::Asset(hatt::import)),
        writes: None,
        rights: rights::BESIDE,
        keeps: "the filter of each node, speed and force, the unit, triangles, friction",
        loses: "nothing that is played; between nodes levels are mixed, not variances",
    },
    Format {
        name: "haptic",
        title: "Meta .haptic, version 1",
        extensions: &["haptic"],
        reads: Some(Reads::Positions { read: haptic::signal, profile: "quest" }),
        writes: Some(Writes::Signal { write: writers::haptic, profile: "quest", settings: &[] }),
        rights: rights::HAPTIC,
        keeps: "level and one frequency over time",
        loses: "the spectrum, speed and force, the unit; frequencies are positions in an actuator's range",
    },
    Format {
        name: "ahap",
        title: "Apple .ahap, version 1",
        extensions: &["ahap"],
        reads: Some(Reads::Positions { read: ahap::signal, profile: "iphone" }),
        writes: Some(Writes::Signal { write: writers::ahap, profile: "iphone", settings: &[] }),
        rights: rights::AHAP,
        keeps: "level and one sharpness over time",
        loses: "the spectrum, speed and force, the unit; how sharp a sharpness is",
    },
    Format {
        name: "android",
        title: "Android VibrationEffect, as JSON or Kotlin",
        extensions: &["json", "kt"],
        reads: None,
        writes: Some(Writes::Signal { write: writers::android, profile: "android", settings: &[] }),
        rights: rights::ANDROID,
        keeps: "level and one frequency over time, in as many points as the device takes",
        loses: "the spectrum, speed and force, the unit; what changes faster than the points",
    },
    Format {
        name: "hjif",
        title: "MPEG .hjif, ISO/IEC 23090-31",
        extensions: &["hjif"],
        reads: Some(Reads::Signal(hjif::signal)),
        writes: Some(Writes::Signal {
            write: writers::hjif,
            profile: "quest",
            settings: &["coding"],
        }),
        rights: rights::HJIF,
        keeps: "seven tones over way or time (vectorial), or the samples (wavelet)",
        loses: "how the spectrum follows speed and force, the unit; with tones what lies between them",
    },
    Format {
        name: "wav",
        title: "WAV that drives an actuator",
        extensions: &["wav"],
        reads: None,
        writes: Some(Writes::Signal {
            write: writers::wav,
            profile: "console",
            settings: &["rate"],
        }),
        rights: rights::WAV,
        keeps: "the samples, as far as the actuator plays them",
        loses: "speed and force, the unit; what is outside the actuator's range",
    },
    Format {
        name: "png",
        title: "friction map, 8-bit PNG",
        extensions: &["png"],
        reads: Some(Reads::Map),
        writes: Some(Writes::Map),
        rights: rights::PNG,
        keeps: "the friction at each place, 255 x 255 pixels at most, and their distance",
        loses: "speed and force, the unit; of a texture that is no map all but its spectrum at one speed",
    },
    Format {
        name: "gltf",
        title: "glTF 2.0 with the extension HTEX_texture",
        extensions: &["glb", "gltf"],
        reads: Some(Reads::Asset(gltf::import)),
        writes: Some(Writes::Asset(gltf::export)),
        rights: rights::GLTF,
        keeps: "the asset's file, bit for bit, on the material of a mesh",
        loses: "nothing of a texture; of a file that comes in, the meshes",
    },
];

impl Format {
    /// Finds a format by its name.
    #[must_use]
    pub fn find(name: &str) -> Option<&'static Self> {
        FORMATS.iter().find(|format| format.name == name)
    }

    /// Finds a format by its name, for an export.
    ///
    /// # Errors
    /// Returns an error if no format has the name. The error lists the formats that can be
    /// exported.
    pub fn find_for_export(name: &str) -> Result<&'static Self, ExchangeError> {
        Self::find(name).ok_or_else(|| unknown_name("format", name, exported()))
    }

    /// Finds the format with which a file is imported, by the file's extension.
    ///
    /// # Errors
    /// Returns an error if no format that can be imported has this extension. The error lists the
    /// formats that can be imported.
    pub fn of_file(file: &str) -> Result<&'static Self, ExchangeError> {
        let extension =
            file.rsplit_once('.').map_or("", |(_, extension)| extension).to_ascii_lowercase();
        let has =
            |format: &&Self| format.reads.is_some() && format.extensions.contains(&&extension[..]);
        FORMATS.iter().find(has).ok_or_else(|| ExchangeError::UnknownFormat {
            file: file.to_owned(),
            there: imported(),
        })
    }
}

/// Returns the extensions that can be imported, as a text such as `.haptic, .ahap and .hjif`.
#[must_use]
pub fn imported() -> String {
    extensions_of(|reads| reads.is_some())
}

/// Returns the extensions of the formats that are imported as signals, as a text.
#[must_use]
pub fn imported_signals() -> String {
    extensions_of(|reads| matches!(reads, Some(Reads::Positions { .. } | Reads::Signal(_))))
}

fn extensions_of(is_it: fn(Option<&Reads>) -> bool) -> String {
    let found = FORMATS.iter().filter(|f| is_it(f.reads.as_ref()));
    list(found.flat_map(|format| format.extensions.iter().map(|e| format!(".{e}"))))
}

/// Returns the names of the formats that can be exported.
#[must_use]
pub fn exported() -> Vec<&'static str> {
    let written = FORMATS.iter().filter(|format| format.writes.is_some());
    written.map(|format| format.name).collect()
}

/// Returns a Markdown table of the formats, for documents.
#[must_use]
pub fn formats_table() -> String {
    let mut text = String::from(
        "| name | format | files | in | out | licence and author | keeps | loses |\n|---|---|---|---|---|---|---|---|\n",
    );
    for f in FORMATS {
        let comes_in = match &f.reads {
            Some(Reads::Asset(_) | Reads::Map) => "as an asset",
            Some(_) => "to be fitted",
            None => "",
        };
        let goes_out = match &f.writes {
            Some(Writes::Asset(_)) => "the asset",
            Some(Writes::Signal { .. }) => "what is played",
            Some(Writes::Map) => "its pixels, or one row",
            None => "",
        };
        text += &format!(
            "| `{}` | {} | {} | {comes_in} | {goes_out} | {} | {} | {} |\n",
            f.name,
            f.title,
            f.dotted(),
            f.rights.place,
            f.keeps,
            f.loses
        );
    }
    text
}
