//! Description of a format: how its files are imported and exported, and which settings each
//! direction takes.

use serde::Serialize;

use crate::error::{ExchangeError, Fault, in_file};
#[cfg(feature = "export")]
use crate::export::Export;
use crate::import::ImportedAsset;
#[cfg(feature = "export")]
use crate::job::{Job, WrittenSignal};
use crate::profile::Profile;
use crate::rights::RightsPlace;

/// Sample rate of signals, of measured envelopes and of losses, hertz.
pub const RATE_HZ: f64 = 8_000.0;

/// A file format that can be imported, exported or both.
#[derive(Debug)]
#[non_exhaustive]
pub struct Format {
    /// The name, as given to `--to`.
    pub name: &'static str,
    /// A short description.
    pub title: &'static str,
    /// File extensions, in lower case.
    pub extensions: &'static [&'static str],
    /// How files are imported; `None` if they cannot be.
    pub reads: Option<Reads>,
    /// How assets are exported; `None` if they cannot be.
    #[cfg(feature = "export")]
    pub writes: Option<Writes>,
    /// Where its files carry the licence and the author.
    pub rights: RightsPlace,
    /// What the format keeps of a texture.
    pub keeps: &'static str,
    /// What the format loses.
    pub loses: &'static str,
}

/// How files of a format are imported.
#[derive(Debug, Clone, Copy)]
pub enum Reads {
    /// As a signal within ±1, to which models are fitted. Its frequencies are positions in an
    /// actuator's range; `profile` names the actuator unless the user gives another.
    Positions { read: ReadPositions, profile: &'static str },
    /// As a signal within ±1, to which models are fitted. Its frequencies are in hertz, or in waves
    /// per metre.
    Signal(ReadSignal),
    /// As an asset, because the file states units, speeds and forces.
    Asset(ReadAsset),
    /// As an asset, because the file is an image of grey values over a surface.
    Map,
}

type ReadPositions = fn(&[u8], Sampling, &Profile) -> Result<Signal, Fault>;
type ReadSignal = fn(&[u8], Sampling) -> Result<Signal, Fault>;
type ReadAsset = fn(&[u8], &Naming<'_>) -> Result<ImportedAsset, Fault>;

/// How assets are exported to a format.
#[cfg(feature = "export")]
#[derive(Debug, Clone, Copy)]
pub enum Writes {
    /// What the asset plays at a motion, as far as an actuator can play it.
    Signal {
        write: WriteSignal,
        /// The profile that is used unless the user gives another.
        profile: &'static str,
        /// Settings in addition to the settings of all signals.
        settings: &'static [&'static str],
    },
    /// The asset itself, without loss.
    Asset(WriteAsset),
    /// An image of grey values over a surface.
    Map,
}

/// The function that writes what is played to a format.
#[cfg(feature = "export")]
pub type WriteSignal = fn(&Job<'_>) -> Result<WrittenSignal, ExchangeError>;
#[cfg(feature = "export")]
type WriteAsset = fn(&htex_play::Texture, &Export<'_>) -> Result<Vec<u8>, ExchangeError>;

/// How a signal is to be sampled.
#[derive(Debug, Clone, Copy)]
pub struct Sampling {
    /// Sample rate, hertz.
    pub rate_hz: f64,
    /// Speed of a finger over a file whose positions lie in space, mm/s.
    pub speed_mm_s: f64,
}

/// A signal within ±1.
#[derive(Debug, Clone, PartialEq)]
pub struct Signal {
    pub samples: Vec<f64>,
    /// What was ignored in the file, each as a sentence.
    pub left_out: Vec<String>,
}

/// What an asset needs in addition to its file.
#[derive(Debug, Clone, Copy, Default)]
pub struct Naming<'a> {
    /// Name of the texture, if the file does not name it.
    pub name: &'a str,
    /// Program and version, stored in the provenance.
    pub tool: &'a str,
}

/// Settings of imports to which models are fitted.
const FITTED: &[&str] =
    &["full_scale", "quantity", "speed", "force", "model", "option", "level", "keep_reference"];
/// Settings of image imports.
const IMAGED: &[&str] = &["full_scale", "quantity", "speed", "force", "pitch"];
/// Settings of image exports.
#[cfg(feature = "export")]
const PRINTED: &[&str] = &["model", "speed", "force"];
/// Settings of exports of what an asset plays.
#[cfg(feature = "export")]
const PLAYED: &[&str] = &["model", "speed", "force", "seconds", "stroke", "profile", "seed"];

/// Settings among these that come from the scene when a scene is exported.
#[cfg(feature = "export")]
const OF_SCENES: &[&str] = &["model", "speed", "force", "stroke", "seed"];

impl Reads {
    /// Returns the settings that the import takes, as keywords, without metadata.
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

#[cfg(feature = "export")]
impl Writes {
    /// Returns the settings that the export takes, as keywords.
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
    /// Checks that an import takes the given settings, which are keywords such as `full_scale`.
    ///
    /// # Errors
    /// When a setting does not apply; the error names the first such setting.
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

    /// Checks that an export takes the given settings, as [`Self::check_import`] does for an
    /// import.
    ///
    /// # Errors
    /// When a setting does not apply; the error names the first such setting.
    #[cfg(feature = "export")]
    pub fn check_export<'a>(
        &self,
        given: impl IntoIterator<Item = &'a str>,
    ) -> Result<(), ExchangeError> {
        let takes = self.writes.as_ref().map(Writes::settings);
        self.check("export", takes.unwrap_or_default(), given)
    }

    /// As [`Self::check_export`], for an export of what a scene plays. Model, motion and seed come
    /// from the scene.
    ///
    /// # Errors
    /// When a setting does not apply; the error names the first such setting.
    #[cfg(feature = "export")]
    pub fn check_export_of_scene<'a>(
        &self,
        given: impl IntoIterator<Item = &'a str>,
    ) -> Result<(), ExchangeError> {
        let mut takes = self.writes.as_ref().map(Writes::settings).unwrap_or_default();
        takes.retain(|setting| !OF_SCENES.contains(setting));
        self.check("export of a scene", takes, given)
    }

    /// Reads the signal of a file, whose name is `file`.
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

    /// An error that says why the format cannot hold a texture.
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

    /// Its extensions, each with its leading dot.
    #[must_use]
    pub fn dotted(&self) -> String {
        let dotted: Vec<String> = self.extensions.iter().map(|e| format!(".{e}")).collect();
        dotted.join(", ")
    }
}

/// What `htex formats --json` prints about a format.
#[derive(Serialize)]
struct FormatDescription<'a> {
    name: &'a str,
    title: &'a str,
    extensions: &'a [&'a str],
    /// `signal` or `asset`; for exports also `image`.
    import: Option<&'a str>,
    import_settings: Vec<&'a str>,
    export: Option<&'a str>,
    export_settings: Vec<&'a str>,
    /// Where its files carry the licence and the author.
    rights: &'a str,
    keeps: &'a str,
    loses: &'a str,
}

impl Serialize for Format {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[cfg(feature = "export")]
        let (export, export_settings) = (
            self.writes.as_ref().map(Writes::kind),
            self.writes.as_ref().map(Writes::settings).unwrap_or_default(),
        );
        #[cfg(not(feature = "export"))]
        let (export, export_settings) = (None, Vec::new());
        let description = FormatDescription {
            name: self.name,
            title: self.title,
            extensions: self.extensions,
            import: self.reads.as_ref().map(Reads::kind),
            import_settings: self.reads.as_ref().map(Reads::settings).unwrap_or_default(),
            export,
            export_settings,
            rights: self.rights.place,
            keeps: self.keeps,
            loses: self.loses,
        };
        description.serialize(serializer)
    }
}
