//! Describes textures for the index of a library.

use std::sync::OnceLock;

use htex_format::Asset;
use htex_format::library::{CoarseSpectrum, Description};
use htex_host::{Band, Registry};
use htex_play::{Representation, Texture};

use crate::{FeltError, TextureSpectrum};

/// Describes a texture for the index of a library. The description contains the spectrum at the
/// default condition and the held-out error that the asset states. If the asset keeps recorded
/// spectra, the description also contains the felt difference from these spectra.
///
/// All values are for the representation that an app with only the built-in models would play.
/// Therefore, the values do not depend on installed plugins, and the same textures give the same
/// library on every machine. If no built-in model can play the texture, the description is empty.
pub fn describe(asset: &Asset) -> Description {
    let texture = texture(asset);
    match played(&texture) {
        Some(representation) => Description {
            spectrum: spectrum(&representation),
            felt_error_rms_db: felt_error_rms_db(&representation),
            held_out_error_db: held_out_error_db(&representation),
        },
        None => Description::default(),
    }
}

/// Returns the id of the model that an app with only the built-in models would play; `None` if no
/// built-in model can play the asset.
pub fn played_model(asset: &Asset) -> Option<String> {
    played(&texture(asset)).map(|representation| representation.id().to_owned())
}

/// Makes a texture that has only the built-in models.
fn texture(asset: &Asset) -> Texture {
    static BUILTIN: OnceLock<Registry> = OnceLock::new();
    let registry = BUILTIN.get_or_init(Registry::builtin);
    Texture::with_registry(asset.clone(), registry.clone())
}

fn played(texture: &Texture) -> Option<Representation<'_>> {
    texture.representation(None).ok().filter(Representation::is_runnable)
}

/// Returns the spectrum of a representation at its default condition.
fn spectrum(representation: &Representation<'_>) -> Option<CoarseSpectrum> {
    let (hertz, own) = (Band::TACTILE.grid_hz(), representation.texture().band());
    let mut magnitude = representation.magnitude(None, &hertz).ok()?;
    for (hertz, magnitude) in hertz.iter().zip(&mut magnitude) {
        if !(own.low_hz..=own.high_hz).contains(hertz) {
            *magnitude = 0.0;
        }
    }
    CoarseSpectrum::new(&hertz, &magnitude)
}

/// Returns the felt difference from the recorded spectra at the worst condition; `None` if there are
/// no recorded spectra.
fn felt_error_rms_db(representation: &Representation<'_>) -> Option<f64> {
    let texture = representation.texture();
    let recorded = texture.data().reference.as_ref()?;
    let (band, manifest) = (texture.band(), texture.manifest());
    let frequency_hz = band.grid_hz();
    let is_recorded = |condition: usize| {
        manifest.conditions.get(condition).is_some_and(htex_format::Condition::is_recorded)
    };
    let at = representation.data().at.iter().filter(|at| is_recorded(at.condition));
    let errors = at.map(|at| {
        let condition = manifest.conditions.get(at.condition)?;
        let magnitude = recorded.get(at.condition)?.iter().map(|m| f64::from(*m)).collect();
        let recorded = TextureSpectrum {
            quantity: texture.quantity(),
            band,
            frequency_hz: frequency_hz.clone(),
            magnitude,
            segments: 0,
            repeatability: None,
            signal: Vec::new(),
            signal_rate_hz: 0.0,
        };
        let motion = representation.motion(condition.speed_mm_s, condition.force_n);
        let played = representation.recorded_magnitude(Some(motion), &frequency_hz).ok()?;
        Some(FeltError::new(&recorded, &played, None).error_rms_db)
    });
    errors.collect::<Option<Vec<f64>>>()?.into_iter().reduce(f64::max)
}

/// Returns the held-out error at the worst recorded condition; `None` if the asset states none.
fn held_out_error_db(representation: &Representation<'_>) -> Option<f64> {
    let manifest = representation.texture().manifest();
    let held_out = representation.data().at.iter().filter_map(|at| manifest.held_out(at));
    held_out.map(|held_out| held_out.held_out_error_db).reduce(f64::max)
}
