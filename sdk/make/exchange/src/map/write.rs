//! Exports a texture as an image.

use htex_author::{AuthorError, Difference, TextureSpectrum};
use htex_dsp::grid::level_rms;
use htex_format::Rights;
use htex_host::{FitCondition, FitInput, Registry};
use htex_play::{Motion, Texture};

use super::MODEL;
use super::image::{Image, read, to_bytes};
use crate::error::{ExchangeError, Fault};
use crate::export::{Export, ExportedFile};
use crate::format::Format;
use crate::loss::Loss;

/// Indices in the model's parameters.
const WIDTH: usize = 0;
const PITCH: usize = 1;
const SPEED: usize = 2;
const FORCE: usize = 3;
const RMS: usize = 4;
const GREY: usize = 6;

/// Writes a texture as an image. A friction map keeps its own pixels. Any other texture becomes a
/// row of pixels, which is fitted to what the texture plays at a motion. The default motion is the
/// texture's default condition.
///
/// # Errors
/// When the texture is silent, when the speed is unknown, or when 255 pixels cannot represent any
/// part of it.
pub(crate) fn export(
    asset: &Texture,
    export: &Export<'_>,
    motion: Option<Motion>,
) -> Result<ExportedFile, ExchangeError> {
    let (format, model) = (export.format, export.model);
    let Some((parameters, level_rms)) = own(asset, model)? else {
        return export_fit(asset, export, motion);
    };
    if motion.is_some() {
        return Err(format.cannot(
            "the texture is a map, whose pixels are the same at every motion; leave out speed and force",
        ));
    }
    let rights = Rights::from_manifest(asset.manifest());
    let (bytes, white) = image(format, &parameters, level_rms, &rights)?;
    let notes = vec![said(&parameters, white, asset)];
    Ok(ExportedFile { notes, ..ExportedFile::of_asset(format, bytes, &rights) })
}

/// Returns the parameters and the level of a texture that is a friction map. They come from the
/// named model. Without a name, they come from the model that an app would play.
fn own(asset: &Texture, model: Option<&str>) -> Result<Option<(Vec<f64>, f64)>, ExchangeError> {
    let representation = asset.representation(model)?;
    match representation.model()?.id() {
        MODEL => Ok(Some(representation.parameters(None)?)),
        _ => Ok(None),
    }
}

fn export_fit(
    asset: &Texture,
    export: &Export<'_>,
    motion: Option<Motion>,
) -> Result<ExportedFile, ExchangeError> {
    let (format, model) = (export.format, export.model);
    let band = asset.band();
    let frequency_hz = band.grid_hz();
    let representation = asset.representation(model)?;
    let default = asset.manifest().conditions.get(representation.default_condition());
    let condition = FitCondition {
        speed_mm_s: motion
            .map(|motion| motion.speed_mm_s)
            .or(default.and_then(|one| one.speed_mm_s)),
        force_n: motion.map(|motion| motion.force_n).or(default.and_then(|one| one.force_n)),
    };
    if condition.speed_mm_s.is_none() {
        return Err(format.cannot(
            "the texture states no speed, and pixels lie over a way; give `speed` and `force`",
        ));
    }
    let magnitude = representation.magnitude(motion, &frequency_hz)?;
    let failed = |error: htex_host::HostError| format.cannot(error.to_string());
    let registry = Registry::builtin();
    let map = registry.find(MODEL).map_err(failed)?;
    let request = FitInput {
        band,
        frequency_hz: &frequency_hz,
        magnitude: &magnitude,
        signal: &[],
        signal_rate_hz: 0.0,
        options: &[],
        condition,
    };
    let fit = map.fit(&request).map_err(failed)?;
    let shape = map.magnitude(&fit.parameters, band, &frequency_hz).map_err(failed)?;
    let reference = TextureSpectrum {
        quantity: asset.quantity(),
        band,
        frequency_hz,
        magnitude,
        segments: 0,
        repeatability: None,
        signal: Vec::new(),
        signal_rate_hz: 0.0,
    };
    let rights = Rights::from_manifest(asset.manifest());
    let (bytes, white) = image(format, &fit.parameters, fit.level_rms, &rights)?;
    Ok(ExportedFile {
        lost: Some(loss(&reference, shape, fit.level_rms)?),
        notes: vec![
            said(&fit.parameters, white, asset),
            "It is one row, which repeats. It is felt only along the row, and as the texture only at that speed.".to_owned(),
        ],
        ..ExportedFile::of_asset(format, bytes, &rights)
    })
}

/// Returns the loss between a reference spectrum and the spectrum of a shape at a level.
fn loss(reference: &TextureSpectrum, shape: Vec<f64>, level: f64) -> Result<Loss, ExchangeError> {
    let other = TextureSpectrum {
        magnitude: shape.into_iter().map(|m| level * m).collect(),
        ..reference.clone()
    };
    let level_db =
        20.0 * libm::log10(level_rms(&other.magnitude) / level_rms(&reference.magnitude));
    let difference = Difference::between(reference, &other);
    Ok(Loss {
        difference: difference.ok_or(AuthorError::QuantitiesDiffer)?,
        level_db,
        sensation_db: None,
    })
}

/// Writes parameters as an image, and reads the image back. Also returns the value of white at the
/// level.
fn image(
    format: &Format,
    parameters: &[f64],
    level_rms: f64,
    rights: &Rights,
) -> Result<(Vec<u8>, f64), ExchangeError> {
    let at = |index: usize| parameters.get(index).copied().unwrap_or_default();
    let grey = parameters.get(GREY..).unwrap_or_default();
    let image = Image {
        width: at(WIDTH) as usize,
        grey: grey.iter().map(|grey| libm::round(*grey) as u8).collect(),
        pitch_mm: Some(at(PITCH)),
    };
    let own = |fault: Fault| format.cannot(fault.to_string());
    let bytes = to_bytes(&image, rights).map_err(own)?;
    if read(&bytes).map_err(own)?.grey == image.grey {
        Ok((bytes, level_rms * f64::from(u8::MAX) / at(RMS)))
    } else {
        Err(format.cannot("what was written is read as another image"))
    }
}

/// Returns a text about what the image file does not state.
fn said(parameters: &[f64], white: f64, asset: &Texture) -> String {
    // Rounded to 32-bit floats, as assets store them, so that no meaningless digits are shown.
    let at = |index: usize| parameters.get(index).copied().unwrap_or_default() as f32;
    let white = white as f32;
    let unit = asset.quantity().unit();
    let (pitch_mm, speed_mm_s) = (at(PITCH), at(SPEED));
    let force = match at(FORCE) {
        0.0 => String::new(),
        force_n => format!(" and {force_n} N"),
    };
    format!(
        "White is {white} {unit} above black at {speed_mm_s} mm/s{force}, and pixels lie {pitch_mm} mm apart."
    )
}
