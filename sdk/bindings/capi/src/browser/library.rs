//! Texture libraries whose bytes JavaScript fetches (`sdk/bindings/web/src/htexlib.js`). This code
//! tells JavaScript which bytes it needs next. JavaScript fetches these bytes and passes them to
//! [`htex_index_give`]. Offsets are doubles, as in JavaScript, so a file must have fewer than 2^53
//! bytes.

use std::ffi::c_char;
use std::ops::Range;

use htex::library::{Entry, Index, LibraryError, Limits, Opening, Progress, Query};
use serde::Deserialize;

use crate::handles::{Kind, Table};
use crate::options::{htex_open_options, models};
use crate::pointers::{needed_text, place, slice, slice_mut, write_text};
use crate::status::{Failure, guarded, htex_status};

/// A library that is open or being opened.
enum State {
    /// `None` after an error.
    Opening(Option<Opening>),
    /// The index, and the entries of the page that was read last.
    Open(Box<Index>, Vec<Entry>),
}

static INDEXES: Table<State> = Table::new(Kind::Index);

impl State {
    fn index(&self) -> Result<&Index, Failure> {
        match self {
            Self::Open(index, _) => Ok(index),
            Self::Opening(_) => Err(Failure::argument("the library is not open yet")),
        }
    }

    /// The entries of the page that was read last.
    fn entries(&self) -> &[Entry] {
        match self {
            Self::Open(_, entries) => entries,
            Self::Opening(_) => &[],
        }
    }

    /// The index, and the entry with this name in the page that was read last.
    fn entry(&self, name: &str) -> Result<(&Index, &Entry), Failure> {
        let index = self.index()?;
        match self.entries().iter().find(|entry| entry.name == name) {
            Some(entry) => Ok((index, entry)),
            None => Err(absent(name)),
        }
    }
}

fn absent(name: &str) -> Failure {
    let name = name.to_owned();
    LibraryError::Absent { name, nearest: Vec::new() }.into()
}

/// Starts opening a library.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_index_new(out: *mut u64) -> htex_status {
    guarded(|| {
        let opening = Opening::new(Limits::default());
        // SAFETY: the caller passed this pointer.
        *unsafe { place(out) }? = INDEXES.insert(State::Opening(Some(opening)))?;
        Ok(())
    })
}

/// Frees a library.
#[unsafe(no_mangle)]
pub extern "C" fn htex_index_free(index: u64) -> htex_status {
    guarded(|| INDEXES.remove(index).map(drop))
}

/// Writes the byte range that JavaScript must fetch next to open the library: the offsets of the
/// range's start and end. The two offsets are equal once the library is open.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_index_wanted(index: u64, out: *mut f64) -> htex_status {
    guarded(|| {
        let state = INDEXES.shared(index)?;
        let wanted = match &*state {
            State::Opening(Some(opening)) => opening.wanted(),
            _ => 0..0,
        };
        // SAFETY: the caller passed this pointer.
        unsafe { write_range(&wanted, out) }
    })
}

/// Gives the library the bytes that htex_index_wanted requested, or fewer bytes if the file ends
/// earlier. `file_bytes` is the size of the whole file.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_index_give(
    index: u64,
    bytes: *const u8,
    len: usize,
    file_bytes: f64,
) -> htex_status {
    guarded(|| {
        let mut state = INDEXES.exclusive(index)?;
        // SAFETY: the caller passed these pointers.
        let bytes = unsafe { slice(bytes, len) }?;
        let State::Opening(opening) = &mut *state else {
            return Err(Failure::argument("the library is open already"));
        };
        // `give` consumes `opening`, so after an error the library cannot be opened further.
        let opening = opening.take().ok_or(Failure::argument("the library could not be opened"))?;
        *state = match opening.give(bytes, file_bytes as u64)? {
            Progress::More(opening) => State::Opening(Some(opening)),
            Progress::Open(index) => State::Open(Box::new(index), Vec::new()),
        };
        Ok(())
    })
}

