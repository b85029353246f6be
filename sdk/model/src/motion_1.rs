//! The extension `htex.motion/1`: voices receive the motion of the finger, and fits the motion of
//! the recording.
//!
//! For a model without the extension, a host scales frequencies with the speed and the level with
//! the force. A model with the extension does both itself, and can also depend on the position: for
//! stick-slip, or a surface that is the same at the same position. Native libraries and WASM
//! modules may have it.

/// Largest speed of a finger, mm/s, in either direction.
pub const MAX_SPEED_MM_S: f64 = 1_000_000.0;
/// Largest normal force of a finger, newtons.
pub const MAX_FORCE_N: f64 = 1_000_000.0;
/// Largest distance of a finger from the start of its path, and from the origin of its place, mm,
/// in either direction.
pub const MAX_POSITION_MM: f64 = 1_000_000_000_000.0;

/// Sets the motion at a voice's next sample: the speed along the finger's path (mm/s, negative
/// while the position decreases), the normal force (newtons, not negative), the position along the
/// path and the place on the surface (mm, of either sign). The speed is constant until the next
/// call. Returns a status; after a negative one the voice continues unchanged.
/// `[render thread, no allocation; one thread at a time for one voice]`
pub type MotionSetFn = unsafe extern "C" fn(
    voice: i64,
    speed_mm_s: f64,
    force_n: f64,
    position_mm: f64,
    x_mm: f64,
    y_mm: f64,
) -> i64;
/// As `htex_model_fit`, of a recording at a speed (mm/s) and a normal force (newtons), neither
/// negative; NaN means unknown. `[any thread]`
pub type MotionFitFn = unsafe extern "C" fn(
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
    speed_mm_s: f64,
    force_n: f64,
    parameters: *mut f64,
    capacity: usize,
    level_rms: *mut f64,
) -> i64;

/// The functions of the extension.
#[derive(Clone, Copy)]
#[repr(C)]
#[allow(missing_docs)] // The types document the functions.
pub struct MotionTable {
    pub set: MotionSetFn,
    pub fit: MotionFitFn,
}

impl MotionTable {
    /// The extension's id.
    pub const ID: &str = "htex.motion/1";
}
