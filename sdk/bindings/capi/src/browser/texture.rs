//! Calls for textures and voices that JavaScript needs in addition to the C interface
//! (`sdk/bindings/web/src/texture.js`). Structured results are JSON.

use std::ffi::c_char;

use htex::play::{Coverage, Parameter, Reach};
use htex::{Motion, Texture};
use serde_json::{Map, Value, json};

use crate::asset::{ASSETS, htex_asset};
use crate::motion::{htex_motion, motion};
use crate::pointers::{place, slice, slice_mut, text, write_text};
use crate::status::{Failure, guarded, htex_status};
use crate::voice::{VOICES, htex_voice};

/// Writes the full model id of the representation that `model` selects by its id or short name. If
/// `model` is NULL, the call writes the model id of the representation that a new voice plays by
/// default. The call loads no model.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_asset_chosen_model(
    asset: htex_asset,
    model: *const c_char,
    out: *mut c_char,
    capacity: usize,
    length: *mut usize,
) -> htex_status {
    guarded(|| {
        let asset = ASSETS.shared(asset.id)?;
        // SAFETY: the caller passed these pointers.
        let id = asset.representation(unsafe { text(model) }?)?.id();
        // SAFETY: as above.
        unsafe { write_text(id, out, capacity, length) }
    })
}

/// Writes the index of the condition at which a representation plays if no motion is given. `model`
/// works as in htex_asset_magnitude. The call loads no model.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_asset_default_condition(
    asset: htex_asset,
    model: *const c_char,
    out: *mut u32,
) -> htex_status {
    guarded(|| {
        let asset = ASSETS.shared(asset.id)?;
        // SAFETY: the caller passed this text.
        let condition = asset.representation(unsafe { text(model) }?)?.default_condition();
        // SAFETY: the caller passed this pointer.
        *unsafe { place(out) }? = u32::try_from(condition).unwrap_or(u32::MAX);
        Ok(())
    })
}

/// Writes the asset's law as JSON, in the same form as in the manifest. The law states how
/// frequency and level change with speed and force.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_asset_law_json(
    asset: htex_asset,
    out: *mut c_char,
    capacity: usize,
    length: *mut usize,
) -> htex_status {
    guarded(|| {
        let law = ASSETS.shared(asset.id)?.manifest().law();
        let law = serde_json::to_string(&law)
            .map_err(|error| Failure::new(htex_status::HTEX_STATUS_INTERNAL, error))?;
        // SAFETY: the caller passed these pointers.
        unsafe { write_text(&law, out, capacity, length) }
    })
}

/// Writes the parameters of a representation at a motion, as a JSON object. For each parameter's
/// name, the object contains a number or a list of numbers. `model` and `at` work as in
/// htex_asset_magnitude.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_asset_parameters_json(
    asset: htex_asset,
    model: *const c_char,
    at: *const htex_motion,
    out: *mut c_char,
    capacity: usize,
    length: *mut usize,
) -> htex_status {
    guarded(|| {
        let asset = ASSETS.shared(asset.id)?;
        // SAFETY: the caller passed these pointers.
        let (model, at) = unsafe { (text(model)?, motion(at)?) };
        let named = asset.representation(model)?.named_parameters(at)?;
        let parameters = named.into_iter().map(|(name, parameter)| {
            let value = match parameter {
                Parameter::Number(number) => json!(number),
                Parameter::List(list) => json!(list),
            };
            (name, value)
        });
        let json = Value::Object(parameters.collect::<Map<_, _>>()).to_string();
        // SAFETY: as above.
        unsafe { write_text(&json, out, capacity, length) }
    })
}

