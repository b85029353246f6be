//! Implementation of the library calls.

use std::ffi::c_char;
use std::io;
use std::path::{Path, PathBuf};

use htex::library::Library;
use htex::library::{LibrarySource, LocalFile};

use super::htex_library;
use crate::asset::{htex_asset, keep};
use crate::handles::{Kind, Table};
use crate::options::{htex_open_options, models};
use crate::pointers::{needed_text, place, slice, write_text};
use crate::reader::{Reader, htex_reader};
use crate::status::{Failure, guarded, htex_status};

/// Where the bytes of a library come from.
enum Source {
    File(LocalFile, PathBuf),
    Memory(Vec<u8>),
    Reader(Reader),
}

impl Source {
    fn file(path: &Path) -> Result<Self, Failure> {
        Ok(Self::File(LocalFile::open(path)?, path.to_owned()))
    }

    /// Returns the path of a library that is a file.
    fn path(&self) -> Option<&Path> {
        match self {
            Self::File(_, path) => Some(path),
            Self::Memory(_) | Self::Reader(_) => None,
        }
    }
}

impl LibrarySource for Source {
    fn len(&self) -> io::Result<u64> {
        match self {
            Self::File(file, _) => file.len(),
            Self::Memory(bytes) => Ok(bytes.len() as u64),
            Self::Reader(reader) => Ok(reader.len()),
        }
    }

    fn read_at(&self, offset: u64, buffer: &mut [u8]) -> io::Result<usize> {
        match self {
            Self::File(file, _) => file.read_at(offset, buffer),
            Self::Memory(bytes) => {
                let from = usize::try_from(offset).map_or(bytes.len(), |at| at.min(bytes.len()));
                let len = buffer.len().min(bytes.len() - from);
                buffer[..len].copy_from_slice(&bytes[from..from + len]);
                Ok(len)
            }
            Self::Reader(reader) => reader.read_at(offset, buffer),
        }
    }
}

static LIBRARIES: Table<Library<Source>> = Table::new(Kind::Library);

/// Frees all libraries.
///
/// # Safety
/// As [`Table::clear`].
pub(crate) unsafe fn clear() -> Result<(), Failure> {
    // SAFETY: as here.
    unsafe { LIBRARIES.clear() }
}

pub(super) unsafe fn open(path: *const c_char, out: *mut htex_library) -> htex_status {
    // SAFETY: the caller passed these pointers.
    let source = || Source::file(unsafe { needed_text(path) }?.as_ref());
    // SAFETY: as above.
    unsafe { keep_library(source, out) }
}

#[cfg(windows)]
pub(super) unsafe fn open_wide(path: *const u16, out: *mut htex_library) -> htex_status {
    // SAFETY: the caller passed these pointers.
    let source = || Source::file(&unsafe { crate::pointers::wide_path(path) }?);
    // SAFETY: as above.
    unsafe { keep_library(source, out) }
}

pub(super) unsafe fn from_bytes(
    bytes: *const u8,
    len: usize,
    out: *mut htex_library,
) -> htex_status {
    // SAFETY: the caller passed these pointers.
    let source = || Ok(Source::Memory(unsafe { slice(bytes, len) }?.to_vec()));
    // SAFETY: as above.
    unsafe { keep_library(source, out) }
}

pub(super) unsafe fn open_reader(
    reader: *const htex_reader,
    out: *mut htex_library,
) -> htex_status {
    // SAFETY: the caller passed these pointers.
    let source = || Ok(Source::Reader(unsafe { Reader::from_raw(reader) }?));
    // SAFETY: as above.
    unsafe { keep_library(source, out) }
}

unsafe fn keep_library(
    source: impl FnOnce() -> Result<Source, Failure>,
    out: *mut htex_library,
) -> htex_status {
    guarded(|| {
        let source = source()?;
        // SAFETY: the caller passed this pointer.
        let out = unsafe { place(out) }?;
        out.id = LIBRARIES.insert(Library::open_source(source)?)?;
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
        // SAFETY: the caller passed these pointers.
        unsafe { write_text(library.name(), out, capacity, length) }
    })
}

pub(super) unsafe fn count(library: htex_library, out: *mut u64) -> htex_status {
    guarded(|| {
        let library = LIBRARIES.shared(library.id)?;
        // SAFETY: the caller passed this pointer.
        *unsafe { place(out) }? = library.len();
        Ok(())
    })
}

pub(super) unsafe fn page_count(library: htex_library, out: *mut usize) -> htex_status {
    guarded(|| {
        let library = LIBRARIES.shared(library.id)?;
        // SAFETY: the caller passed this pointer.
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
        // SAFETY: the caller passed these pointers.
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
        // SAFETY: the caller passed these pointers.
        let name = unsafe { needed_text(name) }?;
        let entry = library.needed(name)?;
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
        // SAFETY: the caller passed these pointers.
        let (name, models) = unsafe { (needed_text(name)?, models(options)?) };
        models.signed.check_library(&library, library.source().path())?;
        let bytes = library.get(name)?;
        let data = htex::format::Asset::from_bytes(&bytes).map_err(htex::Error::from)?;
        keep(data, models, out)
    })
}

fn json(value: &impl serde::Serialize) -> Result<String, Failure> {
    serde_json::to_string(value)
        .map_err(|error| Failure::new(htex_status::HTEX_STATUS_INTERNAL, error))
}
