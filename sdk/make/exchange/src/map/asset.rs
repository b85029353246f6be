//! Converts an image to an asset.

use htex_author::{new_asset, representation, stored_fields};
use htex_dsp::grid::Band;
use htex_format::{AtCondition, Condition, Contact, Provenance, Quantity, round_within};
use htex_host::Registry;

use super::MODEL;
use super::image::Image;
use crate::error::Fault;
use crate::format::Naming;
use crate::import::ImportedAsset;
use crate::physical::PhysicalValues;

/// Converts an image to an asset. The asset has no licence yet. `pitch_mm` is the distance between
/// neighbouring pixels. The full scale is the value of white.
///
/// # Errors
/// When the image has no waves within the band at this speed.
pub(crate) fn import(
    image: &Image,
    pitch_mm: f64,
    values: PhysicalValues,
    quantity: Quantity,
    naming: Naming<'_>,
) -> Result<ImportedAsset, Fault> {
    let fault = |error: &dyn std::fmt::Display| Fault::whole(error.to_string());
    let registry = Registry::builtin();
    let model = registry.find(MODEL).map_err(|error| fault(&error))?;
    let grey: Vec<f64> = image.grey.iter().map(|grey| f64::from(*grey)).collect();
    // The numbers are rounded in the same way as stored numbers, because a spectral line may lie on
    // an edge of the band.
    let [stored_mm, speed_mm_s, force_n] =
        [pitch_mm, values.speed_mm_s, values.force_n].map(|x| f64::from(x as f32));
    let rms = htex_map::rms(image.width, stored_mm, speed_mm_s, &grey, Band::TACTILE);
    // The level is rounded like the stored numbers, so that both agree to the last bit.
    let rms = f64::from(rms.map_err(|error| fault(&error))? as f32);
    let numbers = [image.width as f64, stored_mm, speed_mm_s, force_n, rms, grey.len() as f64];
    let flat = [&numbers[..], &grey].concat();
    let fields = stored_fields(model.descriptor());
    let parameters =
        round_within(&fields, model.descriptor(), &flat).map_err(|error| fault(&error))?;
    let level_rms = values.full_scale * rms / f64::from(u8::MAX);
    let at = AtCondition { condition: 0, level_rms, quality: None, left_out: None };
    let options = [("full-scale", values.full_scale), ("pitch", pitch_mm)];
    let provenance = Provenance {
        tool: naming.tool.to_owned(),
        options: options.map(|(name, value)| (name.to_owned(), value.to_string())).into(),
        ..Provenance::default()
    };
    let condition = Condition {
        speed_mm_s: Some(values.speed_mm_s),
        force_n: Some(values.force_n),
        ..Condition::default()
    };
    let models = vec![(representation(model, vec![at]), vec![parameters])];
    let mut asset =
        new_asset(naming.name, quantity, Band::TACTILE, provenance, vec![condition], models);
    asset.manifest.source = Some("a friction map".to_owned());
    asset.manifest.contact = Contact::Finger;
    Ok(ImportedAsset::new(asset, None, Vec::new()))
}
