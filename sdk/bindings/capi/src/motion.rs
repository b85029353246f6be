//! The C struct for a motion, and its conversion.

use std::mem::offset_of;

use htex::Motion;

use crate::pointers::slice;
use crate::status::Failure;

/// Motion of a finger over a texture at one moment. Later versions may add optional values at the
/// end. If a program was compiled against an older header, the values that this header lacks count
/// as unknown.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct htex_motion {
    /// sizeof(htex_motion).
    pub size: u32,
    /// Scanning speed, mm/s; finite and not negative.
    pub speed_mm_s: f64,
    /// Normal force, N; finite and not negative.
    pub force_n: f64,
    /// Position along the finger's path, mm, positive or negative; NAN if unknown. Only models that
    /// follow the position use this value.
    pub position_mm: f64,
    /// Place on the surface: coordinate x, mm, positive or negative. If `x_mm` or `y_mm` is NAN,
    /// the place is unknown. Only models that contain a map of the surface use the place.
    pub x_mm: f64,
    /// Coordinate y of the place, mm, at a right angle to `x_mm`.
    pub y_mm: f64,
}

impl From<htex_motion> for Motion {
    fn from(motion: htex_motion) -> Self {
        let htex_motion { speed_mm_s, force_n, position_mm, x_mm, y_mm, .. } = motion;
        let is_placed = !(x_mm.is_nan() || y_mm.is_nan());
        let motion =
            Self::new(speed_mm_s, force_n).with_place_mm(is_placed.then_some([x_mm, y_mm]));
        if position_mm.is_nan() { motion } else { motion.with_position_mm(position_mm) }
    }
}

const UNKNOWN: htex_motion = htex_motion {
    size: 0,
    speed_mm_s: f64::NAN,
    force_n: f64::NAN,
    position_mm: f64::NAN,
    x_mm: f64::NAN,
    y_mm: f64::NAN,
};

/// Allowed values of a motion's `size`, bytes. Every version has at least speed and force.
// The upper end leaves room for later fields, and refuses a size that was never set.
const SIZES: std::ops::RangeInclusive<usize> = offset_of!(htex_motion, position_mm)..=256;

/// Returns an array of motions from C. The program may have been compiled against a version of the
/// struct that is shorter or longer than this one.
///
/// # Safety
/// The same rules apply as for [`slice`]; each motion has the size that the first motion states.
/// The motions must stay valid as long as the iterator.
pub(crate) unsafe fn motions(
    pointer: *const htex_motion,
    len: usize,
) -> Result<impl Iterator<Item = Motion>, Failure> {
    let first = pointer.cast::<u8>();
    let mut size = 0;
    if len > 0 {
        if pointer.is_null() || !pointer.is_aligned() {
            return Err(Failure::argument("a motion is NULL or misaligned"));
        }
        // SAFETY: a motion begins with its size.
        size = unsafe { pointer.cast::<u32>().read() } as usize;
        // Another size would misalign the second motion of an array.
        if !SIZES.contains(&size) || !size.is_multiple_of(align_of::<htex_motion>()) {
            return Err(Failure::argument(
                "the motion's `size` is wrong; set it to sizeof(htex_motion)",
            ));
        }
        // SAFETY: as many motions of this size are there.
        unsafe { slice(first, len.saturating_mul(size)) }?;
    }
    Ok((0..len).map(move |index| {
        let mut motion = UNKNOWN;
        // SAFETY: the caller's motion and this motion both have at least this number of bytes, and
        // both contain only numbers.
        unsafe {
            let from = first.add(index * size);
            let to = (&raw mut motion).cast::<u8>();
            to.copy_from_nonoverlapping(from, size.min(size_of::<htex_motion>()));
        }
        motion.into()
    }))
}

/// Returns the motion at `pointer`; `None` for NULL.
///
/// # Safety
/// As [`motions`].
pub(crate) unsafe fn motion(pointer: *const htex_motion) -> Result<Option<Motion>, Failure> {
    if pointer.is_null() {
        return Ok(None);
    }
    // SAFETY: as here.
    Ok(unsafe { motions(pointer, 1) }?.next())
}

/// Returns the motion at `pointer`, which must not be NULL.
///
/// # Safety
/// As [`motions`].
pub(crate) unsafe fn needed_motion(pointer: *const htex_motion) -> Result<Motion, Failure> {
    // SAFETY: as here.
    unsafe { motion(pointer) }?.ok_or(Failure::argument("the motion is NULL"))
}
