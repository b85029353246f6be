//! Voices: a voice plays an asset, and follows the motion of the finger.

use std::ffi::c_char;
use std::ops::{Deref, DerefMut};

use htex::{Texture, Voice, VoiceOptions};

use crate::asset::{ASSETS, htex_asset};
use crate::handles::{Kind, Table};
use crate::motion::{htex_motion, needed_motion};
use crate::options::{htex_voice_options, voice_options};
use crate::pointers::{place, slice_mut, write_text};
use crate::status::{Failure, guarded, htex_status};

/// A texture that is playing. Only one thread at a time may use a voice. An `id` of 0 never stands
/// for a voice.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct htex_voice {
    /// Private.
    pub id: u64,
}

/// A voice, and everything that is needed to restart it.
pub(crate) struct Playing {
    voice: Voice,
    asset: Texture,
    /// Id of the model whose representation plays.
    model: String,
    options: VoiceOptions,
}

impl Playing {
    fn new(asset: &Texture, model: Option<&str>, options: VoiceOptions) -> Result<Self, Failure> {
        let representation = asset.representation(model)?;
        Ok(Self {
            voice: representation.voice(&options)?,
            asset: asset.clone(),
            model: representation.id().to_owned(),
            options,
        })
    }
}

impl Deref for Playing {
    type Target = Voice;

    fn deref(&self) -> &Voice {
        &self.voice
    }
}

impl DerefMut for Playing {
    fn deref_mut(&mut self) -> &mut Voice {
        &mut self.voice
    }
}

/// Level and mean frequency of the samples that a voice played since the last call of
/// htex_voice_envelope. Set `size` to sizeof(htex_envelope) before the call.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct htex_envelope {
    /// sizeof(htex_envelope).
    pub size: u32,
    /// Exact RMS of the samples, in the asset's unit; 0 if there are none.
    pub level_rms: f64,
    /// Mean frequency of the spectrum, weighted by power, Hz; 0 for silence.
    pub centroid_hz: f64,
    /// Number of samples since the last call.
    pub frames: u64,
}

pub(crate) static VOICES: Table<Playing> = Table::new(Kind::Voice);

/// [any thread; may load a model] Makes a voice, which plays an asset. `options` may be NULL for
/// the defaults.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_voice_new(
    asset: htex_asset,
    options: *const htex_voice_options,
    out: *mut htex_voice,
) -> htex_status {
    guarded(|| {
        let asset = ASSETS.shared(asset.id)?;
        // SAFETY: the caller passed these pointers.
        let ((model, options), out) = unsafe { (voice_options(options)?, place(out)?) };
        out.id = VOICES.insert(Playing::new(&asset, model, options)?)?;
        Ok(())
    })
}

/// [one thread at a time; not the real-time thread] Frees a voice.
#[unsafe(no_mangle)]
pub extern "C" fn htex_voice_free(voice: htex_voice) -> htex_status {
    guarded(|| VOICES.remove(voice.id).map(drop))
}

/// [one thread at a time; not the real-time thread] Restarts a voice with the same options and the
/// same handle. The voice then gives the same samples as a new voice. The voice starts at `motion`,
/// or at the motion in its options if `motion` is NULL. If the call fails, the voice is not
/// restarted and continues to play.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_voice_reset(
    voice: htex_voice,
    motion: *const htex_motion,
) -> htex_status {
    guarded(|| {
        let mut voice = VOICES.exclusive(voice.id)?;
        // SAFETY: the caller passed this pointer to a motion.
        let given = unsafe { crate::motion::motion(motion) }?;
        let options = voice.options.clone();
        let options = match given {
            Some(motion) => options.with_motion(motion),
            None => options,
        };
        voice.voice = voice.asset.representation(&voice.model[..])?.voice(&options)?;
        Ok(())
    })
}

/// [one thread at a time] Writes the id of the model that plays. This is the model that the voice's
/// options name, or the model that the library chose if the options name none. `out`, `capacity`
/// and `length` work as in htex_asset_manifest_json.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_voice_model(
    voice: htex_voice,
    out: *mut c_char,
    capacity: usize,
    length: *mut usize,
) -> htex_status {
    guarded(|| {
        let voice = VOICES.exclusive(voice.id)?;
        // SAFETY: the caller passed these pointers.
        unsafe { write_text(&voice.model, out, capacity, length) }
    })
}

/// [one thread at a time; real-time: neither allocates nor locks] Sets the gain, which must not be
/// negative. The voice reaches the new gain within 10 ms.
#[unsafe(no_mangle)]
pub extern "C" fn htex_voice_set_gain(voice: htex_voice, gain: f64) -> htex_status {
    guarded(|| Ok(VOICES.exclusive(voice.id)?.set_gain(gain)?))
}

/// [one thread at a time; real-time: neither allocates nor locks] Writes 1 if the voice is silent,
/// otherwise 0. The samples of a silent voice are 0 until the finger slides again. Rendering a
/// silent voice takes hardly any time.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_voice_is_silent(voice: htex_voice, out: *mut u32) -> htex_status {
    guarded(|| {
        let voice = VOICES.exclusive(voice.id)?;
        // SAFETY: the caller passed this pointer.
        *unsafe { place(out) }? = voice.is_silent().into();
        Ok(())
    })
}

