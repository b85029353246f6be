//! Exports assets to files of other formats, and reports what is lost.

use htex_format::Rights;
use htex_play::{Effects, Texture};
use serde::Serialize;

use crate::error::ExchangeError;
use crate::format::{Format, RATE_HZ, WriteSignal, Writes};
use crate::heard::{Path, Playing, SceneSound, Source};
use crate::job::{Coding, Job};
use crate::loss::{Loss, loss};
use crate::map;
use crate::profile::Profile;

/// Shortest and longest export, seconds. Computing a texture's spectrum needs samples of at least
/// 0.2 s.
const SECONDS: std::ops::RangeInclusive<f64> = 0.5..=crate::pattern::MOST_S;
/// Highest sample rate of an export, hertz.
pub(crate) const MOST_RATE_HZ: f64 = 192_000.0;

/// Settings of an export.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Export<'a> {
    pub format: &'static Format,
    /// Id or short name of the model whose representation is exported. If `None`, the
    /// representation with the smallest nine-band error is exported.
    pub model: Option<&'a str>,
    pub path: Path,
    /// The actuator for which the file is made. If `None`, the format's default actuator is used.
    pub profile: Option<&'a Profile>,
    /// Length of the exported vibration, seconds, if the asset is played at a constant condition.
    /// This setting is ignored for a stroke, because a stroke has its own length.
    pub seconds: f64,
    /// Sample rate of a WAV file, hertz; by default 8000.
    pub rate_hz: Option<f64>,
    /// How an `.hjif` file codes the texture; by default [`Coding::Vectorial`].
    pub coding: Option<Coding>,
    /// Extension of the file to write. If the format has several kinds of files, the extension
    /// selects the kind, such as JSON or Kotlin, or `.gltf` or `.glb`. If `None`, the format's
    /// first extension is used.
    pub extension: Option<&'a str>,
    /// The bytes of the asset's file. If the format stores the asset itself, the exported file
    /// contains these bytes unchanged. If `None`, the asset is encoded again.
    pub file: Option<&'a [u8]>,
    pub seed: u64,
}

impl<'a> Export<'a> {
    /// Creates the settings for an export to `format`, with a length of two seconds at the asset's
    /// default condition.
    #[must_use]
    pub fn new(format: &'static Format) -> Self {
        Self {
            format,
            model: None,
            path: Path::Condition(None),
            profile: None,
            seconds: 2.0,
            rate_hz: None,
            coding: None,
            extension: None,
            file: None,
            seed: 0,
        }
    }

    #[must_use]
    pub fn with_path(mut self, path: Path) -> Self {
        self.path = path;
        self
    }

    #[must_use]
    pub fn with_profile(mut self, profile: impl Into<Option<&'a Profile>>) -> Self {
        self.profile = profile.into();
        self
    }

    #[must_use]
    pub fn with_coding(mut self, coding: Coding) -> Self {
        self.coding = Some(coding);
        self
    }

    #[must_use]
    pub fn with_model(mut self, model: &'a str) -> Self {
        self.model = Some(model);
        self
    }

    pub(crate) fn rate_hz(&self) -> f64 {
        self.rate_hz.unwrap_or(RATE_HZ)
    }

    /// Returns the keywords of the settings that were set.
    fn given(&self) -> Vec<&'static str> {
        let (is_stroke, is_moved) = match &self.path {
            Path::Stroke(_) => (true, false),
            Path::Condition(motion) => (false, motion.is_some()),
        };
        let all = [
            ("model", self.model.is_some()),
            ("speed", is_moved),
            ("stroke", is_stroke),
            ("profile", self.profile.is_some()),
            ("seed", self.seed != 0),
            ("rate", self.rate_hz.is_some()),
            ("coding", self.coding.is_some()),
        ];
        let given = all.into_iter().filter(|(_, is_given)| *is_given);
        given.map(|(setting, _)| setting).collect()
    }
}

/// An exported file, with a report of what is lost.
#[derive(Debug, Clone, Serialize)]
#[non_exhaustive]
pub struct ExportedFile {
    #[serde(skip)]
    pub bytes: Vec<u8>,
    pub format: &'static str,
    /// The actuator, and how well it can play the file. `None` if the format is not for actuators.
    #[serde(flatten)]
    pub played: Option<ActuatorPlay>,
    /// How much of the texture is lost; `None` if the file stores the whole texture.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lost: Option<Loss>,
    /// Text that says which parts of a texture the format always loses.
    pub loses: &'static str,
    /// A sentence about the licence and the author that the file states.
    pub rights: String,
    /// Other remarks, each as a sentence.
    pub notes: Vec<String>,
}

impl ExportedFile {
    /// Makes the result for a file that stores the asset itself, so that nothing is lost.
    pub(crate) fn of_asset(format: &Format, bytes: Vec<u8>, rights: &Rights) -> Self {
        Self {
            bytes,
            format: format.name,
            played: None,
            lost: None,
            loses: format.loses,
            rights: format.rights.sentence(rights),
            notes: Vec::new(),
        }
    }
}

/// How well an actuator can play a file, according to the actuator's profile.
#[derive(Debug, Clone, Serialize)]
#[non_exhaustive]
pub struct ActuatorPlay {
    pub profile: String,
    pub seconds: f64,
    /// Fraction of the time during which the actuator is too weak, 0 to 1.
    pub limited: f64,
}

