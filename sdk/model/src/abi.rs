//! The frozen ABI between a host and a model: constants and function signatures.
//!
//! Arguments are scalars, or a pointer and a length. `usize` is the machine's own size: 8 bytes
//! native, 4 in a WASM module. Functions that return text or parameters write to the caller's
//! buffer and return the required length; a caller whose buffer is too small calls again. Negative
//! return values are [`crate::Status`] codes.
//!
//! A native library exports the functions of [`ModelTable`]. A WASM module exports these, its
//! `memory`, and two more by which the host allocates memory for arguments in the module:
//! `htex_model_alloc` ([`AllocFn`]) and `htex_model_free` ([`FreeFn`]). It imports nothing.

/// Major part of the version: a host loads only models of its own major.
pub const ABI_MAJOR: u32 = 1;
/// Minor part: grows with optional exports.
pub const ABI_MINOR: u32 = 0;
/// The marker a model returns: a fixed upper half, then major and minor in a byte each.
pub const ABI_MARKER: u32 = 0x4854_0000 | (ABI_MAJOR << 8) | ABI_MINOR;

/// Most parameters one set may have, lengths of lists included.
pub const MAX_PARAMETERS: usize = 65_536;
/// Most fields a descriptor may have; the least is one.
pub const MAX_FIELDS: usize = 32;
/// Most numbers one list may have.
pub const MAX_LIST_LEN: u32 = 65_535;
/// Most bytes a descriptor or an error text may have.
pub const MAX_TEXT_BYTES: usize = 1_048_576;
/// Fewest bins of a spectrum that is fitted.
pub const MIN_BINS: usize = 3;
/// Highest band edge, hertz.
pub const MAX_BAND_HZ: f64 = 1_000_000.0;
/// Lowest rate of a signal or a voice, hertz.
pub const MIN_RATE_HZ: f64 = 1.0;
/// Highest rate of a signal or a voice, hertz.
pub const MAX_RATE_HZ: f64 = 10_000_000.0;
/// Spacing of the grid on which spectra are fitted and a shape has unit RMS, hertz.
pub const GRID_HZ: f64 = 5.0;
/// Alignment, bytes, of what `htex_model_alloc` returns: enough for every number that crosses.
pub const ALLOC_ALIGN: usize = 16;

/// Returns [`ABI_MARKER`]. `[any thread]`
pub type AbiVersion = extern "C" fn() -> u32;
/// Writes the descriptor as UTF-8 JSON to `out[0..capacity]`; returns its length. `[any thread]`
pub type DescriptorJson = unsafe extern "C" fn(out: *mut u8, capacity: usize) -> i64;
/// Writes the text of the calling thread's last error; returns its length. `[any thread]`
pub type LastError = unsafe extern "C" fn(out: *mut u8, capacity: usize) -> i64;
/// Fits; writes parameters and the level (RMS, in the asset's unit); returns how many parameters
/// there are. `[any thread]`
pub type FitFn = unsafe extern "C" fn(
    band_low_hz: f64,
    band_high_hz: f64,
    frequency_hz: *const f64,
    magnitude: *const f64,
    bins: usize,
    signal: *const f64,
    signal_len: usize,
    signal_rate_hz: f64,
    options: *const f64,
    options_len: usize,
    parameters: *mut f64,
    capacity: usize,
    level_rms: *mut f64,
) -> i64;
/// Writes the shape's magnitude at `bins` frequencies; returns a status. `[any thread]`
pub type MagnitudeFn = unsafe extern "C" fn(
    parameters: *const f64,
    parameters_len: usize,
    band_low_hz: f64,
    band_high_hz: f64,
    frequency_hz: *const f64,
    magnitude: *mut f64,
    bins: usize,
) -> i64;
/// Mixes `weights_len` sets, concatenated in `sets`; returns how many parameters
/// the mix has. `[any thread]`
pub type InterpolateFn = unsafe extern "C" fn(
    sets: *const f64,
    sets_len: usize,
    weights: *const f64,
    weights_len: usize,
    parameters: *mut f64,
    capacity: usize,
) -> i64;
/// Returns the rate at which a voice would render, or a negative status. `[any thread]`
pub type VoiceRateFn = unsafe extern "C" fn(
    parameters: *const f64,
    parameters_len: usize,
    band_low_hz: f64,
    band_high_hz: f64,
    wanted_hz: f64,
) -> f64;
/// Makes a voice; returns its handle, greater than zero. `[any thread]`
pub type VoiceNewFn = unsafe extern "C" fn(
    parameters: *const f64,
    parameters_len: usize,
    band_low_hz: f64,
    band_high_hz: f64,
    rate_hz: f64,
    seed: u64,
) -> i64;
/// Renders `frames` samples; returns a status. `[render thread, no allocation; one thread at a time
/// for one voice]`
pub type VoiceRenderFn = unsafe extern "C" fn(voice: i64, out: *mut f32, frames: usize) -> i64;
/// Retunes; returns a status. `[render thread, no allocation; one thread at a time for one voice]`
pub type VoiceRetuneFn =
    unsafe extern "C" fn(voice: i64, parameters: *const f64, parameters_len: usize) -> i64;
/// Frees a voice; returns a status. `[any thread, not while the voice renders]`
pub type VoiceFreeFn = extern "C" fn(voice: i64) -> i64;
/// Returns 1 if the model has the extension named by UTF-8 `id` (`htex.NAME/REV`,
/// `com.vendor.NAME/REV`), else 0. `[any thread]`
pub type ExtensionFn = unsafe extern "C" fn(id: *const u8, id_len: usize) -> i64;

/// Of a WASM module only, `htex_model_alloc`: allocates `len` bytes, zeroed and aligned to
/// [`ALLOC_ALIGN`]; returns null when memory is exhausted, or when `len` is 0. The host owns the
/// block until it passes it to `htex_model_free`. `[not while another call is in flight]`
pub type AllocFn = extern "C" fn(len: usize) -> *mut u8;
/// Of a WASM module only, `htex_model_free`: frees what `htex_model_alloc` returned for the
/// same `len`; null is allowed and does nothing. `[not while another call is in flight]`
pub type FreeFn = unsafe extern "C" fn(pointer: *mut u8, len: usize);

/// All functions of a model: a static table in a built-in model, filled from the symbols
/// `htex_model_…` of a native library.
#[derive(Clone, Copy)]
#[repr(C)]
#[allow(missing_docs)] // The types document the functions.
pub struct ModelTable {
    pub abi_version: AbiVersion,
    pub descriptor: DescriptorJson,
    pub last_error: LastError,
    pub fit: FitFn,
    pub magnitude: MagnitudeFn,
    pub interpolate: InterpolateFn,
    pub voice_rate: VoiceRateFn,
    pub voice_new: VoiceNewFn,
    pub voice_render: VoiceRenderFn,
    pub voice_retune: VoiceRetuneFn,
    pub voice_free: VoiceFreeFn,
    pub extension: ExtensionFn,
}
