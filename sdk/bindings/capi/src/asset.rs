//! Assets: opening, inspecting, spectrum and level.

use std::ffi::c_char;

use htex::Texture;

use crate::handles::{Kind, Table};
use crate::motion::{htex_motion, motion};
use crate::options::{Models, htex_open_options, models};
use crate::pointers::{needed_text, place, slice, slice_mut, text, write_text};
use crate::reader::{Reader, htex_reader};
use crate::status::{Failure, guarded, htex_status};

/// An open asset: a texture from a .htex file. Several threads may use an asset at the same time.
/// An `id` of 0 never stands for an asset.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct htex_asset {
    /// Private.
    pub id: u64,
}

/// A recorded condition: a speed and a normal force.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct htex_condition {
    /// Scanning speed, mm/s; NAN if unknown.
    pub speed_mm_s: f64,
    /// Normal force, N; NAN if unknown.
    pub force_n: f64,
}

/// A frequency band.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct htex_band {
    /// Lowest frequency, Hz.
    pub low_hz: f64,
    /// Highest frequency, Hz.
    pub high_hz: f64,
}

pub(crate) static ASSETS: Table<Texture> = Table::new(Kind::Asset);

pub(crate) fn keep(
    data: htex::format::Asset,
    models: Models,
    out: *mut htex_asset,
) -> Result<(), Failure> {
    // SAFETY: the caller passed this pointer.
    let out = unsafe { place(out) }?;
    let asset = Texture::with_registry(data, models.registry);
    let asset = if models.embedded { asset.with_embedded() } else { asset };
    out.id = ASSETS.insert(asset)?;
    Ok(())
}

/// [any thread; reads a file] Opens an asset file. `options` may be NULL for the defaults.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_asset_open(
    path: *const c_char,
    options: *const htex_open_options,
    out: *mut htex_asset,
) -> htex_status {
    guarded(|| {
        // SAFETY: the caller passed these pointers.
        let (path, models) = unsafe { (needed_text(path)?, models(options)?) };
        keep(models.signed.open(path.as_ref())?, models, out)
    })
}

/// [any thread; reads a file] Does the same as htex_asset_open, for a Windows path in UTF-16.
#[cfg(windows)]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_asset_open_wide(
    path: *const u16,
    options: *const htex_open_options,
    out: *mut htex_asset,
) -> htex_status {
    guarded(|| {
        // SAFETY: the caller passed these pointers.
        let (path, models) = unsafe { (crate::pointers::wide_path(path)?, models(options)?) };
        keep(models.signed.open(&path)?, models, out)
    })
}

/// [any thread; calls the reader] Opens an asset whose bytes come from the program's own functions,
/// `reader`. The library closes the reader before the call returns. `options` may be NULL for the
/// defaults.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_asset_open_reader(
    reader: *const htex_reader,
    options: *const htex_open_options,
    out: *mut htex_asset,
) -> htex_status {
    guarded(|| {
        // The reader is made first, so that it is closed if the options are invalid. SAFETY: the
        // caller passed these pointers.
        let (reader, models) = unsafe { (Reader::from_raw(reader)?, models(options)?) };
        let bytes = reader
            .read_whole()
            .map_err(|error| Failure::new(htex_status::HTEX_STATUS_IO, error))?;
        keep(models.signed.read(&bytes)?, models, out)
    })
}

/// [any thread] Opens an asset in memory. The bytes are copied. `options` may be NULL for the
/// defaults.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_asset_from_bytes(
    bytes: *const u8,
    len: usize,
    options: *const htex_open_options,
    out: *mut htex_asset,
) -> htex_status {
    guarded(|| {
        // SAFETY: the caller passed these pointers.
        let (bytes, models) = unsafe { (slice(bytes, len)?, models(options)?) };
        keep(models.signed.read(bytes)?, models, out)
    })
}

/// [any thread] Frees an asset. Voices of this asset continue to play. Returns HTEX_STATUS_BUSY if
/// another thread is using the asset.
#[unsafe(no_mangle)]
pub extern "C" fn htex_asset_free(asset: htex_asset) -> htex_status {
    guarded(|| ASSETS.remove(asset.id).map(drop))
}

/// [any thread] Writes the asset's whole manifest as JSON: name, conditions, representations,
/// measured errors and so on. Writes at most `capacity` bytes to `out`, including a terminating
/// zero. If the text needs more than `capacity` bytes, `out` receives the beginning of the text and
/// the call returns HTEX_STATUS_TRUNCATED. `length` receives the length of the whole text without
/// the zero, and may be NULL. If `capacity` is 0, only the length is written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_asset_manifest_json(
    asset: htex_asset,
    out: *mut c_char,
    capacity: usize,
    length: *mut usize,
) -> htex_status {
    guarded(|| {
        let asset = ASSETS.shared(asset.id)?;
        let json = serde_json::to_string(asset.manifest())
            .map_err(|error| Failure::new(htex_status::HTEX_STATUS_INTERNAL, error))?;
        // SAFETY: the caller passed these pointers.
        unsafe { write_text(&json, out, capacity, length) }
    })
}

/// [any thread] Writes the asset's name. `out`, `capacity` and `length` work as in
/// htex_asset_manifest_json.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_asset_name(
    asset: htex_asset,
    out: *mut c_char,
    capacity: usize,
    length: *mut usize,
) -> htex_status {
    guarded(|| {
        let asset = ASSETS.shared(asset.id)?;
        // SAFETY: the caller passed these pointers.
        unsafe { write_text(&asset.manifest().name, out, capacity, length) }
    })
}

