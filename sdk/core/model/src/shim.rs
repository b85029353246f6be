//! The layer between the C functions and the traits: it checks arguments and turns panics into
//! errors.
//!
//! The functions that [`export_model!`](crate::export_model) generates call this layer. Hosts also
//! call functions of this layer, for models that are Rust objects without C functions.

use alloc::alloc::Layout;
use core::marker::PhantomData;

use crate::abi::ALLOC_ALIGN;
use crate::arguments::{
    band, check_fit, check_fit_input, check_handles, check_rate, finite, interpolate,
};
use crate::motion_1::MotionTable;
use crate::platform::{caught, with_last_error};
use crate::voices::Voices;
use crate::voices_1::{MAX_VOICES, VoicesTable};
use crate::{
    Error, Fit, FitCondition, FitInput, Model, Motion, MotionVoice, StaticDescriptor, Status,
    Values, Voice, text,
};

/// State of one exported model: its descriptor as JSON, and its voices.
pub struct State<M: Model> {
    json: &'static [u8],
    voices: Voices<M::Voice>,
    model: PhantomData<fn() -> M>,
}

/// An input array: a pointer and a length from the host.
#[derive(Clone, Copy)]
pub struct Input<'a, T>(Option<&'a [T]>);

impl<'a, T> Input<'a, T> {
    /// Wraps the host's pointer and length. If `len` is above 0 and the pointer is null or
    /// misaligned, the call that uses the value fails with [`Status::InvalidArgument`].
    ///
    /// # Safety
    /// `pointer` must be null, or `len` values must be readable at `pointer` for `'a`.
    pub unsafe fn new(pointer: *const T, len: usize) -> Self {
        // C callers may pass null for an empty array, but a slice must not be null.
        if len == 0 {
            return Self(Some(&[]));
        }
        let usable = !pointer.is_null() && pointer.is_aligned() && fits::<T>(len);
        // SAFETY: not null, aligned, not longer than memory; the caller guarantees that it is
        // readable.
        Self(usable.then(|| unsafe { core::slice::from_raw_parts(pointer, len) }))
    }

    fn get(self, name: &str) -> Result<&'a [T], Error> {
        self.0.ok_or_else(|| unusable(name, "array"))
    }
}

impl<'a, T> From<&'a [T]> for Input<'a, T> {
    fn from(values: &'a [T]) -> Self {
        Self(Some(values))
    }
}

/// An output buffer: a pointer and a length from the host.
pub struct Output<'a, T>(Option<&'a mut [T]>);

impl<'a, T> Output<'a, T> {
    /// Wraps the host's pointer and length. If `len` is above 0 and the pointer is null or
    /// misaligned, the call that uses the value fails with [`Status::InvalidArgument`].
    ///
    /// # Safety
    /// `pointer` must be null, or it must point to `len` initialised values that can be written for
    /// `'a`, with exclusive access.
    pub unsafe fn new(pointer: *mut T, len: usize) -> Self {
        if len == 0 {
            return Self(Some(&mut []));
        }
        let usable = !pointer.is_null() && pointer.is_aligned() && fits::<T>(len);
        // SAFETY: not null, aligned, not longer than memory; the caller guarantees exclusive
        // access.
        Self(usable.then(|| unsafe { core::slice::from_raw_parts_mut(pointer, len) }))
    }

    fn get(self, name: &str) -> Result<&'a mut [T], Error> {
        self.0.ok_or_else(|| unusable(name, "buffer"))
    }
}

impl<'a, T> From<&'a mut [T]> for Output<'a, T> {
    fn from(values: &'a mut [T]) -> Self {
        Self(Some(values))
    }
}

fn unusable(name: &str, kind: &str) -> Error {
    Error::argument(text!["`", name, "` is not a usable ", kind])
}

fn fits<T>(len: usize) -> bool {
    len <= isize::MAX as usize / size_of::<T>().max(1)
}

/// The arguments of `htex_model_fit`.
#[allow(missing_docs)] // Named as in `abi::FitFn`.
pub struct FitCall<'a> {
    pub band: (f64, f64),
    pub frequency_hz: Input<'a, f64>,
    pub magnitude: Input<'a, f64>,
    pub signal: Input<'a, f64>,
    pub signal_rate_hz: f64,
    pub options: Input<'a, f64>,
    pub parameters: Output<'a, f64>,
    pub level_rms: Output<'a, f64>,
}

impl<M: Model> State<M> {
    /// Makes a state without voices; `json` is the model's descriptor.
    pub const fn new(json: &'static [u8]) -> Self {
        Self { json, voices: Voices::new(), model: PhantomData }
    }

