//! For checkers: calls with arguments that a host never passes. Apps do not need them.

use std::ptr::{null, null_mut};

use crate::abi::{Code, STATUS_NUMBERS};
use crate::native::{NativeAdapter, OpenHandle, function};
use crate::{DeviceError, Direction, Input, Settings, StreamFormat};

/// Minimum number of guard values after a buffer, which show writes beyond its end.
const GUARDS: usize = 64;
/// Number of values in a buffer of samples.
const SAMPLES: usize = 8;
/// A number that no device writes, so that every write into guard values shows.
const UNUSUAL: f64 = -1234.5;
const INVALID_ARGUMENT: i64 = Code::InvalidArgument as i64;

/// A buffer of `len` values, followed by guard values.
struct GuardedBuffer<T> {
    all: Vec<T>,
    len: usize,
    guard: T,
}

impl<T: Copy + PartialEq> GuardedBuffer<T> {
    fn new(len: usize, guard: T) -> Self {
        Self::before(len, GUARDS, guard)
    }

    /// Creates a buffer with at least `guards` guard values. The guard values absorb what a call
    /// writes if it ignores the length.
    fn before(len: usize, guards: usize, guard: T) -> Self {
        let all = vec![guard; len + guards.max(GUARDS)];
        Self { all, len, guard }
    }

    /// Returns the address of the buffer. A faulty call may also overwrite the guard values after
    /// it.
    fn pointer(&mut self) -> *mut T {
        self.all.as_mut_ptr()
    }

    /// Returns an address that is misaligned for every value of more than one byte.
    fn misaligned(&mut self) -> *mut T {
        self.pointer().cast::<u8>().wrapping_add(1).cast()
    }

    fn has_overflow(&self) -> bool {
        self.all[self.len..].iter().any(|x| *x != self.guard)
    }
}

impl NativeAdapter {
    /// Calls `open` with these settings, rate and block size, and returns the error code and the
    /// error text of `open`. If `open` succeeds, closes the device and returns `None`. For an
    /// input, `rate_hz` and `block_frames` are 0.
    pub fn refusal_of_open(
        &self,
        lines: &str,
        rate_hz: f64,
        block_frames: u32,
    ) -> Option<(i64, String)> {
        let open = self.library.table.open?;
        // SAFETY: a live text.
        let answer = unsafe { open(lines.as_ptr(), lines.len(), rate_hz, block_frames) };
        if answer > 0 {
            let close = self.library.table.close?;
            close(answer);
            return None;
        }
        Some((answer, self.library.last_error()))
    }

    /// Checks that every call refuses null arrays and misaligned arrays, and that it writes only
    /// within the given length. For an input, the numbers in `format` are 0.
    ///
    /// # Errors
    /// Returns an error if a call is faulty. The error names the call and its fault.
    pub fn check_arrays(
        &self,
        settings: &Settings,
        format: &StreamFormat,
    ) -> Result<(), DeviceError> {
        let library = &self.library;
        let descriptor = function!(library, descriptor);
        // SAFETY: a null pointer, or a live buffer of more than this length, by `check_text`.
        self.check_text("descriptor", |out, len| unsafe { descriptor(out, len) })?;
        let endpoints = function!(library, endpoints);
        // SAFETY: as above.
        self.check_text("endpoints", |out, len| unsafe { endpoints(out, len) })?;
        let last_error = function!(library, last_error);
        // SAFETY: as above.
        self.check_text("last_error", |out, len| unsafe { last_error(out, len) })?;
        let open = function!(library, open);
        // SAFETY: null, which must be refused.
        let answer = unsafe { open(null(), 16, format.rate_hz, format.block_frames) };
        self.check_refused("open", "null `settings`", answer)?;
        match crate::Adapter::descriptor(self).direction {
            Direction::Output => self.check_output_arrays(&self.lines(settings), format),
            Direction::Input => self.check_input_arrays(settings),
        }
    }

    fn check_output_arrays(&self, lines: &str, format: &StreamFormat) -> Result<(), DeviceError> {
        let capabilities = function!(self.library, capabilities);
        let mut out = GuardedBuffer::new(SAMPLES, 0xA5u8);
        // SAFETY: null, which must be refused, and a live buffer.
        let answer = unsafe { capabilities(null(), 16, out.pointer(), SAMPLES) };
        self.check_refused("capabilities", "null `settings`", answer)?;
        // SAFETY: a live text, and a buffer by `check_text`.
        self.check_text("capabilities", |out, len| unsafe {
            capabilities(lines.as_ptr(), lines.len(), out, len)
        })?;
        // Zeros do no harm if a faulty device plays them.
        let (write, mut samples) =
            (function!(self.library, write), GuardedBuffer::new(SAMPLES, 0.0f32));
        for (array, pointer) in
            [("null `samples`", null_mut()), ("misaligned `samples`", samples.misaligned())]
        {
            // A new device for each array, because a refusal may close the device.
            let device = self.open_lines(lines, format)?;
            // SAFETY: the device must refuse this pointer; if the pointer is misaligned, it still
            // points into a live buffer.
            let answer = unsafe { write(device.handle, pointer, SAMPLES, 0) };
            self.check_refused("write", array, answer)?;
        }
        self.check_status(&self.open_lines(lines, format)?)
    }

