//! The calls of libraries.

use std::ffi::c_char;

use htex::Library;
use htex::library::LibraryError;

use super::htex_library;
use crate::asset::{htex_asset, keep};
use crate::handles::Table;
use crate::options::{htex_open_options, models};
use crate::pointers::{needed_text, place, write_text};
use crate::status::{Failure, guarded, htex_status};

static LIBRARIES: Table<Library> = Table::new();

impl From<LibraryError> for Failure {
    fn from(error: LibraryError) -> Self {
        let status = match &error {
            LibraryError::Open { .. } | LibraryError::Read { .. } => htex_status::HTEX_STATUS_IO,
            LibraryError::Absent { .. } => htex_status::HTEX_STATUS_ABSENT,
            _ => htex_status::HTEX_STATUS_INVALID_LIBRARY,
        };
        Self::of(status, error)
    }
}

pub(super) unsafe fn open(path: *const c_char, out: *mut htex_library) -> htex_status {
    guarded(|| {
        // SAFETY: the pointers are the caller's.
        let (path, out) = unsafe { (needed_text(path)?, place(out)?) };
        out.id = LIBRARIES.insert(Library::open(path.as_ref())?)?;
        Ok(())
    })
}

pub(super) fn free(library: htex_library) -> htex_status {
    guarded(|| LIBRARIES.remove(library.id).map(drop))
}

pub(super) unsafe fn name(
    library: htex_library,
    out: *mut c_char,
    capacity: usize,
    length: *mut usize,
) -> htex_status {
    guarded(|| {
        let library = LIBRARIES.shared(library.id)?;
        // SAFETY: the pointers are the caller's.
        unsafe { write_text(library.name(), out, capacity, length) }
    })
}

pub(super) unsafe fn count(library: htex_library, out: *mut u64) -> htex_status {
    guarded(|| {
        let library = LIBRARIES.shared(library.id)?;
        // SAFETY: the place is the caller's.
        *unsafe { place(out) }? = library.len();
        Ok(())
    })
}

pub(super) unsafe fn page_count(library: htex_library, out: *mut usize) -> htex_status {
    guarded(|| {
        let library = LIBRARIES.shared(library.id)?;
        // SAFETY: the place is the caller's.
        *unsafe { place(out) }? = library.index().leaves();
        Ok(())
    })
}

pub(super) unsafe fn page_json(
    library: htex_library,
    page: usize,
    out: *mut c_char,
    capacity: usize,
    length: *mut usize,
) -> htex_status {
    guarded(|| {
        let library = LIBRARIES.shared(library.id)?;
        let entries = library.leaf_entries(page)?.ok_or(Failure::argument(
            "no page of this index; htex_library_page_count tells how many there are",
        ))?;
        // SAFETY: the pointers are the caller's.
        unsafe { write_text(&json(&*entries)?, out, capacity, length) }
    })
}

pub(super) unsafe fn entry_json(
    library: htex_library,
    name: *const c_char,
    out: *mut c_char,
    capacity: usize,
    length: *mut usize,
) -> htex_status {
    guarded(|| {
        let library = LIBRARIES.shared(library.id)?;
        // SAFETY: the pointers are the caller's.
        let name = unsafe { needed_text(name) }?;
        let entry = library.entry(name)?.ok_or_else(|| LibraryError::Absent {
            name: name.to_owned(),
        })?;
        // SAFETY: as above.
        unsafe { write_text(&json(&entry)?, out, capacity, length) }
    })
}

pub(super) unsafe fn asset(
    library: htex_library,
    name: *const c_char,
    options: *const htex_open_options,
    out: *mut htex_asset,
) -> htex_status {
    guarded(|| {
        let library = LIBRARIES.shared(library.id)?;
        // SAFETY: the pointers are the caller's.
        let (name, models) = unsafe { (needed_text(name)?, models(options)?) };
        let bytes = library.get(name)?;
        let data = htex::AssetData::from_bytes(&bytes).map_err(htex::Error::from)?;
        keep(data, models, out)
    })
}

fn json(value: &impl serde::Serialize) -> Result<String, Failure> {
    serde_json::to_string(value)
        .map_err(|error| Failure::of(htex_status::HTEX_STATUS_INTERNAL, error))
}