/// Writes the library's name, its own metadata (such as its version and authors), its hash, its
/// number of textures and its number of pages, as JSON.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_index_json(
    index: u64,
    out: *mut c_char,
    capacity: usize,
    length: *mut usize,
) -> htex_status {
    guarded(|| {
        let state = INDEXES.shared(index)?;
        let index = state.index()?;
        let json = serde_json::json!({
            "name": index.name(),
            "metadata": index.metadata(),
            "blake3": index.blake3().iter().map(|byte| format!("{byte:02x}")).collect::<String>(),
            "count": index.len(),
            "pages": index.leaves(),
        });
        // SAFETY: the caller passed these pointers.
        unsafe { write_text(&json.to_string(), out, capacity, length) }
    })
}

/// Writes the byte range of the whole index, for htex_index_check_signed: the offsets of its start
/// and end.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_index_range(index: u64, out: *mut f64) -> htex_status {
    guarded(|| {
        let state = INDEXES.shared(index)?;
        // SAFETY: the place is the caller's.
        unsafe { write_range(&state.index()?.range(), out) }
    })
}

/// Refuses a library that is not signed as the options require. `bytes` are the bytes of
/// htex_index_range. From then on, pages and textures that the signature does not cover are refused.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_index_check_signed(
    index: u64,
    bytes: *const u8,
    len: usize,
    options: *const htex_open_options,
) -> htex_status {
    guarded(|| {
        let mut state = INDEXES.exclusive(index)?;
        // SAFETY: the pointers are the caller's.
        let (bytes, signed) = unsafe { (slice(bytes, len)?, models(options)?.signed) };
        signed.check_index(state.index()?, bytes)?;
        if let State::Open(_, entries) = &mut *state {
            // A page that was read before is read again.
            entries.clear();
        }
        Ok(())
    })
}

/// Writes the number of the only index page that can list a texture with this name. Returns
/// HTEX_STATUS_ABSENT if no page can list such a texture.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_index_page_of(
    index: u64,
    name: *const c_char,
    out: *mut u32,
) -> htex_status {
    guarded(|| {
        let state = INDEXES.shared(index)?;
        // SAFETY: the caller passed these pointers.
        let (name, out) = unsafe { (needed_text(name)?, place(out)?) };
        let page = state.index()?.leaf_of(name);
        *out = page.ok_or_else(|| absent(name))? as u32;
        Ok(())
    })
}

/// Writes the byte range of an index page: the offsets of its start and end.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_index_page_range(
    index: u64,
    page: u32,
    out: *mut f64,
) -> htex_status {
    guarded(|| {
        let state = INDEXES.shared(index)?;
        let range = state
            .index()?
            .leaf_range(page as usize)
            .ok_or(Failure::argument("no page of this index"))?;
        // SAFETY: the caller passed this pointer.
        unsafe { write_range(&range, out) }
    })
}

/// Reads a page of the index from its bytes. The calls below look up entries in this page.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_index_read_page(
    index: u64,
    page: u32,
    bytes: *const u8,
    len: usize,
) -> htex_status {
    guarded(|| {
        let mut state = INDEXES.exclusive(index)?;
        // SAFETY: the caller passed these pointers.
        let bytes = unsafe { slice(bytes, len) }?;
        // The new page is read first, so that the old page stays in place after an error.
        let read = state.index()?.read_leaf(page as usize, bytes)?;
        if let State::Open(_, entries) = &mut *state {
            *entries = read;
        }
        Ok(())
    })
}

/// Writes all entries of the current page as JSON.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_index_entries_json(
    index: u64,
    out: *mut c_char,
    capacity: usize,
    length: *mut usize,
) -> htex_status {
    guarded(|| {
        let state = INDEXES.shared(index)?;
        let entries: Vec<&Entry> = state.entries().iter().collect();
        // SAFETY: the caller passed these pointers.
        unsafe { write_entries(&entries, out, capacity, length) }
    })
}

/// Writes, as JSON, the entries of the current page that match a query (`LibraryQuery` in
/// `sdk/bindings/web/src/index.d.ts`).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_index_find_json(
    index: u64,
    query: *const c_char,
    out: *mut c_char,
    capacity: usize,
    length: *mut usize,
) -> htex_status {
    guarded(|| {
        let state = INDEXES.shared(index)?;
        // SAFETY: the caller passed these pointers.
        let query = unsafe { needed_text(query) }?;
        let asked: QueryDocument = serde_json::from_str(query)
            .map_err(|error| Failure::new(htex_status::HTEX_STATUS_INVALID_ARGUMENT, error))?;
        let query = Query::from(asked);
        let entries = state.entries().iter();
        let found: Vec<&Entry> = entries.filter(|entry| query.matches(entry)).collect();
        // SAFETY: as above.
        unsafe { write_entries(&found, out, capacity, length) }
    })
}