    fn values<'a>(&self, parameters: Input<'a, f64>) -> Result<Values<'a>, Error> {
        values(&M::DESCRIPTOR, parameters)
    }

    /// See [`crate::abi::DescriptorJson`].
    pub fn descriptor(&self, out: Output<'_, u8>) -> i64 {
        guarded(|| Ok(copy(self.json, out.get("out")?)))
    }

    /// See [`crate::abi::FitFn`].
    pub fn fit(&self, call: FitCall<'_>) -> i64 {
        guarded(|| fit(&M::DESCRIPTOR, M::fit, call, FitCondition::default()))
    }

    /// See [`crate::motion_1::MotionFitFn`].
    pub fn motion_fit(&self, call: FitCall<'_>, speed_mm_s: f64, force_n: f64) -> i64 {
        guarded(|| {
            let condition = FitCondition::from_numbers(speed_mm_s, force_n)?;
            fit(&M::DESCRIPTOR, M::fit, call, condition)
        })
    }

    /// See [`crate::abi::MagnitudeFn`].
    pub fn magnitude(
        &self,
        parameters: Input<'_, f64>,
        band_hz: (f64, f64),
        frequency_hz: Input<'_, f64>,
        magnitude: Output<'_, f64>,
    ) -> i64 {
        guarded(|| {
            let frequency_hz = frequency_hz.get("frequency_hz")?;
            let values = self.values(parameters)?;
            finite("frequency_hz", frequency_hz)?;
            let magnitude = magnitude.get("magnitude")?;
            M::magnitude(&values, band(band_hz)?, frequency_hz, magnitude)?;
            Ok(0)
        })
    }

    /// See [`crate::abi::InterpolateFn`].
    pub fn interpolate(
        &self,
        sets: Input<'_, f64>,
        weights: Input<'_, f64>,
        parameters: Output<'_, f64>,
    ) -> i64 {
        guarded(|| {
            let (sets, weights) = (sets.get("sets")?, weights.get("weights")?);
            let parameters = parameters.get("parameters")?;
            interpolate(&M::DESCRIPTOR, &M::interpolate, sets, weights, parameters)
        })
    }

    /// See [`crate::abi::VoiceRateFn`].
    pub fn voice_rate(&self, parameters: Input<'_, f64>, band_hz: (f64, f64), wanted: f64) -> f64 {
        let mut rate_hz = 0.0;
        let status = guarded(|| {
            check_rate(wanted)?;
            rate_hz = M::voice_rate_hz(&self.values(parameters)?, band(band_hz)?, wanted);
            check_rate(rate_hz).map(|()| 0)
        });
        if status < 0 { status as f64 } else { rate_hz }
    }

    /// See [`crate::abi::VoiceNewFn`].
    pub fn voice_new(
        &self,
        parameters: Input<'_, f64>,
        band_hz: (f64, f64),
        rate_hz: f64,
        seed: u64,
    ) -> i64 {
        guarded(|| {
            check_rate(rate_hz)?;
            // The slot is taken last. If the voice cannot be made, no slot remains occupied.
            let voice = M::voice(&self.values(parameters)?, band(band_hz)?, rate_hz, seed)?;
            self.voices.insert(voice).ok_or_else(|| {
                Error::new(Status::TooManyVoices, "no more voices can be made; free some voices")
            })
        })
    }

    /// See [`crate::abi::VoiceRenderFn`].
    ///
    /// # Safety
    /// During the call, no other thread may use or free this voice.
    pub unsafe fn voice_render(&self, handle: i64, out: Output<'_, f32>) -> i64 {
        guarded(|| {
            let out = out.get("out")?;
            // SAFETY: guaranteed by the caller.
            let voice = unsafe { self.voices.get(handle) }.ok_or_else(bad_handle)?;
            voice.render(out);
            Ok(0)
        })
    }

    /// See [`crate::voices_1::VoicesRenderFn`].
    ///
    /// # Safety
    /// During the call, no other thread may use or free these voices.
    pub unsafe fn voices_render(
        &self,
        handles: Input<'_, i64>,
        frames: usize,
        out: Output<'_, f32>,
    ) -> i64 {
        guarded(|| {
            let (handles, out) = (handles.get("voices")?, out.get("out")?);
            check_handles(handles)?;
            let mut voices = [core::ptr::null_mut::<M::Voice>(); MAX_VOICES];
            for (voice, &handle) in voices.iter_mut().zip(handles) {
                // SAFETY: guaranteed by the caller; no handle occurs twice.
                *voice = unsafe { self.voices.get(handle) }.ok_or_else(bad_handle)?;
            }
            let voices = voices.as_mut_ptr().cast::<&mut M::Voice>();
            // SAFETY: each pointer was just made from a reference, one for each handle, and each
            // reference is to a different voice. The pointers are used only as these references.
            let voices = unsafe { core::slice::from_raw_parts_mut(voices, handles.len()) };
            M::Voice::render_together(voices, frames, out);
            Ok(0)
        })
    }

    /// See [`crate::abi::VoiceRetuneFn`].
    ///
    /// # Safety
    /// During the call, no other thread may use or free this voice.
    pub unsafe fn voice_retune(&self, handle: i64, parameters: Input<'_, f64>) -> i64 {
        guarded(|| {
            let values = self.values(parameters)?;
            // SAFETY: guaranteed by the caller.
            let voice = unsafe { self.voices.get(handle) }.ok_or_else(bad_handle)?;
            voice.retune(&values)?;
            Ok(0)
        })
    }

    /// See [`crate::abi::VoiceFreeFn`].
    pub fn voice_free(&self, handle: i64) -> i64 {
        guarded(|| {
            self.voices.remove(handle).ok_or_else(bad_handle)?;
            Ok(0)
        })
    }
}

