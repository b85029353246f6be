//! Computes what a fingertip can feel: the difference between two textures, and the detection
//! threshold.

use htex::Texture;
use htex::format::Asset;
use htex_author::AuthorError;
use htex_author::{Felt, SpectrumRef, felt as difference, threshold_magnitude};
use htex_dsp::vibrotactile::Listener;
use serde::Serialize;

use super::made::quantity;
use crate::answer::{Answer, Files};
use crate::document::{Document, number};
use crate::refusal::Refusal;

/// How much of a difference a fingertip can feel: in each third-octave band, and summarised in a
/// few numbers.
#[derive(Serialize)]
struct FeltSummary {
    centre_hz: Vec<f64>,
    reference_db: Vec<f64>,
    level_db: Vec<f64>,
    error_db: Vec<f64>,
    error_rms_db: f64,
    largest_error_db: f64,
    total_error_db: f64,
    sensation_error_rms: f64,
    below_detection_threshold: bool,
    below_difference_threshold: bool,
    below_if_sensitive: bool,
}

/// Compares a texture with a reference, each at a motion. The first file is the reference, the
/// second file is the texture.
pub(crate) fn felt(mut call: Document, files: Files<'_>) -> Result<Answer, Refusal> {
    let sides = (call.object("reference")?, call.object("other")?);
    call.finish()?;
    let [reference, other] = files else {
        return Err(Refusal::argument("give two textures"));
    };
    let (reference, first) = magnitude(reference, sides.0)?;
    let (other, second) = magnitude(other, sides.1)?;
    if reference.quantity() != other.quantity() || reference.band() != other.band() {
        let sentence =
            "the textures have other quantities or bands, whose spectra cannot be compared";
        return Err(Refusal::argument(sentence));
    }
    let band = reference.band();
    let grid = band.grid_hz();
    let spectrum = SpectrumRef { band, frequency_hz: &grid, magnitude: &first };
    let by = |listener: &Listener| difference(spectrum, &second, reference.quantity(), listener);
    let told = told(by(&Listener::default()), &by(&Listener::sensitive()));
    Answer::new(&told, Vec::new())
}

fn told(felt: Felt, if_sensitive: &Felt) -> FeltSummary {
    FeltSummary {
        below_detection_threshold: felt.is_below_detection_threshold(),
        below_difference_threshold: felt.is_below_difference_threshold(),
        below_if_sensitive: if_sensitive.is_below_difference_threshold(),
        centre_hz: felt.centre_hz,
        reference_db: felt.reference_db,
        level_db: felt.level_db,
        error_db: felt.error_db,
        error_rms_db: felt.error_rms_db,
        sensation_error_rms: felt.sensation_error_rms,
        largest_error_db: felt.largest_error_db,
        total_error_db: felt.total_error_db,
    }
}

/// Returns a texture, and its magnitudes at a motion according to a model.
fn magnitude(bytes: &[u8], mut side: Document) -> Result<(Texture, Vec<f64>), Refusal> {
    let model = side.text("model")?;
    let mut at = side.object("at")?;
    let (speed, force) = (at.number("speed")?, at.number("force")?);
    at.finish()?;
    side.finish()?;
    let asset = Texture::new(Asset::from_bytes(bytes)?);
    let grid = asset.band().grid_hz();
    let representation = asset.representation(model.as_deref()).map_err(AuthorError::from)?;
    let motion = match (speed, force) {
        (None, None) => None,
        (speed, force) => Some(representation.motion(speed, force)),
    };
    let magnitude = representation.magnitude(motion, &grid).map_err(AuthorError::from)?;
    Ok((asset, magnitude))
}

/// Returns the detection threshold: for each frequency, the magnitude at which a finger just feels
/// a sinusoid.
pub(crate) fn threshold(mut call: Document, _: Files<'_>) -> Result<Answer, Refusal> {
    let quantity = quantity(call.text("quantity")?)?;
    let frequencies = call.list("frequencies")?;
    call.finish()?;
    let hertz = frequencies.iter().map(|value| number(value).filter(|hertz| *hertz > 0.0));
    let hertz: Option<Vec<f64>> = hertz.collect();
    let hertz = hertz.ok_or_else(|| Refusal::argument("frequencies are numbers above 0, Hz"))?;
    let listener = Listener::default();
    let magnitude = |hertz: &f64| threshold_magnitude(*hertz, quantity, &listener);
    let magnitudes: Vec<f64> = hertz.iter().map(magnitude).collect();
    Answer::new(&magnitudes, Vec::new())
}
