//! What a format is: how its files come in, how they go out, and which settings either takes.

use serde::Serialize;

use crate::error::{ExchangeError, Fault};
#[cfg(feature = "export")]
use crate::job::{AssetJob, Job, Written};
use crate::profile::Profile;
use crate::rights::RightsPlace;

/// A format.
#[derive(Debug)]
#[non_exhaustive]
pub struct Format {
    /// As `--to` has it.
    pub name: &'static str,
    /// What it is, in words.
    pub title: &'static str,
    /// Extensions of its files, in lower case.
    pub extensions: &'static [&'static str],
    /// How a file comes in, if it is imported.
    pub reads: Option<Reads>,
    /// How an asset goes out, if it is exported.
    #[cfg(feature = "export")]
    pub writes: Option<Writes>,
    /// Where its files carry licence and author.
    pub rights: RightsPlace,
    /// What of a texture it keeps.
    pub keeps: &'static str,
    /// What it loses.
    pub loses: &'static str,
}

/// How a file comes in.
#[derive(Debug, Clone, Copy)]
pub enum Reads {
    /// As a signal within ±1 to fit, whose frequencies are positions in an actuator's range: that
    /// of a profile, unless another is given.
    Positions { read: ReadPositions, profile: &'static str },
    /// As a signal within ±1 to fit, whose frequencies are hertz, or waves in a metre.
    Signal(ReadSignal),
    /// As an asset: the file states units, speeds and forces.
    Asset(ReadAsset),
    /// As an asset: the file is an image of grey values over a surface.
    Map,
}

pub type ReadPositions = fn(&[u8], Sampling, &Profile) -> Result<Signal, Fault>;
pub type ReadSignal = fn(&[u8], Sampling) -> Result<Signal, Fault>;
pub type ReadAsset = fn(&[u8], &Naming<'_>) -> Result<Held, Fault>;

/// How an asset goes out.
#[cfg(feature = "export")]
#[derive(Debug, Clone, Copy)]
pub enum Writes {
    /// What it plays at a motion, as far as an actuator can.
    Signal {
        write: WriteSignal,
        /// The profile where none is given.
        profile: &'static str,
        /// Settings beside those that all signals take.
        settings: &'static [&'static str],
    },
    /// The asset itself, of which nothing is lost.
    Asset(WriteAsset),
    /// An image of grey values over a surface.
    Map,
}

#[cfg(feature = "export")]
pub type WriteSignal = fn(&Job<'_>) -> Result<Written, ExchangeError>;
#[cfg(feature = "export")]
pub type WriteAsset = fn(&AssetJob<'_>) -> Result<Vec<u8>, ExchangeError>;

/// How a signal is sampled.
#[derive(Debug, Clone, Copy)]
pub struct Sampling {
    /// Rate of the samples, hertz.
    pub rate_hz: f64,
    /// Speed of a finger over a file that lies over space, mm/s.
    pub speed_mm_s: f64,
}

/// A signal within ±1.
#[derive(Debug, Clone, PartialEq)]
pub struct Signal {
    pub samples: Vec<f64>,
    /// What of the file was not read, each a sentence.
    pub left_out: Vec<String>,
}

/// What an asset has that its file does not.
#[derive(Debug, Clone, Copy)]
pub struct Naming<'a> {
    /// Name of the texture, if the file gives none.
    pub name: &'a str,
    /// Program and version, for the provenance.
    pub tool: &'a str,
}

/// The asset that a file holds.
#[derive(Debug)]
pub struct Held {
    pub asset: htex_format::Asset,
    /// The asset's file, if the file that comes in has it in it.
    pub bytes: Option<Vec<u8>>,
    /// What a person should know of the file, each a sentence.
    pub warnings: Vec<String>,
}

/// Settings of imports that are fitted.
const FITTED: &[&str] =
    &["full_scale", "quantity", "speed", "force", "model", "option", "level", "keep_reference"];
/// Settings of imports of an image.
const IMAGED: &[&str] = &["full_scale", "quantity", "speed", "force", "pitch"];
/// Settings of exports as an image.
#[cfg(feature = "export")]
const PRINTED: &[&str] = &["model", "speed", "force"];
/// Settings of exports of what an asset plays.
#[cfg(feature = "export")]
const PLAYED: &[&str] = &["model", "speed", "force", "seconds", "stroke", "profile", "seed"];

/// Those of them that a scene has itself.
#[cfg(feature = "export")]
const OF_SCENES: &[&str] = &["model", "speed", "force", "stroke", "seed"];

impl Reads {
    /// Returns the settings that it takes, as keywords, beside metadata.
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
    /// Returns the settings that it takes, as keywords.
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
    /// Checks that an import takes settings, which are keywords: `full_scale`.
    ///
    /// # Errors
    /// With the first that it does not take.
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

    /// As [`Self::check_import`], of an export.
    ///
    /// # Errors
    /// With the first that it does not take.
    #[cfg(feature = "export")]
    pub fn check_export<'a>(
        &self,
        given: impl IntoIterator<Item = &'a str>,
    ) -> Result<(), ExchangeError> {
        let takes = self.writes.as_ref().map(Writes::settings);
        self.check("export", takes.unwrap_or_default(), given)
    }

    /// As [`Self::check_export`], of what a scene plays: model, motion and seed are the scene's.
    ///
    /// # Errors
    /// With the first that it does not take.
    #[cfg(feature = "export")]
    pub fn check_export_of_scene<'a>(
        &self,
        given: impl IntoIterator<Item = &'a str>,
    ) -> Result<(), ExchangeError> {
        let mut takes = self.writes.as_ref().map(Writes::settings).unwrap_or_default();
        takes.retain(|setting| !OF_SCENES.contains(setting));
        self.check("export of a scene", takes, given)
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

    /// Its extensions, with their points.
    #[must_use]
    pub fn dotted(&self) -> String {
        let dotted: Vec<String> = self.extensions.iter().map(|e| format!(".{e}")).collect();
        dotted.join(", ")
    }
}

/// What `htex formats --json` tells of a format.
#[derive(Serialize)]
struct Described<'a> {
    name: &'a str,
    title: &'a str,
    extensions: &'a [&'a str],
    /// `signal` or `asset`; of exports also `image`.
    import: Option<&'a str>,
    import_settings: Vec<&'a str>,
    export: Option<&'a str>,
    export_settings: Vec<&'a str>,
    /// Where its files carry licence and author.
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
        let described = Described {
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
        described.serialize(serializer)
    }
}