/// Writes an asset as a file of another format. Some formats store the vibration that the asset
/// plays and not the asset itself. After writing such a file, this function reads the file back and
/// measures the loss.
///
/// # Errors
/// Returns an error if the format cannot be written or does not accept a setting, if a number is
/// out of range, if the actuator cannot play such files, or if the asset cannot be played.
pub fn export(asset: &Texture, export: &Export<'_>) -> Result<ExportedFile, ExchangeError> {
    let format = export.format;
    format.check_export(export.given())?;
    let mut exported = match format.writes {
        Some(Writes::Signal { write, profile, .. }) => {
            let source =
                Source::Asset { asset, model: export.model, path: &export.path, seed: export.seed };
            let seconds = match &export.path {
                Path::Condition(_) => export.seconds,
                Path::Stroke(stroke) => stroke.seconds(),
            };
            of_signal(Playing { source, seconds }, export, write, profile)
        }
        Some(Writes::Asset(write)) => {
            let rights = Rights::from_manifest(asset.manifest());
            Ok(ExportedFile::of_asset(format, write(asset, export)?, &rights))
        }
        Some(Writes::Map) => {
            let motion = match export.path {
                Path::Condition(motion) => motion,
                Path::Stroke(_) => None,
            };
            map::export(asset, export, motion)
        }
        None => Err(not_written(format)),
    }?;
    exported.notes.extend(beyond(asset, export)?);
    Ok(exported)
}

/// Returns a note on how the asset plays the motion, if the motion is outside the range of the
/// recorded motions.
fn beyond(asset: &Texture, export: &Export<'_>) -> Result<Option<String>, ExchangeError> {
    let Path::Condition(Some(motion)) = export.path else {
        return Ok(None);
    };
    let conditions = asset.representation(export.model)?.conditions()?;
    let coverage = conditions.coverage(motion, Effects::default());
    Ok((!coverage.is_inside()).then(|| coverage.to_string()))
}

/// Writes a file of another format with the vibration that a scene plays. The scene determines
/// models, motion and seed.
///
/// # Errors
/// Returns the errors of [`export`]. Also returns an error if the format stores assets and not the
/// vibration that they play.
pub fn export_scene(
    scene: &SceneSound<'_>,
    export: &Export<'_>,
) -> Result<ExportedFile, ExchangeError> {
    let format = export.format;
    format.check_export_of_scene(export.given())?;
    match format.writes {
        Some(Writes::Signal { write, profile, .. }) => {
            let playing = Playing { source: Source::Scene(scene), seconds: scene.seconds };
            of_signal(playing, export, write, profile)
        }
        Some(Writes::Asset(_) | Writes::Map) => {
            Err(format.cannot("it holds one asset, and this is a scene; export the scene's assets"))
        }
        None => Err(not_written(format)),
    }
}

fn not_written(format: &Format) -> ExchangeError {
    format.cannot(format!("it is not written; there are {}", crate::exported().join(", ")))
}

fn of_signal(
    playing: Playing<'_>,
    export: &Export<'_>,
    write: WriteSignal,
    profile: &'static str,
) -> Result<ExportedFile, ExchangeError> {
    export.check_numbers(&playing)?;
    let profile = export.profile.map_or_else(|| Profile::find(profile), Ok)?;
    let job = Job { export, playing, profile };
    let written = write(&job)?;
    if written.heard.samples.iter().all(|x| *x == 0.0) {
        let problem = match job.playing.source {
            Source::Asset { .. } => {
                "the texture is silent at this motion; give a speed and a force at which it plays"
            }
            Source::Scene(_) => "the scene is silent",
        };
        return Err(job.cannot(problem));
    }
    let lost = loss(&written.heard, &written.drive, profile)?;
    if let Some(db) = lost.sensation_db.filter(|db| *db <= 0.0) {
        return Err(job.cannot(format!(
            "nobody feels what the actuator `{}` makes of it: {} below the detection threshold of a sensitive finger; give a speed and a \
             force at which the texture is stronger, or another profile",
            profile.name,
            below(db)
        )));
    }
    Ok(ExportedFile {
        lost: Some(lost),
        played: Some(ActuatorPlay {
            profile: profile.name.clone(),
            seconds: job.playing.seconds,
            limited: written.limited,
        }),
        bytes: written.bytes,
        format: export.format.name,
        loses: export.format.loses,
        rights: export.format.rights.sentence(&job.playing.source.rights()),
        notes: [written.notes, job.notes()].concat(),
    })
}

/// Returns a text that describes how far a level in decibels is below 0.
fn below(db: f64) -> String {
    if db.is_finite() { format!("it is {:.1} dB", -db) } else { "all of it is".to_owned() }
}

impl Export<'_> {
    fn check_numbers(&self, playing: &Playing<'_>) -> Result<(), ExchangeError> {
        check("seconds", playing.seconds, SECONDS, "0.5 to 600 s")?;
        let rates_hz = 2.0 * playing.source.band().high_hz..=MOST_RATE_HZ;
        let range = "twice the texture's highest frequency to 192,000 Hz";
        check("rate", self.rate_hz(), rates_hz, range)
    }
}

fn check(
    name: &'static str,
    value: f64,
    within: std::ops::RangeInclusive<f64>,
    range: &'static str,
) -> Result<(), ExchangeError> {
    if within.contains(&value) {
        Ok(())
    } else {
        Err(ExchangeError::OutOfRange { name, value, range })
    }
}
