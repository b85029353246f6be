//! Voices: playing an asset at a motion.

use std::ffi::c_char;

use htex::Voice;

use crate::asset::{ASSETS, htex_asset};
use crate::handles::Table;
use crate::motion::{htex_motion, needed_motion};
use crate::options::{htex_voice_options, voice_options};
use crate::pointers::{place, slice, slice_mut, write_text};
use crate::status::{Failure, guarded, htex_status};

/// A playing texture. One thread at a time may use it. Zero is no voice.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct htex_voice {
    /// Private.
    pub id: u64,
}

static VOICES: Table<Voice> = Table::new();

/// [any thread; may load a model] Makes a voice of an asset. `options` may be NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_voice_new(
    asset: htex_asset,
    options: *const htex_voice_options,
    out: *mut htex_voice,
) -> htex_status {
    guarded(|| {
        let asset = ASSETS.shared(asset.id)?;
        // SAFETY: the pointers are the caller's.
        let (options, out) = unsafe { (voice_options(options)?, place(out)?) };
        out.id = VOICES.insert(asset.voice(&options)?)?;
        Ok(())
    })
}

/// [one thread at a time; not the real-time thread] Frees a voice.
#[unsafe(no_mangle)]
pub extern "C" fn htex_voice_free(voice: htex_voice) -> htex_status {
    guarded(|| VOICES.remove(voice.id).map(drop))
}

/// [one thread at a time; real-time: neither allocates nor locks] Sets the motion of the finger; spectrum and level glide to it.
/// After an error the voice plays on as before.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_voice_set_motion(
    voice: htex_voice,
    motion: *const htex_motion,
) -> htex_status {
    guarded(|| {
        let mut voice = VOICES.exclusive(voice.id)?;
        // SAFETY: the motion is the caller's.
        let motion = unsafe { needed_motion(motion) }?;
        Ok(voice.set_motion(motion)?)
    })
}

/// [one thread at a time; real-time: neither allocates nor locks] Renders the next samples, in the asset's unit. The samples
/// do not depend on the lengths of the blocks.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_voice_render(
    voice: htex_voice,
    out: *mut f32,
    frames: usize,
) -> htex_status {
    guarded(|| {
        let mut voice = VOICES.exclusive(voice.id)?;
        // SAFETY: the buffer is the caller's.
        let out = unsafe { slice_mut(out, frames) }?;
        Ok(voice.render(out)?)
    })
}

/// [one thread at a time; real-time: neither allocates nor locks] Renders a block of `frames` samples for each of `motions_len` motions, which is set
/// before its block: `motions_len * frames` samples. Stops at the first error; the rest of `out` is then unchanged.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_voice_render_path(
    voice: htex_voice,
    motions: *const htex_motion,
    motions_len: usize,
    out: *mut f32,
    frames: usize,
) -> htex_status {
    guarded(|| {
        let mut voice = VOICES.exclusive(voice.id)?;
        let len = motions_len.checked_mul(frames);
        let len = len.ok_or(Failure::argument("motions_len * frames is too large"))?;
        // SAFETY: the arrays are the caller's.
        let (motions, out) = unsafe { (slice(motions, motions_len)?, slice_mut(out, len)?) };
        if frames == 0 {
            return motions
                .iter()
                .try_for_each(|motion| Ok(voice.set_motion((*motion).into())?));
        }
        for (motion, block) in motions.iter().zip(out.chunks_exact_mut(frames)) {
            voice.set_motion((*motion).into())?;
            voice.render(block)?;
        }
        Ok(())
    })
}

/// [one thread at a time] How the voice plays a motion, and whether that is within the recorded conditions, as English text. Written as
/// by htex_asset_manifest_json.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_voice_coverage(
    voice: htex_voice,
    motion: *const htex_motion,
    out: *mut c_char,
    capacity: usize,
    length: *mut usize,
) -> htex_status {
    guarded(|| {
        let voice = VOICES.exclusive(voice.id)?;
        // SAFETY: the pointers are the caller's.
        let coverage = voice.coverage(unsafe { needed_motion(motion) }?);
        // SAFETY: as above.
        unsafe { write_text(&coverage.to_string(), out, capacity, length) }
    })
}