/// A query as JavaScript writes it.
#[derive(Deserialize, Default)]
#[serde(default, deny_unknown_fields)]
struct QueryDocument {
    words: Vec<String>,
    tags: Vec<String>,
    speed: Option<f64>,
    force: Option<f64>,
    model: Option<String>,
    license: Option<String>,
    author: Option<String>,
    quantity: Option<htex::format::Quantity>,
    felt: Option<f64>,
    held_out: Option<f64>,
}

impl From<QueryDocument> for Query {
    fn from(asked: QueryDocument) -> Self {
        Self {
            words: asked.words,
            tags: asked.tags,
            speed_mm_s: asked.speed,
            force_n: asked.force,
            model: asked.model,
            license: asked.license,
            author: asked.author,
            quantity: asked.quantity,
            felt_error_rms_db: asked.felt,
            held_out_error_db: asked.held_out,
        }
    }
}

/// Writes entries as JSON.
///
/// # Safety
/// As for pointers.
unsafe fn write_entries(
    entries: &[&Entry],
    out: *mut c_char,
    capacity: usize,
    length: *mut usize,
) -> Result<(), Failure> {
    let json = serde_json::to_string(entries)
        .map_err(|error| Failure::new(htex_status::HTEX_STATUS_INTERNAL, error))?;
    // SAFETY: the caller says so.
    unsafe { write_text(&json, out, capacity, length) }
}

/// Writes which byte ranges of the file contain a texture of the current page. `out` receives the
/// start and end of each range, for at most `capacity` ranges. `length` receives the number of all
/// ranges of the texture.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_index_ranges(
    index: u64,
    name: *const c_char,
    out: *mut f64,
    capacity: usize,
    length: *mut usize,
) -> htex_status {
    guarded(|| {
        let state = INDEXES.shared(index)?;
        // SAFETY: the caller passed these pointers.
        let (name, length) = unsafe { (needed_text(name)?, place(length)?) };
        let (index, entry) = state.entry(name)?;
        let ranges = index.asset_ranges(entry);
        *length = ranges.len();
        for (i, range) in ranges.iter().take(capacity).enumerate() {
            // SAFETY: two numbers for each of `capacity` ranges.
            unsafe { write_range(range, out.wrapping_add(2 * i)) }?;
        }
        Ok(())
    })
}

/// Assembles a texture of the current page, and checks its hash. `bytes` holds the bytes of the
/// texture's ranges, one range after the other. `out` must have room for `len` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_index_assemble(
    index: u64,
    name: *const c_char,
    bytes: *const u8,
    len: usize,
    out: *mut u8,
) -> htex_status {
    guarded(|| {
        let state = INDEXES.shared(index)?;
        // SAFETY: the caller passed these pointers.
        let (name, mut bytes) = unsafe { (needed_text(name)?, slice(bytes, len)?) };
        let (index, entry) = state.entry(name)?;
        let mut parts = Vec::new();
        for range in index.asset_ranges(entry) {
            let length = usize::try_from(range.end - range.start).unwrap_or(usize::MAX);
            let part = bytes.split_off(..length);
            parts.push(part.ok_or(Failure::argument("bytes of the ranges are missing"))?);
        }
        let asset = index.assemble(entry, &parts)?;
        // SAFETY: as many bytes as the ranges have.
        unsafe { slice_mut(out, len) }?[..asset.len()].copy_from_slice(&asset);
        Ok(())
    })
}

/// Writes the start and end of a range.
///
/// # Safety
/// As in the module `pointers`: `out` is NULL or points to two numbers.
unsafe fn write_range(range: &Range<u64>, out: *mut f64) -> Result<(), Failure> {
    // SAFETY: as here.
    let out = unsafe { slice_mut(out, 2) }?;
    out.copy_from_slice(&[range.start as f64, range.end as f64]);
    Ok(())
}
