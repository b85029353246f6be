//! Motions as C has them.

use htex::Motion;

use crate::pointers::slice;
use crate::status::Failure;

/// Motion of a finger over a texture, at one moment.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct htex_motion {
    /// Scanning speed, mm/s; finite and not negative.
    pub speed_mm_s: f64,
    /// Normal force, N; finite and not negative.
    pub force_n: f64,
    /// Position along the path, mm, of either sign; NAN if it is not known. Only models that follow the position use
    /// it.
    pub position_mm: f64,
    /// Place on the surface, x and y, mm, of either sign; NAN, either or both, if it is not known. Only models that are maps of
    /// a surface use it.
    pub x_mm: f64,
    /// As `x_mm`, across it.
    pub y_mm: f64,
}

impl From<htex_motion> for Motion {
    fn from(motion: htex_motion) -> Self {
        let speed_and_force = Self::new(motion.speed_mm_s, motion.force_n);
        let on_path = match motion.position_mm.is_nan() {
            true => speed_and_force,
            false => speed_and_force.with_position_mm(motion.position_mm),
        };
        match motion.x_mm.is_nan() || motion.y_mm.is_nan() {
            true => on_path,
            false => on_path.with_place_mm(motion.x_mm, motion.y_mm),
        }
    }
}

/// The motion at `pointer`; `None` for NULL.
///
/// # Safety
/// As [`slice`].
pub(crate) unsafe fn motion(pointer: *const htex_motion) -> Result<Option<Motion>, Failure> {
    if pointer.is_null() {
        return Ok(None);
    }
    // SAFETY: as here.
    let motions = unsafe { slice(pointer, 1) }?;
    Ok(motions.first().map(|motion| (*motion).into()))
}

/// The motion at `pointer`, which must be there.
///
/// # Safety
/// As [`slice`].
pub(crate) unsafe fn needed_motion(pointer: *const htex_motion) -> Result<Motion, Failure> {
    // SAFETY: as here.
    unsafe { motion(pointer) }?.ok_or(Failure::argument("the motion is NULL"))
}