/// [one thread at a time; real-time: neither allocates nor locks] Sets the motion of the finger.
/// The spectrum and the level change gradually until they match the new motion. If the call fails,
/// the voice continues to play the previous motion.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_voice_set_motion(
    voice: htex_voice,
    motion: *const htex_motion,
) -> htex_status {
    guarded(|| {
        let mut voice = VOICES.exclusive(voice.id)?;
        // SAFETY: the caller passed this pointer to a motion.
        let motion = unsafe { needed_motion(motion) }?;
        Ok(voice.set_motion(motion)?)
    })
}

/// [one thread at a time; real-time: neither allocates nor locks] Renders the next `frames`
/// samples, in the asset's unit. Rendering in shorter or longer blocks gives the same samples.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_voice_render(
    voice: htex_voice,
    out: *mut f32,
    frames: usize,
) -> htex_status {
    guarded(|| {
        let mut voice = VOICES.exclusive(voice.id)?;
        // SAFETY: the caller passed this buffer.
        let out = unsafe { slice_mut(out, frames) }?;
        Ok(voice.render(out)?)
    })
}

/// [one thread at a time; real-time: neither allocates nor locks] Renders the next `frames`
/// samples, multiplies them by `gain` and adds them to `out`. Use this call to mix several voices.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_voice_render_add(
    voice: htex_voice,
    out: *mut f32,
    frames: usize,
    gain: f32,
) -> htex_status {
    guarded(|| {
        let mut voice = VOICES.exclusive(voice.id)?;
        // SAFETY: the caller passed this buffer.
        let out = unsafe { slice_mut(out, frames) }?;
        Ok(voice.render_add(out, gain)?)
    })
}

/// [one thread at a time; real-time: neither allocates nor locks] Writes the level and mean
/// frequency of the samples that the voice played since the last call. Both are measured after the
/// voice's effects, gain and limit. Use this call for phones, game controllers and motors that
/// receive a level and a frequency instead of samples. `bands` receives the mean square of the
/// samples in each of the voice's `envelope_bands`, in the asset's unit squared. `bands` may be
/// NULL if `bands_len` is 0.
///
/// The level is exact. The mean frequency and the bands are computed from Hann windows of N
/// samples, where N is the smallest power of two that lasts at least 40 ms (1024 at 20 kHz). A new
/// window ends every N / 4 samples. A window describes the sound at its middle, so the mean
/// frequency and the bands are late by N / 2 samples. A call returns the mean over the windows that
/// ended since the last call. If no window ended since then, the call returns the same values as
/// the last call.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_voice_envelope(
    voice: htex_voice,
    out: *mut htex_envelope,
    bands: *mut f64,
    bands_len: usize,
) -> htex_status {
    guarded(|| {
        let mut voice = VOICES.exclusive(voice.id)?;
        // SAFETY: the caller passed these pointers.
        let (out, bands) = unsafe { (place(out)?, slice_mut(bands, bands_len)?) };
        if (out.size as usize) < size_of::<htex_envelope>() {
            return Err(Failure::argument(
                "the envelope's `size` is wrong; set it to sizeof(htex_envelope)",
            ));
        }
        let envelope = voice.envelope(bands)?;
        out.level_rms = envelope.level_rms;
        out.centroid_hz = envelope.centroid_hz;
        out.frames = envelope.frames;
        Ok(())
    })
}

/// [one thread at a time] Writes the edges of the bands of htex_voice_envelope, Hz. `len` must be
/// the number of bands plus one. The edges go from the lowest to the highest frequency of the
/// asset, and the ratio of neighbouring edges is constant. The first band also includes all
/// frequencies below it, down to 0 Hz. The last band also includes all frequencies above it, up to
/// half the sample rate.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_voice_envelope_edges(
    voice: htex_voice,
    edges_hz: *mut f64,
    len: usize,
) -> htex_status {
    guarded(|| {
        let voice = VOICES.exclusive(voice.id)?;
        // SAFETY: the caller passed this pointer.
        let out = unsafe { slice_mut(edges_hz, len) }?;
        let edges_hz = voice.envelope_edges_hz();
        if out.len() != edges_hz.len() {
            return Err(Failure::argument(
                "there is one edge more than `envelope_bands` of the options, and none without bands",
            ));
        }
        out.copy_from_slice(edges_hz);
        Ok(())
    })
}

/// [one thread at a time; real-time: neither allocates nor locks] Renders a block of `frames`
/// samples for each of `motions_len` motions, in total `motions_len * frames` samples. The call
/// sets each motion just before it renders the block of this motion. It stops at the first error
/// and leaves the remaining samples in `out` unchanged.
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
        let len = motions_len
            .checked_mul(frames)
            .ok_or(Failure::argument("motions_len * frames is too large"))?;
        // SAFETY: the caller passed these arrays.
        let (motions, out) =
            unsafe { (crate::motion::motions(motions, motions_len)?, slice_mut(out, len)?) };
        // `chunks_exact_mut` panics at 0. The motions are set nevertheless.
        if frames == 0 {
            let mut motions = motions;
            return motions.try_for_each(|motion| Ok(voice.set_motion(motion)?));
        }
        for (motion, block) in motions.zip(out.chunks_exact_mut(frames)) {
            voice.set_motion(motion)?;
            voice.render(block)?;
        }
        Ok(())
    })
}

/// [one thread at a time] Writes an English text that states how the voice plays a motion, and
/// whether the motion lies within the recorded conditions. `out`, `capacity` and `length` work as
/// in htex_asset_manifest_json.
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
        // SAFETY: the caller passed these pointers.
        let coverage = voice.coverage(unsafe { needed_motion(motion) }?);
        // SAFETY: as above.
        unsafe { write_text(&coverage.to_string(), out, capacity, length) }
    })
}
