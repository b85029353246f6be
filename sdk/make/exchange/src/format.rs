//! Describes file formats: how files of a format are imported and exported, and which settings
//! these imports and exports accept.

use serde::Serialize;

use crate::error::{ExchangeError, Fault, in_file};
use crate::export::Export;
use crate::import::ImportedAsset;
use crate::job::{Job, WrittenSignal};
use crate::profile::Profile;
use crate::rights::RightsPlace;

/// Sample rate of imported signals, hertz. Envelopes, and the losses of an export, are measured at
/// the same rate.
pub const RATE_HZ: f64 = 8_000.0;

/// A file format that can be imported, exported or both.
#[derive(Debug)]
#[non_exhaustive]
pub struct Format {
    /// The name of the format, as used by the flag `--to`.
    pub name: &'static str,
    /// A short description of the format.
    pub title: &'static str,
    /// File extensions, in lower case.
    pub extensions: &'static [&'static str],
    /// How files are imported; `None` if the format cannot be imported.
    pub reads: Option<Reads>,
    /// How assets are exported; `None` if the format cannot be exported.
    pub writes: Option<Writes>,
    /// Where the format's files store the licence and the author.
    pub rights: RightsPlace,
    /// Text that says which parts of a texture the format stores.
    pub keeps: &'static str,
    /// Text that says which parts of a texture the format loses.
    pub loses: &'static str,
}

/// How files of a format are imported.
#[derive(Debug, Clone, Copy)]
pub enum Reads {
    /// The file is read as a signal between -1 and 1, to which models are fitted. The file gives
    /// frequencies as positions in an actuator's range. `profile` names the default actuator; the
    /// user may choose another actuator.
    Positions { read: ReadPositions, profile: &'static str },
    /// The file is read as a signal between -1 and 1, to which models are fitted. The file gives
    /// frequencies in hertz, or in waves per metre.
    Signal(ReadSignal),
    /// The file is converted to an asset without a fit, because it contains units, speeds and
    /// forces.
    Asset(ReadAsset),
    /// The file is an image of grey values over a surface. The image is converted to an asset
    /// without a fit.
    Map,
}

/// A function that reads a signal from a file whose frequencies are given as positions in an
/// actuator's range.
pub type ReadPositions = fn(&[u8], Sampling, &Profile) -> Result<Signal, Fault>;
/// The function that reads a signal.
pub type ReadSignal = fn(&[u8], Sampling) -> Result<Signal, Fault>;
type ReadAsset = fn(&[u8], &Naming<'_>) -> Result<ImportedAsset, Fault>;

/// How assets are exported to a format.
#[derive(Debug, Clone, Copy)]
pub enum Writes {
    /// The file stores the vibration that the asset plays during a motion, reduced to what an
    /// actuator can play.
    Signal {
        write: WriteSignal,
        /// The profile that is used unless the user chooses another.
        profile: &'static str,
        /// Settings that this format accepts in addition to the settings of all signals.
        settings: &'static [&'static str],
    },
    /// The file stores the asset itself, without loss.
    Asset(WriteAsset),
    /// The file is an image of grey values over a surface.
    Map,
}

/// A function that writes a vibration as a file of a format. An asset or a scene has played this
/// vibration.
pub type WriteSignal = fn(&Job<'_>) -> Result<WrittenSignal, ExchangeError>;
type WriteAsset = fn(&htex_play::Texture, &Export<'_>) -> Result<Vec<u8>, ExchangeError>;

/// How a file is sampled when it is read as a signal.
#[derive(Debug, Clone, Copy)]
pub struct Sampling {
    /// Sample rate, hertz.
    pub rate_hz: f64,
    /// Speed of the finger, mm/s. The speed is used only for files whose positions are distances
    /// and not times.
    pub speed_mm_s: f64,
}

/// A signal whose samples lie between -1 and 1.
#[derive(Debug, Clone, PartialEq)]
pub struct Signal {
    pub samples: Vec<f64>,
    /// What the reader ignored in the file, as a list of sentences.
    pub left_out: Vec<String>,
}

/// Names that an imported asset needs in addition to the contents of the file.
#[derive(Debug, Clone, Copy, Default)]
pub struct Naming<'a> {
    /// Name of the texture, used if the file contains no name.
    pub name: &'a str,
    /// Program and version, stored in the provenance.
    pub tool: &'a str,
}

/// Settings of imports that fit models to a signal.
const FITTED: &[&str] = &[
    "full_scale",
    "quantity",
    "speed",
    "force",
    "model",
    "option",
    "level",
    "keep_reference",
    "storage",
];
/// Settings of image imports.
const IMAGED: &[&str] = &["full_scale", "quantity", "speed", "force", "pitch"];
/// Settings of image exports.
const PRINTED: &[&str] = &["model", "speed", "force"];
/// Settings of exports that store what an asset plays.
const PLAYED: &[&str] = &["model", "speed", "force", "seconds", "stroke", "profile", "seed"];

/// The setting of [`PLAYED`] that names a stroke.
const STROKE: &str = "stroke";
/// Settings in [`PLAYED`] that a stroke determines when a texture is exported along it.
const OF_STROKES: &[&str] = &["speed", "force", "seconds"];
/// Settings in [`PLAYED`] that a scene determines when it is exported.
const OF_SCENES: &[&str] = &["model", "speed", "force", "stroke", "seed"];

impl Reads {
    /// Returns the keywords of the settings that the import accepts, without the keywords of
    /// metadata.
    #[must_use]
    pub fn settings(&self) -> Vec<&'static str> {
        match self {
            Self::Positions { .. } => [FITTED, &["profile"]].concat(),
            Self::Signal(_) => FITTED.to_vec(),
            Self::Asset(_) => Vec::new(),
            Self::Map => IMAGED.to_vec(),
        }
    }

    const fn kind(&self) -> &'static str {
        match self {
            Self::Positions { .. } | Self::Signal(_) => "signal",
            Self::Asset(_) | Self::Map => "asset",
        }
    }
}

