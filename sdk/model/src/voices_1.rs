//! The extension `htex.voices/1`: several voices of one model, rendered in one call.
//!
//! In a recursive filter each sample of a voice depends on the one before, while samples of
//! different voices are independent and can be computed in parallel. A native library exports
//! `htex_voices_1_render`. WASM modules do not have this extension: each of their voices has a
//! separate instance.

/// Most voices that one call takes.
pub const MAX_VOICES: usize = 16;

/// Renders the next `frames` samples of each of `count` different voices, one voice after another,
/// bit-identical to `htex_model_voice_render` of each. Returns a status; after a negative one other
/// than [`Panicked`](crate::Status::Panicked) no voice has advanced.
/// `[render thread, no allocation; one thread at a time for one voice]`
pub type VoicesRenderFn =
    unsafe extern "C" fn(voices: *const i64, count: usize, out: *mut f32, frames: usize) -> i64;

/// The functions of the extension.
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
