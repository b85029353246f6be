//! Libraries: files with thousands of textures. Without the feature `library`, and in browsers,
//! each call returns an error that states the reason. Programs in browsers use other functions
//! (`browser/library.rs`).

use std::ffi::c_char;

use crate::asset::htex_asset;
use crate::options::htex_open_options;
use crate::reader::htex_reader;
use crate::status::htex_status;

/// An open library: a .htexlib file with any number of textures. Several threads may use a library
/// at the same time. An `id` of 0 never stands for a library.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct htex_library {
    /// Private.
    pub id: u64,
}

/// [any thread; reads a file] Opens a library file. Later calls read from the file only the index
/// pages and textures that they need.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_library_open(
    path: *const c_char,
    out: *mut htex_library,
) -> htex_status {
    // SAFETY: the caller passed these pointers.
    unsafe { calls::open(path, out) }
}

/// [any thread; reads a file] Does the same as htex_library_open, for a Windows path in UTF-16.
#[cfg(windows)]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_library_open_wide(
    path: *const u16,
    out: *mut htex_library,
) -> htex_status {
    // SAFETY: the caller passed these pointers.
    unsafe { calls::open_wide(path, out) }
}

/// [any thread] Opens a library in memory. The bytes are copied.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_library_from_bytes(
    bytes: *const u8,
    len: usize,
    out: *mut htex_library,
) -> htex_status {
    // SAFETY: the caller passed these pointers.
    unsafe { calls::from_bytes(bytes, len, out) }
}

/// [any thread; calls the reader] Opens a library whose bytes come from the program's own
/// functions, `reader`. The call copies the struct `reader`. The library may call the functions in
/// `reader` until htex_library_free frees the library.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_library_open_reader(
    reader: *const htex_reader,
    out: *mut htex_library,
) -> htex_status {
    // SAFETY: the caller passed these pointers.
    unsafe { calls::open_reader(reader, out) }
}

/// [any thread] Frees a library. Assets that were opened from the library stay open. Returns
/// HTEX_STATUS_BUSY if another thread is using the library.
#[unsafe(no_mangle)]
pub extern "C" fn htex_library_free(library: htex_library) -> htex_status {
    calls::free(library)
}

/// [any thread] Writes the library's name, which may be empty. `out`, `capacity` and `length` work
/// as in htex_asset_manifest_json.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_library_name(
    library: htex_library,
    out: *mut c_char,
    capacity: usize,
    length: *mut usize,
) -> htex_status {
    // SAFETY: the caller passed these pointers.
    unsafe { calls::name(library, out, capacity, length) }
}

/// [any thread] Writes the number of textures in the library.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_library_count(library: htex_library, out: *mut u64) -> htex_status {
    // SAFETY: the caller passed this pointer.
    unsafe { calls::count(library, out) }
}

/// [any thread] Writes the number of pages in the library's index. Each page lists some of the
/// textures.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_library_page_count(
    library: htex_library,
    out: *mut usize,
) -> htex_status {
    // SAFETY: the caller passed this pointer.
    unsafe { calls::page_count(library, out) }
}

/// [any thread; reads the file] Writes a page of the index as a JSON array with one entry per
/// texture, sorted by name. An entry has the texture's name, tags, models, ranges of recorded
/// speeds and forces, size in bytes and hash. Page numbers start at 0. `out`, `capacity` and
/// `length` work as in htex_asset_manifest_json.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_library_page_json(
    library: htex_library,
    page: usize,
    out: *mut c_char,
    capacity: usize,
    length: *mut usize,
) -> htex_status {
    // SAFETY: the caller passed these pointers.
    unsafe { calls::page_json(library, page, out, capacity, length) }
}

/// [any thread; reads the file] Writes the entry of the texture with this name as JSON, with the
/// same contents as in htex_library_page_json. Returns HTEX_STATUS_ABSENT if there is no texture
/// with this name. `out`, `capacity` and `length` work as in htex_asset_manifest_json.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_library_entry_json(
    library: htex_library,
    name: *const c_char,
    out: *mut c_char,
    capacity: usize,
    length: *mut usize,
) -> htex_status {
    // SAFETY: the caller passed these pointers.
    unsafe { calls::entry_json(library, name, out, capacity, length) }
}

/// [any thread; reads the file] Opens the texture with this name as an asset. Returns
/// HTEX_STATUS_ABSENT if there is no texture with this name. `options` may be NULL for the
/// defaults.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_library_asset(
    library: htex_library,
    name: *const c_char,
    options: *const htex_open_options,
    out: *mut htex_asset,
) -> htex_status {
    // SAFETY: the caller passed these pointers.
    unsafe { calls::asset(library, name, options, out) }
}

#[cfg(all(feature = "library", not(target_family = "wasm")))]
#[path = "library/calls.rs"]
mod calls;
#[cfg(all(feature = "library", not(target_family = "wasm")))]
pub(crate) use calls::clear;

#[cfg(any(not(feature = "library"), target_family = "wasm"))]
mod calls {
    //! The library calls in builds without the feature `library`, and in browsers. Each one returns
    //! an error.
    use super::*;
    use crate::status::{Failure, guarded};

    fn absent() -> htex_status {
        guarded(|| {
            Err(Failure::plain(
                htex_status::HTEX_STATUS_UNSUPPORTED,
                "this build of the library opens no libraries of textures; build it with the feature `library`",
            ))
        })
    }

    pub(super) unsafe fn open(_: *const c_char, _: *mut htex_library) -> htex_status {
        absent()
    }
    #[cfg(windows)]
    pub(super) unsafe fn open_wide(_: *const u16, _: *mut htex_library) -> htex_status {
        absent()
    }
    pub(super) unsafe fn from_bytes(_: *const u8, _: usize, _: *mut htex_library) -> htex_status {
        absent()
    }
    pub(super) unsafe fn open_reader(_: *const htex_reader, _: *mut htex_library) -> htex_status {
        absent()
    }
    pub(super) fn free(_: htex_library) -> htex_status {
        absent()
    }
    pub(super) unsafe fn name(
        _: htex_library,
        _: *mut c_char,
        _: usize,
        _: *mut usize,
    ) -> htex_status {
        absent()
    }
    pub(super) unsafe fn count(_: htex_library, _: *mut u64) -> htex_status {
        absent()
    }
    pub(super) unsafe fn page_count(_: htex_library, _: *mut usize) -> htex_status {
        absent()
    }
    pub(super) unsafe fn page_json(
        _: htex_library,
        _: usize,
        _: *mut c_char,
        _: usize,
        _: *mut usize,
    ) -> htex_status {
        absent()
    }
    pub(super) unsafe fn entry_json(
        _: htex_library,
        _: *const c_char,
        _: *mut c_char,
        _: usize,
        _: *mut usize,
    ) -> htex_status {
        absent()
    }
    pub(super) unsafe fn asset(
        _: htex_library,
        _: *const c_char,
        _: *const htex_open_options,
        _: *mut htex_asset,
    ) -> htex_status {
        absent()
    }
}
