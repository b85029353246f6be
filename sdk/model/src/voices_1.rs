//! The extension `htex.voices/1`: several voices of one model, rendered in one call.
//!
//! Samples of one voice wait for each other in filters that feed back; those of several do not. A
//! native library exports `htex_voices_1_render`. WASM modules do not have this extension: each of their
//! voices is an instance of its own.

/// Most voices that one call takes.
pub const MAX_VOICES: usize = 16;

/// Renders the next `frames` samples of each of `count` voices, which differ, one voice behind the
/// other: the samples that `htex_model_voice_render` gives of each, to the bit. Returns a status; after
/// a negative one no voice has moved on, but after [`Panicked`](crate::Status::Panicked).
/// `[render thread, no allocation; one thread at a time for one voice]`
pub type VoicesRenderFn =
    unsafe extern "C" fn(voices: *const i64, count: usize, out: *mut f32, frames: usize) -> i64;

/// What the extension adds to the exports.
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