impl<M: Model<Voice: MotionVoice>> State<M> {
    /// See [`crate::motion_1::MotionSetFn`].
    ///
    /// # Safety
    /// During the call, no other thread may use or free this voice.
    pub unsafe fn motion_set(&self, handle: i64, motion: Motion) -> i64 {
        guarded(|| {
            motion.check()?;
            // SAFETY: guaranteed by the caller.
            let voice = unsafe { self.voices.get(handle) }.ok_or_else(bad_handle)?;
            voice.set_motion(motion);
            Ok(0)
        })
    }
}

fn values<'a>(
    descriptor: &StaticDescriptor,
    parameters: Input<'a, f64>,
) -> Result<Values<'a>, Error> {
    Values::read(descriptor, parameters.get("parameters")?)
}

/// Fits with the model's own function. This function is not generic, so a WASM module contains it
/// only once, compiled at the optimisation level of this crate.
fn fit(
    descriptor: &StaticDescriptor,
    own: fn(&FitInput<'_>) -> Result<Fit, Error>,
    call: FitCall<'_>,
    condition: FitCondition,
) -> Result<i64, Error> {
    let input = FitInput {
        band: band(call.band)?,
        frequency_hz: call.frequency_hz.get("frequency_hz")?,
        magnitude: call.magnitude.get("magnitude")?,
        signal: call.signal.get("signal")?,
        signal_rate_hz: call.signal_rate_hz,
        options: call.options.get("options")?,
        condition,
    };
    check_fit_input(&input, descriptor)?;
    let fit = own(&input)?;
    check_fit(&fit, descriptor)?;
    let level = call.level_rms.get("level_rms")?;
    if let Some(level) = level.first_mut() {
        *level = fit.level_rms;
    }
    Ok(copy(&fit.parameters, call.parameters.get("parameters")?))
}

/// See [`crate::abi::AllocFn`].
pub fn alloc(len: usize) -> *mut u8 {
    match layout(len) {
        // SAFETY: the layout's size is not zero.
        Some(layout) => unsafe { alloc::alloc::alloc_zeroed(layout) },
        None => core::ptr::null_mut(),
    }
}

/// See [`crate::abi::FreeFn`].
///
/// # Safety
/// `pointer` must be null, or it must come from a call of [`alloc`](alloc()) with the same `len`
/// and must not have been freed since.
pub unsafe fn free(pointer: *mut u8, len: usize) {
    if let (false, Some(layout)) = (pointer.is_null(), layout(len)) {
        // SAFETY: guaranteed by the caller; the allocation had the same layout.
        unsafe { alloc::alloc::dealloc(pointer, layout) }
    }
}

fn layout(len: usize) -> Option<Layout> {
    let layout = Layout::from_size_align(len, ALLOC_ALIGN).ok()?;
    (len > 0).then_some(layout)
}

/// See [`crate::abi::LastError`].
pub fn last_error(out: Output<'_, u8>) -> i64 {
    // `guarded` is not used here, because it would replace the text that the caller asks for.
    let Some(out) = out.0 else {
        return Status::InvalidArgument as i64;
    };
    with_last_error(|text| copy(text.as_bytes(), out)).unwrap_or(0)
}

/// Returns 1 if the model has the extension `id`, otherwise 0; see [`crate::abi::ExtensionFn`].
/// `motion` says whether the model has the extension `htex.motion/1`.
pub fn extension(id: Input<'_, u8>, motion: bool) -> i64 {
    let is = |known: &str| id.0 == Some(known.as_bytes());
    let voices = is(VoicesTable::ID) && !cfg!(target_family = "wasm");
    i64::from(voices || motion && is(MotionTable::ID))
}

/// Runs a call and returns its result. If the call returns an error or panics, stores the error
/// text for `htex_model_last_error` and returns the status.
pub fn guarded(call: impl FnOnce() -> Result<i64, Error>) -> i64 {
    caught(call).unwrap_or_else(failed)
}

/// Stores the text of an error and returns its status.
fn failed(error: Error) -> i64 {
    with_last_error(|text| *text = error.message);
    error.status as i64
}

fn bad_handle() -> Error {
    Error::new(Status::BadHandle, "no such voice; it may have been freed")
}

/// Copies as many values as fit into `out`. Returns the number of values in `from`.
pub fn copy<T: Copy>(from: &[T], out: &mut [T]) -> i64 {
    for (out, from) in out.iter_mut().zip(from) {
        *out = *from;
    }
    from.len() as i64
}

#[cfg(test)]
mod tests;