/// [any thread] Writes the unit of the samples, such as "N". `out`, `capacity` and `length` work as
/// in htex_asset_manifest_json.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_asset_unit(
    asset: htex_asset,
    out: *mut c_char,
    capacity: usize,
    length: *mut usize,
) -> htex_status {
    guarded(|| {
        let unit = ASSETS.shared(asset.id)?.quantity().unit();
        // SAFETY: the caller passed these pointers.
        unsafe { write_text(unit, out, capacity, length) }
    })
}

/// [any thread] Writes the frequency band of the asset's spectra.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_asset_band(asset: htex_asset, out: *mut htex_band) -> htex_status {
    guarded(|| {
        let band = ASSETS.shared(asset.id)?.band();
        // SAFETY: the caller passed this pointer.
        *unsafe { place(out) }? = htex_band { low_hz: band.low_hz, high_hz: band.high_hz };
        Ok(())
    })
}

/// [any thread] Writes the number of recorded conditions.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_asset_condition_count(
    asset: htex_asset,
    out: *mut usize,
) -> htex_status {
    guarded(|| {
        let asset = ASSETS.shared(asset.id)?;
        // SAFETY: the caller passed this pointer.
        *unsafe { place(out) }? = asset.manifest().conditions.len();
        Ok(())
    })
}

/// [any thread] Writes the recorded condition at `index`. Indices start at 0.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_asset_condition(
    asset: htex_asset,
    index: usize,
    out: *mut htex_condition,
) -> htex_status {
    guarded(|| {
        let asset = ASSETS.shared(asset.id)?;
        let condition = asset.manifest().conditions.get(index);
        let condition = condition.ok_or(Failure::argument(
            "no condition of this index; htex_asset_condition_count tells how many there are",
        ))?;
        // SAFETY: the caller passed this pointer.
        *unsafe { place(out) }? = htex_condition {
            speed_mm_s: condition.speed_mm_s.unwrap_or(f64::NAN),
            force_n: condition.force_n.unwrap_or(f64::NAN),
        };
        Ok(())
    })
}

/// [any thread] Writes the number of representations. A representation is one model fitted to the
/// asset's recording.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_asset_representation_count(
    asset: htex_asset,
    out: *mut usize,
) -> htex_status {
    guarded(|| {
        let asset = ASSETS.shared(asset.id)?;
        // SAFETY: the caller passed this pointer.
        *unsafe { place(out) }? = asset.manifest().representations.len();
        Ok(())
    })
}

/// [any thread] Writes the model id of the representation at `index`, such as "org.htex.bands".
/// Indices start at 0. `out`, `capacity` and `length` work as in htex_asset_manifest_json.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_asset_representation_model(
    asset: htex_asset,
    index: usize,
    out: *mut c_char,
    capacity: usize,
    length: *mut usize,
) -> htex_status {
    guarded(|| {
        let asset = ASSETS.shared(asset.id)?;
        let representation = asset.manifest().representations.get(index);
        let representation = representation.ok_or(Failure::argument(
            "no representation of this index; htex_asset_representation_count tells how many there are",
        ))?;
        // SAFETY: the caller passed these pointers.
        unsafe { write_text(&representation.model, out, capacity, length) }
    })
}

/// [any thread; may load a model] Writes the spectrum of the samples that a voice of this asset
/// plays. `magnitude` receives one magnitude, in the asset's unit, for each of the `len`
/// frequencies in Hz. `model` is the id or short name of the representation's model; NULL selects
/// the representation with the smallest error. `at` is the motion; NULL selects the first recorded
/// condition, or the strongest one if the first is silent. Between recorded conditions, the
/// magnitudes are interpolated. Outside the recorded conditions, the magnitudes follow the asset's
/// law, which states how frequency and level change with speed and force. While the finger does not
/// slide, all magnitudes are 0.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_asset_magnitude(
    asset: htex_asset,
    model: *const c_char,
    at: *const htex_motion,
    frequency_hz: *const f64,
    magnitude: *mut f64,
    len: usize,
) -> htex_status {
    guarded(|| {
        let asset = ASSETS.shared(asset.id)?;
        // SAFETY: the caller passed these pointers.
        let (model, at) = unsafe { (text(model)?, motion(at)?) };
        // SAFETY: as above.
        let frequency_hz = unsafe { slice(frequency_hz, len) }?;
        let computed = asset.representation(model)?.magnitude(at, frequency_hz)?;
        // SAFETY: as above. `frequency_hz` is not used any more, and may be the same array.
        let magnitude = unsafe { slice_mut(magnitude, len) }?;
        magnitude.copy_from_slice(&computed);
        Ok(())
    })
}

/// [any thread; may load a model] Writes the level at which a representation plays: the RMS of the
/// samples, in the asset's unit. `model` and `at` work as in htex_asset_magnitude.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_asset_level_rms(
    asset: htex_asset,
    model: *const c_char,
    at: *const htex_motion,
    out: *mut f64,
) -> htex_status {
    guarded(|| {
        let asset = ASSETS.shared(asset.id)?;
        // SAFETY: the caller passed these pointers.
        let (model, at) = unsafe { (text(model)?, motion(at)?) };
        let level_rms = asset.representation(model)?.level_rms(at)?;
        // SAFETY: the caller passed this pointer.
        *unsafe { place(out) }? = level_rms;
        Ok(())
    })
}
