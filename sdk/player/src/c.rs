//! The functions of `include/htex_player.h`.
//!
//! The caller owns the memory of a player and of its block; the functions check pointers for null and alignment only.

use core::ffi::{c_char, c_int};
use core::slice;

use crate::{Block, OpenError, Player};

/// Bytes of `htex_player` in the header.
const SIZE: usize = 9984;
const ALIGNMENT: usize = 8;
const _: () = assert!(size_of::<Player<'_>>() <= SIZE && align_of::<Player<'_>>() <= ALIGNMENT);

/// Status of a null or misaligned pointer.
const BAD_POINTER: c_int = -1;
/// Status of a motion that is not finite.
const BAD_MOTION: c_int = -2;

fn usable<T>(pointer: *const T) -> bool {
    !pointer.is_null() && pointer.is_aligned()
}

/// Opens a block in the caller's memory; returns 0, else [`OpenError`]'s number or -1.
///
/// # Safety
/// `player` has [`SIZE`] bytes, and `block` has `length` bytes that stay unchanged while the player is used.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_player_open(
    player: *mut Player<'static>,
    block: *const u8,
    length: usize,
    seed: u32,
) -> c_int {
    if !usable(player) || block.is_null() {
        return BAD_POINTER;
    }
    if length > isize::MAX as usize {
        return OpenError::Length as c_int;
    }
    // SAFETY: The caller guarantees `length` bytes that outlive the player.
    let bytes: &'static [u8] = unsafe { slice::from_raw_parts(block, length) };
    let block = match Block::open(bytes) {
        Ok(block) => block,
        Err(error) => return error as c_int,
    };
    // SAFETY: The caller guarantees the memory; the pointer is neither null nor misaligned. Zeros are valid for all of
    // `memory`, numbers and `bool`s, and both fields are written before the reference is made. A player written as a
    // value would be made on the stack first.
    unsafe {
        (&raw mut (*player).memory).write_bytes(0, 1);
        (&raw mut (*player).block).write(block);
        (*player).start(seed);
    }
    0
}

/// Returns the rate of the samples, hertz; 0 for an unusable pointer.
///
/// # Safety
/// `player` was opened.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_player_rate_hz(player: *const Player<'static>) -> f32 {
    if !usable(player) {
        return 0.0;
    }
    // SAFETY: The caller guarantees an opened player.
    unsafe { (*player).block().rate_hz() }
}

/// Returns the code of the quantity of the samples; 0 for an unusable pointer.
///
/// # Safety
/// `player` was opened.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_player_quantity(player: *const Player<'static>) -> c_int {
    if !usable(player) {
        return 0;
    }
    // SAFETY: The caller guarantees an opened player.
    unsafe { (*player).block().quantity() as c_int }
}

/// Returns the symbol of the unit of the samples; empty for an unusable pointer.
///
/// # Safety
/// `player` was opened.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_player_unit(player: *const Player<'static>) -> *const c_char {
    if !usable(player) {
        return c"".as_ptr();
    }
    // SAFETY: The caller guarantees an opened player.
    unsafe { (*player).block().quantity().unit_for_c().as_ptr() }
}

/// Returns the full scale of the block, in the unit of the samples; 0 for an unusable pointer.
///
/// # Safety
/// `player` was opened.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_player_full_scale(player: *const Player<'static>) -> f32 {
    if !usable(player) {
        return 0.0;
    }
    // SAFETY: The caller guarantees an opened player.
    unsafe { (*player).block().full_scale() }
}

/// Sets the motion; returns 0, or a negative status.
///
/// # Safety
/// `player` was opened.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_player_set_motion(
    player: *mut Player<'static>,
    speed_mm_s: f32,
    force_n: f32,
) -> c_int {
    if !usable(player) {
        return BAD_POINTER;
    }
    // SAFETY: The caller guarantees an opened player that nothing else uses.
    match unsafe { (*player).set_motion(speed_mm_s, force_n) } {
        true => 0,
        false => BAD_MOTION,
    }
}

/// Fills a buffer with samples; returns 0, or -1.
///
/// # Safety
/// `player` was opened, and `out` has `count` numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_player_render(
    player: *mut Player<'static>,
    out: *mut f32,
    count: usize,
) -> c_int {
    if !usable(player) || !usable(out) || count > isize::MAX as usize / 4 {
        return BAD_POINTER;
    }
    // SAFETY: The caller guarantees an opened player and a buffer of `count` numbers.
    unsafe { (*player).render(slice::from_raw_parts_mut(out, count)) };
    0
}

/// Fills a buffer with integer samples; returns 0, or -1.
///
/// # Safety
/// `player` was opened, and `out` has `count` numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_player_render_i16(
    player: *mut Player<'static>,
    out: *mut i16,
    count: usize,
    full_scale: f32,
) -> c_int {
    if !usable(player) || !usable(out) || count > isize::MAX as usize / 2 {
        return BAD_POINTER;
    }
    // SAFETY: The caller guarantees an opened player and a buffer of `count` numbers.
    unsafe { (*player).render_i16(slice::from_raw_parts_mut(out, count), full_scale) };
    0
}