/// Writes the spectrum of the samples that a representation plays at a recorded condition, as a
/// measurement would show it. `magnitude` receives one magnitude for each frequency on the grid of
/// the asset's band, and `len` must be the number of these frequencies. `condition` is an index
/// that starts at 0.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_asset_read_magnitude(
    asset: htex_asset,
    model: *const c_char,
    condition: usize,
    magnitude: *mut f64,
    len: usize,
) -> htex_status {
    guarded(|| {
        let asset = ASSETS.shared(asset.id)?;
        // SAFETY: the caller passed these pointers.
        let (model, out) = unsafe { (text(model)?, slice_mut(magnitude, len)?) };
        let read = read_magnitude(&asset, model, condition)?;
        if read.len() != out.len() {
            return Err(Failure::argument("one magnitude per frequency of the grid"));
        }
        out.copy_from_slice(&read);
        Ok(())
    })
}

fn read_magnitude(
    asset: &Texture,
    model: Option<&str>,
    condition: usize,
) -> Result<Vec<f64>, Failure> {
    let condition = asset.manifest().conditions.get(condition);
    let condition =
        condition.ok_or(Failure::argument("the texture has no condition of this number"))?;
    let motion =
        condition.speed_mm_s.zip(condition.force_n).map(|(speed, force)| Motion::new(speed, force));
    let representation = asset.representation(model)?;
    let loaded = representation.model()?;
    if loaded.has_lines() {
        return Err(Failure::plain(
            htex_status::HTEX_STATUS_UNSUPPORTED,
            "what is read of lines, only its samples tell: render its voice and measure them",
        ));
    }
    let (parameters, level_rms) = representation.parameters(motion)?;
    let shape = loaded.read_magnitude(&parameters, asset.band()).map_err(htex::Error::from)?;
    Ok(shape.iter().map(|m| m * level_rms).collect())
}

/// Writes the spectrum of the samples that a voice plays at its current motion: one magnitude for
/// each frequency in Hz. `frequency_hz` and `magnitude` may point to the same array.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_voice_magnitude(
    voice: htex_voice,
    frequency_hz: *const f64,
    magnitude: *mut f64,
    len: usize,
) -> htex_status {
    guarded(|| {
        let voice = VOICES.exclusive(voice.id)?;
        // SAFETY: the caller passed this pointer.
        let computed = voice.magnitude(unsafe { slice(frequency_hz, len) }?)?;
        // SAFETY: as above. `frequency_hz` is not used any more.
        unsafe { slice_mut(magnitude, len) }?.copy_from_slice(&computed);
        Ok(())
    })
}

/// Writes, as JSON, how a voice plays a motion, and whether the motion lies within the recorded
/// conditions. NULL for `motion` selects the voice's current motion.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_voice_coverage_json(
    voice: htex_voice,
    motion: *const htex_motion,
    out: *mut c_char,
    capacity: usize,
    length: *mut usize,
) -> htex_status {
    guarded(|| {
        let voice = VOICES.exclusive(voice.id)?;
        // SAFETY: the caller passed these pointers.
        let given = unsafe { crate::motion::motion(motion) }?;
        let asked = given.unwrap_or_else(|| voice.motion()).checked()?;
        let json = coverage_json(&voice.coverage(asked)).to_string();
        // SAFETY: as above.
        unsafe { write_text(&json, out, capacity, length) }
    })
}

fn coverage_json(coverage: &Coverage) -> Value {
    let follows = [coverage.speed, coverage.force].contains(&Reach::Followed);
    let kind = match (coverage.slides, coverage.is_inside()) {
        (false, _) => "silent",
        (true, true) => "inside",
        (true, false) if follows => "followed",
        (true, false) => "outside",
    };
    json!({
        "kind": kind,
        "text": coverage.to_string(),
        "inside": coverage.is_inside(),
        "slides": coverage.slides,
        "excess": coverage.excess(),
        "frequencyFactor": coverage.scaling.frequency,
        "levelFactor": coverage.scaling.level,
        "speed": reach_json(coverage.speed),
        "force": reach_json(coverage.force),
    })
}

fn reach_json(reach: Reach) -> Value {
    match reach {
        Reach::Inside => json!({ "kind": "inside" }),
        Reach::Unknown => json!({ "kind": "unknown" }),
        Reach::Followed => json!({ "kind": "followed" }),
        Reach::Outside { asked, recorded } => {
            json!({ "kind": "outside", "asked": asked, "recorded": recorded })
        }
    }
}