impl Writes {
    /// Returns the keywords of the settings that the export accepts.
    #[must_use]
    pub fn settings(&self) -> Vec<&'static str> {
        match self {
            Self::Signal { settings, .. } => [PLAYED, *settings].concat(),
            Self::Asset(_) => Vec::new(),
            Self::Map => PRINTED.to_vec(),
        }
    }

    const fn kind(&self) -> &'static str {
        match self {
            Self::Signal { .. } => "signal",
            Self::Asset(_) => "asset",
            Self::Map => "image",
        }
    }
}

impl Format {
    /// Checks that an import accepts the given settings, which are keywords such as `full_scale`.
    ///
    /// # Errors
    /// Returns an error if a setting does not apply; the error names the first such setting.
    ///
    /// ```
    /// use htex_exchange::Format;
    /// let hatt = Format::of_file("cork.xml")?;
    /// assert!(hatt.check_import(["full_scale"]).unwrap_err().to_string().contains("takes no `full_scale`"));
    /// # Ok::<(), htex_exchange::ExchangeError>(())
    /// ```
    pub fn check_import<'a>(
        &self,
        given: impl IntoIterator<Item = &'a str>,
    ) -> Result<(), ExchangeError> {
        let takes = self.reads.as_ref().map(Reads::settings);
        self.check("import", takes.unwrap_or_default(), given)
    }

    /// Checks that an export accepts the given settings, which are keywords such as `full_scale`.
    /// If the export follows a stroke, settings of motion and duration do not apply, because the
    /// stroke determines both.
    ///
    /// # Errors
    /// Returns an error if a setting does not apply; the error names the first such setting.
    pub fn check_export<'a>(
        &self,
        given: impl IntoIterator<Item = &'a str>,
    ) -> Result<(), ExchangeError> {
        let given = Vec::from_iter(given);
        let mut takes = self.writes.as_ref().map(Writes::settings).unwrap_or_default();
        if takes.contains(&STROKE) && given.contains(&STROKE) {
            takes.retain(|setting| !OF_STROKES.contains(setting));
            return self.check("export along a stroke", takes, given);
        }
        self.check("export", takes, given)
    }

    /// Checks that an export of a scene accepts the given settings. The scene determines models,
    /// motion and seed, so settings for these do not apply.
    ///
    /// # Errors
    /// Returns an error if a setting does not apply; the error names the first such setting.
    pub fn check_export_of_scene<'a>(
        &self,
        given: impl IntoIterator<Item = &'a str>,
    ) -> Result<(), ExchangeError> {
        let mut takes = self.writes.as_ref().map(Writes::settings).unwrap_or_default();
        takes.retain(|setting| !OF_SCENES.contains(setting));
        self.check("export of a scene", takes, given)
    }

    /// Reads a file as a signal. `file` is its name.
    pub(crate) fn signal(
        &self,
        file: &str,
        bytes: &[u8],
        speed_mm_s: f64,
        given: Option<&Profile>,
    ) -> Result<Signal, ExchangeError> {
        let sampling = Sampling { rate_hz: RATE_HZ, speed_mm_s };
        let read = match self.reads {
            Some(Reads::Positions { read, profile }) => {
                let profile = given.map_or_else(|| Profile::find(profile), Ok)?;
                read(bytes, sampling, profile)
            }
            Some(Reads::Signal(read)) => read(bytes, sampling),
            Some(Reads::Asset(_) | Reads::Map) | None => {
                return Err(self.cannot("its files are no signals"));
            }
        };
        read.map_err(in_file(file))
    }

    /// Makes an error that states why the format cannot store a texture.
    pub(crate) fn cannot(&self, problem: impl Into<String>) -> ExchangeError {
        ExchangeError::Cannot { format: self.name, problem: problem.into() }
    }

    fn check<'a>(
        &self,
        way: &'static str,
        takes: Vec<&'static str>,
        given: impl IntoIterator<Item = &'a str>,
    ) -> Result<(), ExchangeError> {
        match given.into_iter().find(|setting| !takes.contains(setting)) {
            None => Ok(()),
            Some(setting) => Err(ExchangeError::Unused {
                format: self.title,
                way,
                setting: setting.to_owned(),
                takes,
            }),
        }
    }

    /// Returns the format's extensions as a text, each with a leading dot.
    #[must_use]
    pub fn dotted(&self) -> String {
        let dotted: Vec<String> = self.extensions.iter().map(|e| format!(".{e}")).collect();
        dotted.join(", ")
    }
}

/// The JSON that `htex formats --json` prints for a format.
#[derive(Serialize)]
struct FormatDescription<'a> {
    name: &'a str,
    title: &'a str,
    extensions: &'a [&'a str],
    /// How the format is imported: `signal` or `asset`. For exports, also `image`.
    import: Option<&'a str>,
    import_settings: Vec<&'a str>,
    export: Option<&'a str>,
    export_settings: Vec<&'a str>,
    /// Where the format's files store the licence and the author.
    rights: &'a str,
    keeps: &'a str,
    loses: &'a str,
}

impl Serialize for Format {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let description = FormatDescription {
            name: self.name,
            title: self.title,
            extensions: self.extensions,
            import: self.reads.as_ref().map(Reads::kind),
            import_settings: self.reads.as_ref().map(Reads::settings).unwrap_or_default(),
            export: self.writes.as_ref().map(Writes::kind),
            export_settings: self.writes.as_ref().map(Writes::settings).unwrap_or_default(),
            rights: self.rights.place,
            keeps: self.keeps,
            loses: self.loses,
        };
        description.serialize(serializer)
    }
}
