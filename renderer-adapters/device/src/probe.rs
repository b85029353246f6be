//! For checkers: calls with arguments that a host never passes. Apps do not need them.

use crate::abi::{Code, DeviceTable, STATUS_NUMBERS};
use crate::library::{Library, Table};
use crate::loaded::{Native, Opened};
use crate::source::abi::SourceTable;
use crate::{DeviceError, Settings, StreamFormat};

/// Minimum number of guard values behind a buffer.
const GUARDS: usize = 64;
/// Number of values in a buffer of samples.
const SAMPLES: usize = 8;
const INVALID_ARGUMENT: i64 = Code::InvalidArgument as i64;

/// A buffer of `len` values with guard values behind it.
struct Guarded<T> {
    all: Vec<T>,
    len: usize,
    guard: T,
}

impl<T: Copy + PartialEq> Guarded<T> {
    fn new(len: usize, guard: T) -> Self {
        Self::before(len, GUARDS, guard)
    }

    /// Creates a buffer with at least `guards` guard values. They absorb the writes of a call that
    /// ignores the length.
    fn before(len: usize, guards: usize, guard: T) -> Self {
        let all = vec![guard; len + guards.max(GUARDS)];
        Self { all, len, guard }
    }

    /// Returns the address of the buffer. The guard values behind it may be overwritten as well.
    fn pointer(&mut self) -> *mut T {
        self.all.as_mut_ptr()
    }

    /// Returns an address that is misaligned for every value of more than one byte.
    fn misaligned(&mut self) -> *mut T {
        self.pointer().cast::<u8>().wrapping_add(1).cast()
    }

    fn check(&self, call: &str, bound: &str) -> Result<(), String> {
        let behind = self.all[self.len..].iter();
        match behind.filter(|x| **x != self.guard).count() {
            0 => Ok(()),
            _ => Err(format!("`{call}` wrote beyond `{bound}`, which was {}", self.len)),
        }
    }
}

/// Fails unless the call refused the unusable array.
fn refused(call: &str, array: &str, answer: i64) -> Result<(), String> {
    if answer == INVALID_ARGUMENT {
        return Ok(());
    }
    Err(format!(
        "`{call}` with {array} and a length above 0 answers {answer}; it must refuse it with {INVALID_ARGUMENT}"
    ))
}

/// Tests a function that writes a text, with buffers of every kind. `call` gets a pointer and a
/// capacity.
fn check_text(name: &str, call: impl Fn(*mut u8, usize) -> i64) -> Result<(), String> {
    // Null is allowed with a capacity of 0: the call then only answers the length of its text.
    let len = call(std::ptr::null_mut(), 0);
    refused(name, "a null `out`", call(std::ptr::null_mut(), 16))?;
    let whole = usize::try_from(len).unwrap_or(0);
    for capacity in [0, 1, whole / 2, whole.saturating_sub(1)] {
        let mut buffer = Guarded::before(capacity, whole, 0xA5u8);
        call(buffer.pointer(), capacity);
        buffer.check(name, "capacity")?;
    }
    Ok(())
}

impl<T: Table> Library<T> {
    fn check_texts(&self) -> Result<(), String> {
        let common = self.table.common();
        // SAFETY: a null pointer, or a live buffer of more than this length, by `check_text`.
        check_text("descriptor", |out, len| unsafe { (common.descriptor)(out, len) })?;
        // SAFETY: as above.
        check_text("endpoints", |out, len| unsafe { (common.endpoints)(out, len) })?;
        // SAFETY: as above.
        check_text("last_error", |out, len| unsafe { (common.last_error)(out, len) })
    }
}

impl Native<DeviceTable> {
    /// Returns the status and the text with which `open` refuses these lines, rate and block. If it
    /// opens a device instead, closes it and returns `None`.
    pub fn refusal_of_open(
        &self,
        lines: &str,
        rate_hz: f64,
        block_frames: u32,
    ) -> Option<(i64, String)> {
        let table = self.library.table;
        // SAFETY: a live text.
        let answer = unsafe { (table.open)(lines.as_ptr(), lines.len(), rate_hz, block_frames) };
        self.refusal(answer)
    }

    /// Fails unless every call refuses null and misaligned arrays and writes only within the given
    /// length.
    ///
    /// # Errors
    /// Names the call that is at fault, and how.
    pub fn check_arrays(&self, settings: &Settings, format: &StreamFormat) -> Result<(), String> {
        let (table, lines) = (self.library.table, self.lines(settings));
        let (text, null) = (lines.as_bytes(), std::ptr::null());
        self.library.check_texts()?;
        // SAFETY: null, which must be refused.
        let open = unsafe { (table.open)(null, 16, format.rate_hz, format.block_frames) };
        refused("open", "null `settings`", open)?;
        let mut out = Guarded::new(SAMPLES, 0xA5u8);
        // SAFETY: null, which must be refused, and a live buffer.
        let can = unsafe { (table.capabilities)(null, 16, out.pointer(), SAMPLES) };
        refused("capabilities", "null `settings`", can)?;
        // SAFETY: a live text, and a buffer by `check_text`.
        check_text("capabilities", |out, len| unsafe {
            (table.capabilities)(text.as_ptr(), text.len(), out, len)
        })?;
        self.check_write(&lines, format)?;
        self.check_status(&lines, format)
    }

