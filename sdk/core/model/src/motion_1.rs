//! The extension `htex.motion/1`: voices receive the motion of the finger, and fits receive the
//! speed and force of the recording.
//!
//! For a model without the extension, the host scales the frequencies with the speed, and the level
//! with the force. A model with the extension scales the frequencies and the level itself. Its
//! sound can also depend on the finger's position, e.g. for stick-slip, or for a surface that
//! always sounds the same at the same place. Native libraries and WASM modules can both have the
//! extension.

/// Largest speed of a finger, mm/s, in either direction.
pub const MAX_SPEED_MM_S: f64 = 1_000_000.0;
/// Largest normal force of a finger, newtons.
pub const MAX_FORCE_N: f64 = 1_000_000.0;
/// Largest absolute position of a finger along its path, and largest absolute coordinate on the
/// surface, mm.
pub const MAX_POSITION_MM: f64 = 1_000_000_000_000.0;

/// Sets the motion of the finger at a voice's next sample. The arguments are: the speed along the
/// finger's path (mm/s, negative while the position decreases); the normal force (newtons, not
/// negative); the position along the path; and the two coordinates on the surface. The position and
/// the coordinates are in mm. All three may be negative. The speed stays constant until the next
/// call. Returns a status. If the status is negative, the voice continues unchanged. `[render
/// thread, no allocation; one thread at a time for one voice]`
pub type MotionSetFn = unsafe extern "C" fn(
    voice: i64,
    speed_mm_s: f64,
    force_n: f64,
    position_mm: f64,
    x_mm: f64,
    y_mm: f64,
) -> i64;
/// Fits a spectrum as `htex_model_fit` does, and also receives the speed (mm/s) and normal force
/// (newtons) of the recording. Neither number is negative; NaN means unknown. `[any thread]`
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

/// The C functions of the extension.
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
