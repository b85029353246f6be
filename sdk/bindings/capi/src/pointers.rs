//! Converts C pointers to Rust values. The library cannot check the following rule, so the caller
//! of a C function must keep it. A pointer that is not NULL must point to as many values as the
//! length beside it states, and these values must stay valid during the call.

use std::ffi::{CStr, c_char};

use crate::status::{Failure, htex_status};

/// Returns the values at `pointer`, or an empty slice for a length of 0.
///
/// # Safety
/// The pointer must follow the rule in the module's documentation.
pub unsafe fn slice<'a, T>(pointer: *const T, len: usize) -> Result<&'a [T], Failure> {
    if len == 0 {
        // C may pass NULL or any address with a length of 0, which `from_raw_parts` does not allow.
        return Ok(&[]);
    }
    check(pointer, len)?;
    // SAFETY: `len` values are there, aligned, and no more than memory can hold.
    Ok(unsafe { std::slice::from_raw_parts(pointer, len) })
}

/// Does the same as [`slice`], for values that are written.
///
/// # Safety
/// The pointer must follow the rule in the module's documentation. In addition, nothing else uses
/// the values during the call.
pub(crate) unsafe fn slice_mut<'a, T>(pointer: *mut T, len: usize) -> Result<&'a mut [T], Failure> {
    if len == 0 {
        return Ok(&mut []);
    }
    check(pointer, len)?;
    // SAFETY: as in `slice`; nothing else uses the memory during the call.
    Ok(unsafe { std::slice::from_raw_parts_mut(pointer, len) })
}

fn check<T>(pointer: *const T, len: usize) -> Result<(), Failure> {
    // The limit of `from_raw_parts`. It also refuses a length that was negative in C.
    let possible = len <= isize::MAX as usize / size_of::<T>().max(1);
    if pointer.is_null() || !pointer.is_aligned() || !possible {
        return Err(Failure::argument(
            "an array is NULL, misaligned or too long; give an array of the length that is passed with it",
        ));
    }
    Ok(())
}

/// Returns a reference to the place that receives a result.
///
/// # Safety
/// The pointer must follow the rule in the module's documentation.
pub unsafe fn place<'a, T>(pointer: *mut T) -> Result<&'a mut T, Failure> {
    if pointer.is_null() || !pointer.is_aligned() {
        return Err(Failure::argument("the pointer for the result is NULL or misaligned"));
    }
    // SAFETY: the pointer points to a value of the caller.
    Ok(unsafe { &mut *pointer })
}

/// Returns a text, or `None` for NULL.
///
/// # Safety
/// The pointer must follow the rule in the module's documentation, and the text must end with a
/// zero byte.
pub(crate) unsafe fn text<'a>(pointer: *const c_char) -> Result<Option<&'a str>, Failure> {
    if pointer.is_null() {
        return Ok(None);
    }
    // SAFETY: the caller's text ends with a zero.
    let text = unsafe { CStr::from_ptr(pointer) };
    match text.to_str() {
        Ok(text) => Ok(Some(text)),
        Err(_) => Err(Failure::argument("a text is not UTF-8")),
    }
}

/// Returns a text that must not be NULL.
///
/// # Safety
/// The same rules as for `text` apply.
pub unsafe fn needed_text<'a>(pointer: *const c_char) -> Result<&'a str, Failure> {
    // SAFETY: as here.
    unsafe { text(pointer) }?.ok_or(Failure::argument("a text is NULL"))
}

/// Returns a Windows path. `path` is UTF-16 with a terminating zero.
///
/// # Safety
/// As [`text`].
#[cfg(windows)]
pub(crate) unsafe fn wide_path(path: *const u16) -> Result<std::path::PathBuf, Failure> {
    use std::os::windows::ffi::OsStringExt;
    if path.is_null() || !path.is_aligned() {
        return Err(Failure::argument("a path is NULL or misaligned"));
    }
    let mut len = 0;
    // SAFETY: the caller's text ends with a zero.
    while unsafe { *path.add(len) } != 0 {
        len += 1;
    }
    // SAFETY: as above.
    let units = unsafe { slice(path, len) }?;
    Ok(std::ffi::OsString::from_wide(units).into())
}

/// Writes a text with a terminating zero to `out`, and its length without the zero to `length`.
/// `length` may be NULL. If `capacity` is 0, only the length is written.
///
/// # Safety
/// The pointer must follow the rule in the module's documentation.
pub(crate) unsafe fn write_text(
    text: &str,
    out: *mut c_char,
    capacity: usize,
    length: *mut usize,
) -> Result<(), Failure> {
    // Written first, so that a caller whose buffer is too small also gets the length.
    if !length.is_null() {
        // SAFETY: as here.
        *unsafe { place(length) }? = text.len();
    }
    // SAFETY: as here.
    let out = unsafe { slice_mut(out.cast::<u8>(), capacity) }?;
    let Some(space) = out.len().checked_sub(1) else {
        return if length.is_null() {
            Err(Failure::argument("neither a buffer nor a place for the length is given"))
        } else {
            Ok(())
        };
    };
    // The beginning of a text that is cut off must also be valid UTF-8.
    let len = text.floor_char_boundary(space);
    out[..len].copy_from_slice(&text.as_bytes()[..len]);
    out[len] = 0;
    if len < text.len() {
        return Err(Failure::plain(
            htex_status::HTEX_STATUS_TRUNCATED,
            "the buffer is too small for the text; ask for its length with a capacity of 0",
        ));
    }
    Ok(())
}
