//! The extension `htex.voices/1`: renders several voices of one model in one call.
//!
//! In a recursive filter, each sample of a voice depends on the sample before it. Samples of
//! different voices are independent, so a processor can compute them in parallel. A native library
//! with this extension exports `htex_voices_1_render`. WASM modules do not have this extension,
//! because each of their voices has its own instance.

/// Largest number of voices in one call.
pub const MAX_VOICES: usize = 16;

/// Renders the next `frames` samples of each of `count` different voices, one voice after another.
/// The samples must be bit-identical to the samples of `htex_model_voice_render`. Returns a status.
/// If the status is negative, and is not [`Panicked`](crate::Status::Panicked), no voice has
/// advanced. `[render thread, no allocation; one thread at a time for one voice]`
pub type VoicesRenderFn =
    unsafe extern "C" fn(voices: *const i64, count: usize, out: *mut f32, frames: usize) -> i64;

/// The C function of the extension.
#[derive(Clone, Copy)]
#[repr(C)]
#[allow(missing_docs)] // The type documents the function.
pub struct VoicesTable {
    pub render: VoicesRenderFn,
}

impl VoicesTable {
    /// The extension's id.
    pub const ID: &str = "htex.voices/1";
}
