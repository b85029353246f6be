//! The stored gains of people, and the levels of scenes; shared by `gain` and `play`.

use std::path::PathBuf;

use clap::Args;
use htex_base::files::AtFile;
use htex_format::Manifest;
use htex_scene::file::Levels;
use htex_scene::{Gain, GainKey, Gains, recordings_of, texture_id, texture_name};

use crate::failure::{Failure, Result};
use crate::output::warn;
use crate::scenes::Ready;

/// Options that replace the models and the levels of a scene.
#[derive(Args)]
pub(crate) struct FeltArgs {
    /// Play every surface with this model, by short name or id
    #[arg(long, value_name = "ID")]
    model: Option<String>,

    /// `normalised`: a texture is equally strong with every model. `own`: the energy of a model's
    /// own spectrum determines how strong the texture is with this model, so the models differ in
    /// strength. With `own`, the drive voltage applies to the model with which the gain of --person
    /// was found; without --person, it applies to the strongest model
    #[arg(long, value_name = "LEVELS", value_parser = ["normalised", "own"])]
    levels: Option<String>,
}

impl FeltArgs {
    pub(crate) fn apply(&self, ready: &mut Ready) -> Result<()> {
        let scene = &mut ready.scene.file;
        if let Some(model) = &self.model {
            for surface in &mut scene.surfaces {
                surface.representation.clone_from(model);
            }
        }
        let Some(levels) = &self.levels else {
            return Ok(());
        };
        if ready.capabilities.quantity.is_physical() {
            let unit = ready.capabilities.quantity.unit();
            return Err(Failure::Usage(format!(
                "--levels: the device takes {unit}, which is never normalised"
            )));
        }
        scene.device.levels = match levels.as_str() {
            "own" => Levels::Own,
            _ => Levels::Normalised,
        };
        Ok(())
    }
}

/// Returns the file in which gains are stored.
pub(crate) fn gains_file() -> Result<PathBuf> {
    Gains::user_file().ok_or_else(|| {
        Failure::Other("no folder for gains was found; set HTEX_CONFIG_DIR".to_owned())
    })
}

pub(crate) fn gains() -> Result<(Gains, PathBuf)> {
    let file = gains_file()?;
    let gains = Gains::load(&file).reading(&file)?;
    Ok((gains, file))
}

/// Returns the key of this person's gain. `texture` replaces the textures' own names.
pub(crate) fn key(person: &str, texture: Option<&str>, ready: &Ready) -> GainKey {
    let device = &ready.scene.file.device;
    GainKey {
        person: person.to_owned(),
        texture: texture.map_or_else(|| texture_id(manifests(ready)), texture_name),
        device: ready.device.descriptor().id.clone(),
        profile: device.profile.clone().unwrap_or_default(),
    }
}

/// Returns the hash by which earlier versions of htex identified a texture.
pub(crate) fn hash(ready: &Ready) -> Result<String> {
    Ok(Gains::hash_of(&ready.file).reading(&ready.file)?)
}

/// Returns the file names of the recordings from which the textures were made.
pub(crate) fn recordings(ready: &Ready) -> Vec<String> {
    recordings_of(manifests(ready))
}

fn manifests(ready: &Ready) -> impl Iterator<Item = &Manifest> {
    ready.scene.assets.iter().map(|asset| asset.manifest())
}

/// Applies the stored gain of this person to a scene.
pub(crate) fn apply_gain(person: &str, texture: Option<&str>, ready: &mut Ready) -> Result<()> {
    let (gains, _) = gains()?;
    let key = key(person, texture, ready);
    let asked = ready.file.display();
    let find = format!("find it with `htex gain {asked} --person {person}`");
    let Some(gain) = gains.find(&key, &hash(ready)?) else {
        let what = &key.texture;
        let sentence = format!("no gain is kept for {person}, `{what}` and this device; {find}");
        return Err(Failure::Other(sentence));
    };
    let limit_v = ready.capabilities.limit.unwrap_or(f64::INFINITY);
    // The limit may have been lowered since, or the file edited by hand.
    if !(gain.drive_v > 0.0 && gain.drive_v <= limit_v) {
        let drive_v = gain.drive_v;
        return Err(Failure::Other(format!(
            "the drive of {drive_v} V kept for {person} is not within the device's limit of {limit_v} V; {find}"
        )));
    }
    warn_of_other_recordings(gain, ready);
    let device = &mut ready.scene.file.device;
    device.drive_v = Some(gain.drive_v);
    if device.levels == Levels::Own && device.reference_rms.is_none() {
        let known_n = gain.reference_rms.filter(|n| n.is_finite() && *n > 0.0);
        device.reference_rms = Some(known_n.ok_or_else(|| {
            let sentence = format!(
                "the gain kept for {person} does not say at which level it was found; {find}"
            );
            Failure::Other(sentence)
        })?);
    }
    Ok(())
}

/// Warns if the gain was found with other recordings, because two textures may have the same name.
fn warn_of_other_recordings(gain: &Gain, ready: &Ready) {
    let here = recordings(ready);
    let shared = gain.recordings.iter().any(|name| here.contains(name));
    if shared || here.is_empty() || gain.recordings.is_empty() {
        return;
    }
    warn(&[format!(
        "the gain for `{}` was found with a texture recorded in {}, and this one was recorded in {}; if it is another, \
         give it a name of its own with --texture",
        gain.key.texture,
        gain.recordings.join(", "),
        here.join(", ")
    )]);
}
