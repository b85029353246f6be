//! Conversion of an image to an asset.

use htex_author::stored_fields;
use htex_dsp::grid::Band;
use htex_format::{
    Asset, AtCondition, Condition, Contact, Manifest, Provenance, Quantity, Representation,
    VERSION, round_within,
};
use htex_host::Registry;

use super::MODEL;
use super::image::Image;
use crate::error::Fault;
use crate::format::{Held, Naming};

/// What the user states about an image.
pub(crate) struct Surface<'a> {
    /// Distance between neighbouring pixels, mm.
    pub(crate) pitch_mm: f64,
    /// Value of white, in the quantity's unit.
    pub(crate) full_scale: f64,
    pub(crate) quantity: Quantity,
    /// Speed and force for which the asset states its level.
    pub(crate) speed_mm_s: f64,
    pub(crate) force_n: f64,
    pub(crate) naming: Naming<'a>,
}

/// Makes the asset of an image. It has no licence, because the file states none.
///
/// # Errors
/// When nothing can be felt in the band at this speed.
pub(crate) fn held(image: &Image, surface: &Surface<'_>) -> Result<Held, Fault> {
    let fault = |error: &dyn std::fmt::Display| Fault::whole(error.to_string());
    let registry = Registry::builtin();
    let model = registry.find(MODEL).map_err(|error| fault(&error))?;
    let fields = stored_fields(model.descriptor());
    let grey: Vec<f64> = image.grey.iter().map(|grey| f64::from(*grey)).collect();
    // Rounded as they are stored, because a line may lie on an edge of the band.
    let [pitch_mm, speed_mm_s, force_n] =
        [surface.pitch_mm, surface.speed_mm_s, surface.force_n].map(|x| f64::from(x as f32));
    let rms = htex_map::rms(image.width, pitch_mm, speed_mm_s, &grey, Band::TACTILE);
    // The level is computed from the stored number, so that both agree to the last bit.
    let rms = f64::from(rms.map_err(|error| fault(&error))? as f32);
    let numbers = [image.width as f64, pitch_mm, speed_mm_s, force_n, rms, grey.len() as f64];
    let flat = [&numbers[..], &grey].concat();
    let parameters =
        round_within(&fields, model.descriptor(), &flat).map_err(|error| fault(&error))?;
    let representation = Representation {
        model: MODEL.to_owned(),
        model_version: model.descriptor().version.clone(),
        fields,
        at: vec![AtCondition {
            condition: 0,
            level_rms: surface.full_scale * rms / f64::from(u8::MAX),
            quality: None,
            left_out: None,
        }],
        triangles: Vec::new(),
        parameters: "parameters/map.bin".to_owned(),
    };
    Ok(Held {
        asset: Asset {
            manifest: manifest(surface, representation),
            parameters: vec![vec![parameters]],
            reference: None,
            plugins: Vec::new(),
            notes: Vec::new(),
        },
        bytes: None,
        warnings: Vec::new(),
    })
}

fn manifest(surface: &Surface<'_>, representation: Representation) -> Manifest {
    let options = [("full-scale", surface.full_scale), ("pitch", surface.pitch_mm)];
    Manifest {
        htex: VERSION.to_owned(),
        name: surface.naming.name.to_owned(),
        license: None,
        author: None,
        tags: Vec::new(),
        description: None,
        source: Some("a friction map".to_owned()),
        doi: None,
        sensor: None,
        finger: None,
        contact: Contact::Finger,
        quantity: surface.quantity,
        unit: surface.quantity.unit().to_owned(),
        band: Band::TACTILE,
        provenance: Provenance {
            tool: surface.naming.tool.to_owned(),
            options: options.map(|(name, value)| (name.to_owned(), value.to_string())).into(),
            ..Provenance::default()
        },
        conditions: vec![Condition {
            speed_mm_s: Some(surface.speed_mm_s),
            force_n: Some(surface.force_n),
            ..Condition::default()
        }],
        law: None,
        representations: vec![representation],
        reference: None,
        plugins: Vec::new(),
        extensions: Default::default(),
        extensions_required: Vec::new(),
        other: Default::default(),
    }
}
