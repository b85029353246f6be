//! The C function of this WASM module, and the table of the named functions that JavaScript calls
//! through it.

use std::ffi::c_char;

use htex_c::calls::{Failure, allocate, guarded, needed_text, place, slice};
use htex_c::{htex_bytes, htex_status};

use crate::answer::{Answer, Files, Function};
use crate::document::Document;
use crate::refusal::Refusal;

/// The result of a call. The caller must free the memory of the result with
/// `htex_free(json, json_len)` and `htex_free(bytes, bytes_len)`.
#[repr(C)]
#[derive(Debug)]
#[allow(non_camel_case_types)] // As the names of the C header.
pub struct htex_author_result {
    /// A JSON document in UTF-8. If the call fails, the document is `{ code, message }`.
    pub json: *mut u8,
    /// Length of `json`, bytes.
    pub json_len: usize,
    /// The bytes of a file, or of numbers; NULL if there are none.
    pub bytes: *mut u8,
    /// Length of `bytes`, bytes.
    pub bytes_len: usize,
}

/// The functions of each part that this module contains.
const FUNCTIONS: &[&[(&str, Function)]] = &[
    #[cfg(feature = "make")]
    crate::making::FUNCTIONS,
    #[cfg(feature = "import")]
    crate::making::EXCHANGE,
    #[cfg(feature = "scene")]
    crate::scene::FUNCTIONS,
];

/// Calls the function with this name, and passes it a JSON document and the bytes of files. If the
/// called function fails, `out` receives a JSON document that describes the error.
///
/// # Safety
/// During the call, the pointers must be valid, and nothing else may use `out`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_author_call(
    name: *const c_char,
    json: *const u8,
    json_len: usize,
    files: *const htex_bytes,
    files_len: usize,
    out: *mut htex_author_result,
) -> htex_status {
    guarded(|| {
        // SAFETY: the caller passed these pointers.
        let (name, json, files, out) = unsafe {
            (needed_text(name)?, slice(json, json_len)?, slice(files, files_len)?, place(out)?)
        };
        // SAFETY: as above.
        let files = files
            .iter()
            .map(|file| unsafe { slice(file.data, file.len) })
            .collect::<Result<Vec<_>, Failure>>()?;
        let answer = called(name, json, &files);
        let (json, bytes) = match &answer {
            Ok(answer) => (answer.json.as_slice(), answer.bytes.as_slice()),
            Err(refusal) => (refusal.json(), &[][..]),
        };
        *out = htex_author_result {
            json: handed_over(json)?,
            json_len: json.len(),
            bytes: handed_over(bytes)?,
            bytes_len: bytes.len(),
        };
        // The error is returned only after `out` is written, because the caller also receives the
        // document of an error.
        answer.map(drop).map_err(Failure::from)
    })
}

fn called(name: &str, json: &[u8], files: Files<'_>) -> Result<Answer, Refusal> {
    let function = FUNCTIONS.iter().copied().flatten().find(|(own, _)| *own == name);
    let (_, function) =
        function.ok_or_else(|| Refusal::argument(format!("there is no function {name}")))?;
    function(Document::of_call(json)?, files)
}

/// Copies bytes to memory that the caller frees. Returns NULL if there are no bytes.
fn handed_over(bytes: &[u8]) -> Result<*mut u8, Failure> {
    if bytes.is_empty() {
        return Ok(std::ptr::null_mut());
    }
    let at = allocate(bytes.len());
    if at.is_null() {
        return Err(Failure::plain(
            htex_status::HTEX_STATUS_INTERNAL,
            "the memory for the result cannot be allocated",
        ));
    }
    // SAFETY: this number of bytes was allocated, and nobody else uses them.
    unsafe { std::ptr::copy_nonoverlapping(bytes.as_ptr(), at, bytes.len()) };
    Ok(at)
}
