//! Files that the program reads for the library, for example from archives, app packages or memory.

#[cfg(feature = "scene")]
use std::ffi::CString;
use std::ffi::{c_char, c_void};
use std::io;

use crate::pointers::slice;
use crate::status::Failure;

/// A file that the library reads through functions of the program. Set `size` to
/// sizeof(htex_reader).
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct htex_reader {
    /// sizeof(htex_reader).
    pub size: u32,
    /// Size of the file, bytes.
    pub len: u64,
    /// First argument that the library passes to `read` and `close`.
    pub context: *mut c_void,
    /// Must fill `buffer` with `len` bytes of the file, starting at `offset`. It must return 0
    /// after success, and any other number after an error. The requested bytes always lie within
    /// the file. The library calls this function in the thread that called the library. If the file
    /// is a texture library, several threads may call the function at the same time.
    pub read: Option<
        unsafe extern "C" fn(context: *mut c_void, offset: u64, buffer: *mut u8, len: usize) -> i32,
    >,
    /// Called once when the library no longer reads the file, also after an error. May be NULL.
    pub close: Option<unsafe extern "C" fn(context: *mut c_void)>,
}

/// Gives access to the files that a scene names. Set `size` to sizeof(htex_files).
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct htex_files {
    /// sizeof(htex_files).
    pub size: u32,
    /// First argument that the library passes to `open`.
    pub context: *mut c_void,
    /// Must open the file `name` and fill in `file`. The library has already set the field `size`
    /// of `file`. It must return 0 after success, and any other number if there is no such file.
    /// `name` is the file's name in the scene file, in UTF-8.
    pub open: Option<
        unsafe extern "C" fn(
            context: *mut c_void,
            name: *const c_char,
            file: *mut htex_reader,
        ) -> i32,
    >,
}

/// Largest size, bytes, of a file that is read as a whole. The largest such files are recorded
/// motions.
const MOST_BYTES: u64 = 256 << 20;

/// A file that is read through functions of the program. It is closed when it is dropped.
#[derive(Debug)]
pub(crate) struct Reader {
    len: u64,
    context: *mut c_void,
    read: unsafe extern "C" fn(*mut c_void, u64, *mut u8, usize) -> i32,
    close: Option<unsafe extern "C" fn(*mut c_void)>,
}

// SAFETY: the caller of a function with a reader allows calls from any thread.
unsafe impl Send for Reader {}
// SAFETY: the caller also allows several calls at the same time.
unsafe impl Sync for Reader {}

impl Reader {
    /// # Safety
    /// The pointer is NULL, or points to a reader of the caller.
    pub(crate) unsafe fn from_raw(reader: *const htex_reader) -> Result<Self, Failure> {
        // SAFETY: as here.
        let reader = unsafe { slice(reader, 1) }?[0];
        Self::new(&reader)
    }

    fn new(reader: &htex_reader) -> Result<Self, Failure> {
        // A longer struct comes from a newer header. It begins with the same fields.
        if (reader.size as usize) < size_of::<htex_reader>() {
            return Err(Failure::argument(
                "the reader's `size` is wrong; set it to sizeof(htex_reader)",
            ));
        }
        let Some(read) = reader.read else {
            if let Some(close) = reader.close {
                // SAFETY: the caller vouches for the function, which is called once.
                unsafe { close(reader.context) };
            }
            return Err(Failure::argument("the reader's function `read` is NULL"));
        };
        Ok(Self { len: reader.len, context: reader.context, read, close: reader.close })
    }

    #[cfg(all(feature = "library", not(target_family = "wasm")))]
    pub(crate) fn len(&self) -> u64 {
        self.len
    }

    /// Fills the buffer with the bytes at `offset`. Returns their number, which is smaller than the
    /// buffer at the end of the file.
    pub(crate) fn read_at(&self, offset: u64, buffer: &mut [u8]) -> io::Result<usize> {
        let there = self.len.saturating_sub(offset);
        let len = usize::try_from(there).map_or(buffer.len(), |there| there.min(buffer.len()));
        if len == 0 {
            return Ok(0);
        }
        // SAFETY: the caller vouches for the function; the buffer has this number of bytes.
        match unsafe { (self.read)(self.context, offset, buffer.as_mut_ptr(), len) } {
            0 => Ok(len),
            number => Err(io::Error::other(format!(
                "the function of the program that reads returned {number}"
            ))),
        }
    }

    /// Reads the whole file.
    pub(crate) fn read_whole(&self) -> io::Result<Vec<u8>> {
        if self.len > MOST_BYTES {
            let what = format!("{} bytes; at most {MOST_BYTES} are read", self.len);
            return Err(io::Error::new(io::ErrorKind::FileTooLarge, what));
        }
        // The limit above fits into 32 bits, so this cast loses nothing.
        let mut bytes = vec![0; self.len as usize];
        self.read_at(0, &mut bytes)?;
        Ok(bytes)
    }
}

impl Drop for Reader {
    fn drop(&mut self) {
        if let Some(close) = self.close {
            // SAFETY: the caller vouches for the function, which is called once.
            unsafe { close(self.context) };
        }
    }
}

/// The files of a scene, which the program opens.
#[cfg(feature = "scene")]
pub(crate) struct Files {
    files: htex_files,
}

#[cfg(feature = "scene")]
impl Files {
    /// # Safety
    /// The pointer is NULL, or points to a `htex_files` of the caller.
    pub(crate) unsafe fn from_raw(files: *const htex_files) -> Result<Self, Failure> {
        // SAFETY: as here.
        let files = unsafe { slice(files, 1) }?[0];
        if (files.size as usize) < size_of::<htex_files>() || files.open.is_none() {
            return Err(Failure::argument(
                "the files' size is not sizeof(htex_files), or their function is NULL",
            ));
        }
        Ok(Self { files })
    }

    /// Reads the whole file with this name.
    pub(crate) fn read_whole(&self, name: &str) -> io::Result<Vec<u8>> {
        let absent = || io::Error::from(io::ErrorKind::NotFound);
        let text = CString::new(name).map_err(|_| absent())?;
        let mut reader = htex_reader {
            size: size_of::<htex_reader>() as u32,
            len: 0,
            context: std::ptr::null_mut(),
            read: None,
            close: None,
        };
        let open = self.files.open.ok_or_else(absent)?;
        // SAFETY: the caller vouches for the function.
        match unsafe { open(self.files.context, text.as_ptr(), &mut reader) } {
            0 => Reader::new(&reader)
                .map_err(|_| {
                    io::Error::other("the program opened the file without a function to read it")
                })?
                .read_whole(),
            _ => Err(absent()),
        }
    }
}
