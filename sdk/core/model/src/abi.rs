//! The frozen C ABI between a host and a model: constants and function signatures.
//!
//! Arguments are scalars, or a pointer and a length. The size of `usize` is 8 bytes in a native
//! library on a 64-bit machine, and 4 bytes in a WASM module. Functions that return text or
//! parameters write to the caller's buffer and return the length that they need. If the buffer is
//! too small, the caller calls again with a larger one. Negative return values are
//! [`crate::Status`] codes.
//!
//! A native library exports the functions of [`ModelTable`]. A WASM module exports these functions,
//! its `memory`, and two more functions with which the host allocates memory for arguments:
//! `htex_model_alloc` ([`AllocFn`]) and `htex_model_free` ([`FreeFn`]). A WASM module imports
//! nothing.

/// Major version. A host loads a model only if both use the same major version of the ABI.
pub const ABI_MAJOR: u32 = 1;
/// Minor version. Every new optional export increases the minor version.
pub const ABI_MINOR: u32 = 0;
/// The version marker of the ABI, which a model returns. The upper 16 bits are fixed, the next 8
/// bits are the major version, and the lowest 8 bits are the minor version.
pub const ABI_MARKER: u32 = 0x4854_0000 | (ABI_MAJOR << 8) | ABI_MINOR;

/// Largest number of parameters in one set, including the lengths of lists.
pub const MAX_PARAMETERS: usize = 65_536;
/// Largest number of fields in a descriptor. A descriptor has at least one field.
pub const MAX_FIELDS: usize = 32;
/// Largest number of values in one list.
pub const MAX_LIST_LEN: u32 = 65_535;
/// Largest size of a descriptor or an error text, bytes.
pub const MAX_TEXT_BYTES: usize = 1_048_576;
/// Smallest number of bins that a spectrum must have for a fit.
pub const MIN_BINS: usize = 3;
/// Highest band edge, hertz.
pub const MAX_BAND_HZ: f64 = 1_000_000.0;
/// Lowest rate of a signal or a voice, hertz.
pub const MIN_RATE_HZ: f64 = 1.0;
/// Highest rate of a signal or a voice, hertz.
pub const MAX_RATE_HZ: f64 = 10_000_000.0;
/// Spacing of the frequency grid, hertz. Models fit spectra on this grid, and the RMS of a shape
/// over this grid is 1.
pub const GRID_HZ: f64 = 5.0;
/// Alignment of the memory that `htex_model_alloc` returns, bytes: enough for every number of the
/// ABI.
pub const ALLOC_ALIGN: usize = 16;

/// Returns [`ABI_MARKER`]. `[any thread]`
pub type AbiVersion = extern "C" fn() -> u32;
/// Writes the descriptor as UTF-8 JSON to `out[0..capacity]`; returns its full length. `[any
/// thread]`
pub type DescriptorJson = unsafe extern "C" fn(out: *mut u8, capacity: usize) -> i64;
/// Writes the error text of the calling thread's last failed call; returns the text's full length.
/// `[any thread]`
pub type LastError = unsafe extern "C" fn(out: *mut u8, capacity: usize) -> i64;
/// Fits a spectrum. Writes the parameters and the level (RMS, in the asset's unit), and returns the
/// number of parameters. `[any thread]`
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
/// Writes the magnitude of the shape at `bins` frequencies; returns a status. `[any thread]`
pub type MagnitudeFn = unsafe extern "C" fn(
    parameters: *const f64,
    parameters_len: usize,
    band_low_hz: f64,
    band_high_hz: f64,
    frequency_hz: *const f64,
    magnitude: *mut f64,
    bins: usize,
) -> i64;
/// Interpolates `weights_len` parameter sets, which are concatenated in `sets`. Returns the number
/// of parameters in the result. `[any thread]`
pub type InterpolateFn = unsafe extern "C" fn(
    sets: *const f64,
    sets_len: usize,
    weights: *const f64,
    weights_len: usize,
    parameters: *mut f64,
    capacity: usize,
) -> i64;
/// Returns the rate at which a voice would render, in hertz, or a negative status. `[any thread]`
pub type VoiceRateFn = unsafe extern "C" fn(
    parameters: *const f64,
    parameters_len: usize,
    band_low_hz: f64,
    band_high_hz: f64,
    wanted_hz: f64,
) -> f64;
/// Makes a voice. Returns its handle, which is above zero, or a negative status. `[any thread]`
pub type VoiceNewFn = unsafe extern "C" fn(
    parameters: *const f64,
    parameters_len: usize,
    band_low_hz: f64,
    band_high_hz: f64,
    rate_hz: f64,
    seed: u64,
) -> i64;
/// Renders the next `frames` samples; returns a status. `[render thread, no allocation; one thread
/// at a time for one voice]`
pub type VoiceRenderFn = unsafe extern "C" fn(voice: i64, out: *mut f32, frames: usize) -> i64;
/// Changes a voice's parameters; returns a status. `[render thread, no allocation; one thread at a
/// time for one voice]`
pub type VoiceRetuneFn =
    unsafe extern "C" fn(voice: i64, parameters: *const f64, parameters_len: usize) -> i64;
/// Frees a voice; returns a status. `[any thread, not while the voice renders]`
pub type VoiceFreeFn = extern "C" fn(voice: i64) -> i64;
/// Returns 1 if the model has the extension with this UTF-8 `id` (`htex.NAME/REV` or
/// `com.vendor.NAME/REV`), otherwise 0. `[any thread]`
pub type ExtensionFn = unsafe extern "C" fn(id: *const u8, id_len: usize) -> i64;

/// `htex_model_alloc`, only in WASM modules: allocates `len` bytes, zeroed and aligned to
/// [`ALLOC_ALIGN`]. Returns null if memory is exhausted or `len` is 0. The block belongs to the
/// host until the host frees it with `htex_model_free`. `[not while another call is in flight]`
pub type AllocFn = extern "C" fn(len: usize) -> *mut u8;
/// `htex_model_free`, only in WASM modules: frees memory that `htex_model_alloc` returned for the
/// same `len`. Null is allowed and does nothing. `[not while another call is in flight]`
pub type FreeFn = unsafe extern "C" fn(pointer: *mut u8, len: usize);

/// All C functions of a model. A built-in model has a static table; for a native library, the host
/// fills the table from the library's symbols `htex_model_…`.
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