    fn open_lines(&self, lines: &str, format: &StreamFormat) -> Result<OpenHandle, DeviceError> {
        let opened = self.open(lines, format.rate_hz, format.block_frames);
        opened.map_err(|failure| self.library.error("open", failure))
    }

    fn check_status(&self, device: &OpenHandle) -> Result<(), DeviceError> {
        let (status, handle) = (function!(self.library, status), device.handle);
        let mut out = GuardedBuffer::new(STATUS_NUMBERS, UNUSUAL);
        // SAFETY: null, which must be refused.
        let answer = unsafe { status(handle, null_mut(), STATUS_NUMBERS) };
        self.check_refused("status", "a null `out`", answer)?;
        // SAFETY: the device must refuse this pointer, which points into a live buffer.
        let answer = unsafe { status(handle, out.misaligned(), STATUS_NUMBERS) };
        self.check_refused("status", "a misaligned `out`", answer)?;
        for capacity in [0, 1, STATUS_NUMBERS - 1] {
            let mut out = GuardedBuffer::new(capacity, UNUSUAL);
            // SAFETY: a live buffer of this length and more.
            unsafe { status(handle, out.pointer(), capacity) };
            self.check_within("status", "capacity", &out)?;
        }
        Ok(())
    }

    fn check_input_arrays(&self, settings: &Settings) -> Result<(), DeviceError> {
        let mut input = self.open_native_input(settings)?;
        let handle = input.handle();
        let stream = function!(self.library, stream);
        // SAFETY: a buffer by `check_text`.
        self.check_text("stream", |out, len| unsafe { stream(handle, out, len) })?;
        input.start()?;
        let (read, width) = (function!(self.library, read), input.stream().channels.len());
        let mut samples = GuardedBuffer::new(width, UNUSUAL);
        // SAFETY: a live buffer of this length and more.
        unsafe { read(handle, samples.pointer(), width, 100) };
        self.check_within("read", "len", &samples)?;
        for (array, pointer) in
            [("null `samples`", null_mut()), ("misaligned `samples`", samples.misaligned())]
        {
            // SAFETY: the device must refuse this pointer; if the pointer is misaligned, it still
            // points into a live buffer.
            self.check_refused("read", array, unsafe { read(handle, pointer, width, 0) })?;
        }
        Ok(())
    }

    /// Tests a function that writes a text, with buffers of every kind. `call` gets a pointer and a
    /// capacity.
    fn check_text(
        &self,
        name: &str,
        call: impl Fn(*mut u8, usize) -> i64,
    ) -> Result<(), DeviceError> {
        // Null is allowed with a capacity of 0: the call then only answers the length of its text.
        let len = call(null_mut(), 0);
        self.check_refused(name, "a null `out`", call(null_mut(), 16))?;
        let whole = usize::try_from(len).unwrap_or(0);
        for capacity in [0, 1, whole / 2, whole.saturating_sub(1)] {
            let mut buffer = GuardedBuffer::before(capacity, whole, 0xA5u8);
            call(buffer.pointer(), capacity);
            self.check_within(name, "capacity", &buffer)?;
        }
        Ok(())
    }

    /// Fails unless the call refused the unusable array.
    fn check_refused(&self, call: &str, array: &str, answer: i64) -> Result<(), DeviceError> {
        if answer == INVALID_ARGUMENT {
            return Ok(());
        }
        Err(self.library.wrong(format!(
            "`{call}` with {array} and a length above 0 answers {answer}; it must refuse it with {INVALID_ARGUMENT}"
        )))
    }

    fn check_within<T: Copy + PartialEq>(
        &self,
        call: &str,
        bound: &str,
        buffer: &GuardedBuffer<T>,
    ) -> Result<(), DeviceError> {
        if buffer.has_overflow() {
            let what = format!("`{call}` wrote beyond `{bound}`, which was {}", buffer.len);
            return Err(self.library.wrong(what));
        }
        Ok(())
    }
}