    fn opened_by(&self, lines: &str, format: &StreamFormat) -> Result<Opened<DeviceTable>, String> {
        let (table, text) = (self.library.table, lines.as_bytes());
        let (rate_hz, block) = (format.rate_hz, format.block_frames);
        // SAFETY: a live text.
        let handle = unsafe { (table.open)(text.as_ptr(), text.len(), rate_hz, block) };
        self.opened(handle).map_err(|trouble| self.error("open", trouble).to_string())
    }

    /// Uses a new device for each array, because a refusal may close the device.
    fn check_write(&self, lines: &str, format: &StreamFormat) -> Result<(), String> {
        // Zeros do no harm if a faulty device plays them.
        let (write, mut samples) = (self.library.table.write, Guarded::new(SAMPLES, 0.0f32));
        for (array, pointer) in [
            ("null `samples`", std::ptr::null_mut()),
            ("misaligned `samples`", samples.misaligned()),
        ] {
            let device = self.opened_by(lines, format)?;
            // SAFETY: a pointer that must be refused; the misaligned one has a live buffer behind
            // it.
            let answer = unsafe { write(device.handle, pointer, SAMPLES, 0) };
            refused("write", array, answer)?;
        }
        Ok(())
    }

    fn check_status(&self, lines: &str, format: &StreamFormat) -> Result<(), String> {
        let device = self.opened_by(lines, format)?;
        let (status, handle) = (self.library.table.status, device.handle);
        // No device reports this number, so every write into the guard values shows.
        let mut out = Guarded::new(STATUS_NUMBERS, -1234.5f64);
        // SAFETY: null, which must be refused.
        let null = unsafe { status(handle, std::ptr::null_mut(), STATUS_NUMBERS) };
        refused("status", "a null `out`", null)?;
        // SAFETY: a pointer that must be refused, with a live buffer behind it.
        let misaligned = unsafe { status(handle, out.misaligned(), STATUS_NUMBERS) };
        refused("status", "a misaligned `out`", misaligned)?;
        for capacity in [0, 1, STATUS_NUMBERS - 1] {
            let mut out = Guarded::new(capacity, -1234.5f64);
            // SAFETY: a live buffer of this length and more.
            unsafe { status(handle, out.pointer(), capacity) };
            out.check("status", "capacity")?;
        }
        Ok(())
    }
}

impl Native<SourceTable> {
    /// [`Native::refusal_of_open`] for a source.
    pub fn refusal_of_lines(&self, lines: &str) -> Option<(i64, String)> {
        // SAFETY: a live text.
        let answer = unsafe { (self.library.table.open)(lines.as_ptr(), lines.len()) };
        self.refusal(answer)
    }

    /// [`Native::check_arrays`] for a source.
    ///
    /// # Errors
    /// Names the call that is at fault, and how.
    pub fn check_source_arrays(&self, settings: &Settings) -> Result<(), String> {
        let (table, told) = (self.library.table, |e: DeviceError| e.to_string());
        self.library.check_texts()?;
        // SAFETY: null, which must be refused.
        let open = unsafe { (table.open)(std::ptr::null(), 16) };
        refused("open", "null `settings`", open)?;
        let source = self.open_native(settings).map_err(told)?;
        let handle = source.handle();
        // SAFETY: a buffer by `check_text`.
        check_text("stream", |out, len| unsafe { (table.stream)(handle, out, len) })?;
        source.begin().map_err(told)?;
        let width = source.width();
        let mut samples = Guarded::new(width, -1234.5f64);
        // SAFETY: a live buffer of this length and more.
        unsafe { (table.read)(handle, samples.pointer(), width, 100) };
        samples.check("read", "len")?;
        for (array, pointer) in [
            ("null `samples`", std::ptr::null_mut()),
            ("misaligned `samples`", samples.misaligned()),
        ] {
            // SAFETY: a pointer that must be refused; the misaligned one has a live buffer behind
            // it.
            refused("read", array, unsafe { (table.read)(handle, pointer, width, 0) })?;
        }
        Ok(())
    }
}

impl<T: Table> Native<T> {
    /// Returns the number and the text if `open` gave a negative answer. Otherwise closes what it
    /// opened.
    fn refusal(&self, answer: i64) -> Option<(i64, String)> {
        if answer > 0 {
            (self.library.table.common().close)(answer);
            return None;
        }
        Some((answer, self.library.last_error()))
    }
}
