//! Adapters and devices from native libraries: loads the libraries, calls their C functions safely
//! and checks the results.
//!
//! A native library runs with all the rights of this program, so the user decides which libraries
//! to load. No library is ever unloaded, because open devices contain pointers into their
//! libraries.

use std::fmt;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use serde::de::DeserializeOwned;

use crate::abi::{
    ABI_MAJOR, ABI_MARKER, CloseFn, Code, DeviceTable, EntryFn, MAX_TEXT_BYTES, STATUS_NUMBERS,
};
use crate::crossing::{incoming, wait_ms};
use crate::{
    Adapter, Capabilities, Descriptor, DeviceError, DirectVoltage, Direction, Endpoint, Input,
    InputFrames, InputStream, LibraryFault, Output, Quantity, Settings, Status, StreamFormat,
};

/// The function that a library exports.
const ENTRY: &str = "htex_device_adapter";
/// Size of the buffer for the first attempt to read a text, bytes.
const USUAL_TEXT: usize = 16_384;
/// Maximum number of attempts to read a text whose length changes from call to call.
const TRIES: usize = 8;

/// An adapter from a native library. Cloning it is cheap, because clones share the loaded library.
#[derive(Clone)]
pub struct NativeAdapter {
    pub(crate) library: Arc<Library>,
}

/// A library's functions and its descriptor.
pub(crate) struct Library {
    /// For messages.
    name: String,
    pub(crate) table: DeviceTable,
    descriptor: Descriptor,
}

/// The failure of a call.
pub(crate) enum CallFailure {
    /// The library returned an error code and this error text.
    Code(Code, String),
    /// The library returned a result that the ABI does not allow.
    Answer(String),
}

/// Returns a function from the library's table. The function exists, because a library is loaded
/// only if it has all functions of its direction.
macro_rules! function {
    ($library:expr, $name:ident) => {
        $library.table.$name.ok_or_else(|| $library.lacks(stringify!($name)))?
    };
}
pub(crate) use function;

impl NativeAdapter {
    /// Loads a native library, which runs with all the rights of this program.
    ///
    /// # Errors
    /// Returns an error if the file is not a library for this machine, does not follow this ABI, or
    /// has an invalid descriptor.
    pub fn load(path: &Path) -> Result<Self, DeviceError> {
        let name = path.display().to_string();
        let error = |fault, what| DeviceError::Library { library: name.clone(), fault, what };
        // SAFETY: the user named the library and thereby allowed its initialisers to run.
        let library = unsafe { htex_base::native::Library::from_file(path) };
        let library = library.map_err(|reason| error(LibraryFault::Load, reason.to_string()))?;
        // SAFETY: by the ABI, the function of this name has this type.
        let entry: Option<EntryFn> = unsafe { library.symbol(ENTRY) };
        let table = entry.map(|entry| entry()).filter(|table| !table.is_null());
        let table = table.ok_or_else(|| {
            let what = format!("the library has no `{ENTRY}`; it is not an htex device");
            error(LibraryFault::Marker, what)
        })?;
        // SAFETY: a table of the ABI, which is never unloaded.
        unsafe { Self::from_pointer(&name, table) }
    }

    /// Creates an adapter from a table that is linked into this program. `name` identifies the
    /// adapter in messages.
    ///
    /// # Errors
    /// Returns the same errors as [`Self::load`].
    pub fn from_table(name: &str, table: &'static DeviceTable) -> Result<Self, DeviceError> {
        // SAFETY: a live table.
        unsafe { Self::from_pointer(name, table) }
    }

    /// # Safety
    /// `table` points to a marker and a size. If the marker is of this major version, `table`
    /// points to a table of this size. Its functions have the types of the ABI.
    unsafe fn from_pointer(name: &str, table: *const DeviceTable) -> Result<Self, DeviceError> {
        let error = |fault, what| DeviceError::Library { library: name.to_owned(), fault, what };
        // SAFETY: by the caller's promise. The whole table is read only if it is of this version.
        let (marker, size) = unsafe { ((*table).marker, (*table).size) };
        // The lowest byte is the minor version, which may differ.
        if marker >> 8 != ABI_MARKER >> 8 {
            return Err(error(
                LibraryFault::Marker,
                format!(
                    "the marker {marker:#x} is not of device ABI {ABI_MAJOR}.x, which this host loads"
                ),
            ));
        }
        if (size as usize) < size_of::<DeviceTable>() {
            let what = format!("a table of {size} bytes; {} are needed", size_of::<DeviceTable>());
            return Err(error(LibraryFault::Function, what));
        }
        // SAFETY: the caller promises that the table has the size that it states, and this size is
        // large enough.
        let table = unsafe { *table };
        let mut library =
            Library { name: name.to_owned(), table, descriptor: Descriptor::default() };
        library.check_functions(&[
            ("descriptor", table.descriptor.is_some()),
            ("last_error", table.last_error.is_some()),
            ("endpoints", table.endpoints.is_some()),
            ("open", table.open.is_some()),
            ("finish", table.finish.is_some()),
            ("close", table.close.is_some()),
            ("extension", table.extension.is_some()),
        ])?;
        library.descriptor = library.read_descriptor()?;
        match library.descriptor.direction {
            Direction::Output => library.check_functions(&[
                ("capabilities", table.capabilities.is_some()),
                ("write", table.write.is_some()),
                ("status", table.status.is_some()),
            ]),
            Direction::Input => library.check_functions(&[
                ("stream", table.stream.is_some()),
                ("start", table.start.is_some()),
                ("read", table.read.is_some()),
            ]),
        }?;
        Ok(Self { library: Arc::new(library) })
    }

    /// Whether the library has the extension `id` (`htex.NAME/REV`, `com.vendor.NAME/REV`).
    ///
    /// # Errors
    /// Returns an error if the result is neither 0 nor 1.
    pub fn has_extension(&self, id: &str) -> Result<bool, DeviceError> {
        let extension = function!(self.library, extension);
        // SAFETY: a live text.
        match unsafe { extension(id.as_ptr(), id.len()) } {
            0 => Ok(false),
            1 => Ok(true),
            other => Err(self.library.wrong(format!("extension `{id}`: it returns {other}"))),
        }
    }

    /// For checkers: calls the library's `capabilities` with lines of settings, which may be
    /// invalid.
    ///
    /// # Errors
    /// Returns the same errors as [`Adapter::capabilities`].
    pub fn capabilities_of(&self, lines: &str) -> Result<Capabilities, DeviceError> {
        self.check_direction(Direction::Output)?;
        let function = function!(self.library, capabilities);
        // SAFETY: the text is live, and `Library::text` passes a live buffer of this length.
        let call = |out, len| unsafe { function(lines.as_ptr(), lines.len(), out, len) };
        let capabilities: Capabilities = self.library.json("capabilities", call)?;
        capabilities.check().map_err(|error| self.library.wrong(error.to_string()))?;
        Ok(capabilities)
    }

    /// Opens an output as [`Adapter::open_output`] does. The returned type has further functions
    /// for checkers.
    ///
    /// # Errors
    /// Returns the same errors as [`Adapter::open_output`].
    pub fn open_native_output(
        &self,
        settings: &Settings,
        format: &StreamFormat,
    ) -> Result<NativeOutput, DeviceError> {
        let capabilities = self.capabilities(settings)?;
        let (rate_hz, device) = (format.rate_hz, || self.library.descriptor.name.clone());
        // The rates that a library states may be too low for its carrier.
        if rate_hz < capabilities.lowest_with_carrier_hz() {
            let rates = capabilities.rates_text();
            return Err(DeviceError::Rate { device: device(), rate_hz, rates });
        }
        let is_display = capabilities.quantity == Quantity::DisplayVoltage && capabilities.paced;
        let direct = is_display.then(|| DirectVoltage::from_settings(settings, rate_hz));
        let opened = self.open(&self.lines(settings), rate_hz, format.block_frames);
        let opened = opened.map_err(|failure| match failure {
            CallFailure::Code(Code::InvalidRate, _) => {
                let rates = capabilities.rates.to_string();
                DeviceError::Rate { device: device(), rate_hz, rates }
            }
            failure => self.library.error("open", failure),
        })?;
        Ok(NativeOutput { opened, capabilities, direct, written: 0 })
    }

    /// Opens an input as [`Adapter::open_input`] does. The returned type has further functions for
    /// checkers.
    ///
    /// # Errors
    /// Returns the same errors as [`Adapter::open_input`].
    pub fn open_native_input(&self, settings: &Settings) -> Result<NativeInput, DeviceError> {
        self.check_direction(Direction::Input)?;
        let opened = self.open(&self.lines(settings), 0.0, 0);
        let opened = opened.map_err(|failure| self.library.error("open", failure))?;
        let stream = opened.stream()?;
        Ok(NativeInput { opened, stream, delivered: 0, has_failed: false })
    }

    fn check_direction(&self, wanted: Direction) -> Result<(), DeviceError> {
        let Descriptor { direction, name, .. } = &self.library.descriptor;
        if *direction == wanted {
            return Ok(());
        }
        Err(DeviceError::Direction { device: name.clone(), wanted })
    }

    /// Writes the settings as lines of text, the form that the ABI requires.
    pub(crate) fn lines(&self, settings: &Settings) -> String {
        settings.to_lines(&self.library.descriptor)
    }

    pub(crate) fn open(
        &self,
        lines: &str,
        rate_hz: f64,
        block_frames: u32,
    ) -> Result<OpenHandle, CallFailure> {
        let lacks = || CallFailure::Answer("there is no such function".to_owned());
        let open = self.library.table.open.ok_or_else(lacks)?;
        // SAFETY: a live text.
        let handle = unsafe { open(lines.as_ptr(), lines.len(), rate_hz, block_frames) };
        match self.library.count(handle)? {
            0 => Err(CallFailure::Answer("the handle is 0".to_owned())),
            _ => Ok(OpenHandle { library: Arc::clone(&self.library), handle, is_closed: false }),
        }
    }
}

impl fmt::Debug for NativeAdapter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (id, library) = (&self.library.descriptor.id, &self.library.name);
        f.debug_tuple("NativeAdapter").field(id).field(library).finish()
    }
}

impl Adapter for NativeAdapter {
    fn descriptor(&self) -> &Descriptor {
        &self.library.descriptor
    }

    fn endpoints(&self) -> Result<Vec<Endpoint>, DeviceError> {
        let endpoints = function!(self.library, endpoints);
        // SAFETY: `Library::text` passes a live buffer of this length.
        self.library.json("endpoints", |out, len| unsafe { endpoints(out, len) })
    }

    fn capabilities(&self, settings: &Settings) -> Result<Capabilities, DeviceError> {
        self.capabilities_of(&self.lines(settings))
    }

    fn open_output(
        &self,
        settings: &Settings,
        format: &StreamFormat,
    ) -> Result<Box<dyn Output>, DeviceError> {
        Ok(Box::new(self.open_native_output(settings, format)?))
    }

    fn open_input(&self, settings: &Settings) -> Result<Box<dyn Input>, DeviceError> {
        Ok(Box::new(self.open_native_input(settings)?))
    }
}

impl Library {
    fn check_functions(&self, functions: &[(&str, bool)]) -> Result<(), DeviceError> {
        let missing = functions.iter().find(|(_, is_there)| !is_there);
        missing.map_or(Ok(()), |(name, _)| Err(self.lacks(name)))
    }

    /// Reads and checks the library's description of its adapter.
    fn read_descriptor(&self) -> Result<Descriptor, DeviceError> {
        let wrong = |what: String| self.fault(LibraryFault::Descriptor, what);
        let function = function!(self, descriptor);
        // SAFETY: `Self::text` passes a live buffer of this length.
        let json = self.text(|out, len| unsafe { function(out, len) });
        let json = json.map_err(|failure| match failure {
            CallFailure::Code(_, text) | CallFailure::Answer(text) => {
                wrong(format!("descriptor: {text}"))
            }
        })?;
        let descriptor: Descriptor =
            serde_json::from_str(&json).map_err(|error| wrong(format!("descriptor: {error}")))?;
        descriptor.check().map_err(|error| wrong(error.to_string()))?;
        Ok(descriptor)
    }

    /// Parses the JSON that a call returns. `name` is the name of the call.
    fn json<V: DeserializeOwned>(
        &self,
        name: &str,
        call: impl FnMut(*mut u8, usize) -> i64,
    ) -> Result<V, DeviceError> {
        let json = self.text(call).map_err(|failure| self.error(name, failure))?;
        serde_json::from_str(&json).map_err(|error| self.wrong(format!("{name}: {error}")))
    }

    /// Reads a text of unknown length, which may change between two calls.
    fn text(&self, mut call: impl FnMut(*mut u8, usize) -> i64) -> Result<String, CallFailure> {
        let mut bytes = vec![0; USUAL_TEXT];
        for _ in 0..TRIES {
            let len = self.count(call(bytes.as_mut_ptr(), bytes.len()))?;
            if len > MAX_TEXT_BYTES {
                let what = format!("a text of {len} bytes; {MAX_TEXT_BYTES} are allowed");
                return Err(CallFailure::Answer(what));
            }
            if len <= bytes.len() {
                bytes.truncate(len);
                let text = String::from_utf8(bytes);
                return text.map_err(|error| CallFailure::Answer(error.to_string()));
            }
            bytes.resize(len, 0);
        }
        Err(CallFailure::Answer("a text that grows at each call".to_owned()))
    }

    /// Interprets a result as a count. A negative result is a failure.
    fn count(&self, answer: i64) -> Result<usize, CallFailure> {
        if answer < 0 {
            return Err(CallFailure::Code(Code::from_answer(answer), self.last_error()));
        }
        usize::try_from(answer).map_err(|_| CallFailure::Answer(format!("it returned {answer}")))
    }

    /// Reads the text of this thread's last error.
    pub(crate) fn last_error(&self) -> String {
        let mut bytes = vec![0; USUAL_TEXT];
        // SAFETY: a live buffer of this length.
        let read = |last_error: crate::abi::LastError| unsafe {
            last_error(bytes.as_mut_ptr(), bytes.len())
        };
        let len = self.table.last_error.map_or(0, read);
        bytes.truncate(usize::try_from(len).unwrap_or(0));
        // A longer text was cut, perhaps inside a character.
        match String::from_utf8_lossy(&bytes) {
            text if text.is_empty() => "no reason given".to_owned(),
            text => text.into_owned(),
        }
    }

    /// Converts the failure of a call to an error.
    pub(crate) fn error(&self, call: &str, failure: CallFailure) -> DeviceError {
        match failure {
            CallFailure::Code(code, text) => {
                incoming(code, text, &self.descriptor.name, &self.name)
            }
            CallFailure::Answer(what) => self.wrong(format!("{call}: {what}")),
        }
    }

    /// Returns the error for a result that the ABI does not allow.
    pub(crate) fn wrong(&self, what: impl Into<String>) -> DeviceError {
        self.fault(LibraryFault::Answer, what.into())
    }

    pub(crate) fn lacks(&self, name: &str) -> DeviceError {
        let what = format!("the table has no `{name}`");
        self.fault(LibraryFault::Function, what)
    }

    fn fault(&self, fault: LibraryFault, what: String) -> DeviceError {
        DeviceError::Library { library: self.name.clone(), fault, what }
    }
}

/// The handle of an open device. Dropping it closes the device.
pub(crate) struct OpenHandle {
    library: Arc<Library>,
    pub(crate) handle: i64,
    is_closed: bool,
}

impl OpenHandle {
    /// Reads the rate and the channels of an input.
    fn stream(&self) -> Result<InputStream, DeviceError> {
        let function = function!(self.library, stream);
        // SAFETY: `Library::text` passes a live buffer of this length.
        let call = |out, len| unsafe { function(self.handle, out, len) };
        let stream: InputStream = self.library.json("stream", call)?;
        stream.check().map_err(|error| self.library.wrong(error.to_string()))?;
        Ok(stream)
    }

    /// Calls a function that takes the handle and must return 0.
    fn call(&self, name: &str, function: Option<CloseFn>) -> Result<(), DeviceError> {
        let function = function.ok_or_else(|| self.library.lacks(name))?;
        match self.library.count(function(self.handle)) {
            Ok(0) => Ok(()),
            Ok(other) => Err(self.library.wrong(format!("{name}: it returned {other}"))),
            Err(failure) => Err(self.library.error(name, failure)),
        }
    }

    fn finish(&self) -> Result<(), DeviceError> {
        self.call("finish", self.library.table.finish)
    }

    /// Closes the device but keeps its handle.
    fn close(&mut self) -> Result<(), DeviceError> {
        self.is_closed = true;
        self.call("close", self.library.table.close)
    }

    fn name(&self) -> String {
        self.library.descriptor.name.clone()
    }
}

impl Drop for OpenHandle {
    fn drop(&mut self) {
        if let (false, Some(close)) = (self.is_closed, self.library.table.close) {
            // A drop cannot return the error of closing.
            close(self.handle);
        }
    }
}

/// An open output of a native library. Dropping an output closes it.
pub struct NativeOutput {
    opened: OpenHandle,
    capabilities: Capabilities,
    /// Present if the device is a paced display.
    direct: Option<DirectVoltage>,
    written: u64,
}

impl NativeOutput {
    /// Returns the status as [`Output::status`] does, but reports an invalid result as an error.
    ///
    /// # Errors
    /// Returns an error if the device returns too few numbers, or a number that is negative or not
    /// finite.
    pub fn checked_status(&self) -> Result<Status, DeviceError> {
        let library = &self.opened.library;
        let status = function!(library, status);
        // NaN, so that a number that the device does not write is noticed.
        let mut numbers = [f64::NAN; STATUS_NUMBERS];
        // SAFETY: a live buffer of this length.
        let count = unsafe { status(self.opened.handle, numbers.as_mut_ptr(), numbers.len()) };
        let count = library.count(count).map_err(|failure| library.error("status", failure))?;
        let is_sane = |x: &f64| x.is_finite() && *x >= 0.0;
        if count < STATUS_NUMBERS || !numbers.iter().all(is_sane) {
            return Err(library.wrong(format!("status: {count} numbers, {numbers:?}")));
        }
        Ok(numbers.into())
    }

    /// For checkers: closes the device and keeps its handle, so that later calls show whether the
    /// library refuses a closed handle. An app drops the device instead.
    ///
    /// # Errors
    /// Returns the error that the device reports. A second call must return the error that the
    /// handle is unknown.
    pub fn close_and_keep_handle(&mut self) -> Result<(), DeviceError> {
        self.opened.close()
    }

    /// Closes the device if these samples would exceed the limit of the direct voltage. Closing
    /// sets its output to zero.
    fn check_direct(&mut self, samples: &[f32]) -> Result<(), DeviceError> {
        let Some(direct) = &self.direct else {
            return Ok(());
        };
        let Some(excess) = direct.excess(samples) else {
            return Ok(());
        };
        let error = match self.capabilities.check_samples(samples, self.written) {
            // Report NaN as such. A library might accept this sample, and the mean would then stay
            // NaN.
            Err(not_a_number) if excess.mean_v.is_nan() => not_a_number,
            _ => DeviceError::DirectVoltage {
                frame: self.written + excess.at as u64,
                mean_v: excess.mean_v,
                limit_v: direct.limit_v(),
            },
        };
        // Only closing sets the output of a library's device to zero.
        self.opened.close()?;
        Err(error)
    }

    /// Builds the error of a write, with details that only the host knows.
    fn write_error(&self, failure: CallFailure, samples: &[f32]) -> DeviceError {
        match failure {
            CallFailure::Code(Code::OverLimit, text) => {
                let found = self.capabilities.check_samples(samples, self.written);
                found.err().unwrap_or_else(|| {
                    self.opened.library.error("write", CallFailure::Code(Code::OverLimit, text))
                })
            }
            CallFailure::Code(Code::Underflow, advice) => {
                let frames = self.status().frames_played;
                DeviceError::Underflow { device: self.opened.name(), frames, advice }
            }
            failure => self.opened.library.error("write", failure),
        }
    }
}

impl Output for NativeOutput {
    fn write(&mut self, samples: &[f32], timeout: Duration) -> Result<usize, DeviceError> {
        self.check_direct(samples)?;
        let (data, len) = (samples.as_ptr(), samples.len());
        let (library, handle) = (&self.opened.library, self.opened.handle);
        let write = function!(library, write);
        // SAFETY: the slice is live, and because of `&mut self` only one thread at a time uses the
        // handle.
        let taken = unsafe { write(handle, data, len, wait_ms(timeout)) };
        match library.count(taken) {
            Ok(taken) if taken <= len => {
                self.written += taken as u64;
                if let Some(direct) = &mut self.direct {
                    direct.push(&samples[..taken]);
                }
                Ok(taken)
            }
            Ok(taken) => Err(library.wrong(format!("write: it took {taken} frames of {len}"))),
            Err(failure) => Err(self.write_error(failure, samples)),
        }
    }

    fn status(&self) -> Status {
        // If the device returns no valid status, the host still knows how many frames it took.
        self.checked_status()
            .unwrap_or(Status { frames_written: self.written, ..Status::default() })
    }

    fn finish(&mut self) -> Result<(), DeviceError> {
        self.opened.finish()
    }
}

/// An open input of a native library. Dropping an input closes it.
///
/// The host checks every rate, channel, count and sample, so that a faulty library cannot corrupt a
/// recording unnoticed.
pub struct NativeInput {
    opened: OpenHandle,
    stream: InputStream,
    /// Frames delivered so far.
    delivered: u64,
    /// After an error nothing more is read.
    has_failed: bool,
}

impl NativeInput {
    /// For checkers: reads the rate and the channels again, which must not change.
    ///
    /// # Errors
    /// Returns an error if the library returns no valid stream.
    pub fn stream_again(&self) -> Result<InputStream, DeviceError> {
        self.opened.stream()
    }

    /// For checkers: closes the device and keeps its handle, so that later calls show whether the
    /// library refuses a closed handle. An app drops the device instead.
    ///
    /// # Errors
    /// Returns the error that the device reports. A second call must return the error that the
    /// handle is unknown.
    pub fn close_and_keep_handle(&mut self) -> Result<(), DeviceError> {
        // Later reads must reach the library, because the library must refuse them.
        self.has_failed = false;
        self.opened.close()
    }

    pub(crate) fn handle(&self) -> i64 {
        self.opened.handle
    }

    /// Checks the result of a read of at most `frames` frames.
    fn frames_read(
        &mut self,
        answer: i64,
        frames: usize,
        samples: &[f64],
    ) -> Result<InputFrames, DeviceError> {
        let library = &self.opened.library;
        let channels = &self.stream.channels;
        match library.count(answer) {
            Ok(count) if count <= frames => {
                let written = &samples[..count * channels.len()];
                if let Some(bad) = written.iter().position(|x| !x.is_finite()) {
                    let frame = self.delivered + (bad / channels.len()) as u64;
                    let (value, name) = (written[bad], &channels[bad % channels.len()].name);
                    let what = format!("read: frame {frame} of channel `{name}` is {value}");
                    return Err(library.wrong(what));
                }
                self.delivered += count as u64;
                Ok(InputFrames::Count(count))
            }
            Ok(count) => {
                Err(library.wrong(format!("read: it delivered {count} frames of {frames}")))
            }
            Err(CallFailure::Code(Code::End, _)) => Ok(InputFrames::End),
            Err(CallFailure::Code(Code::Overrun, advice)) => {
                let (device, frames) = (self.opened.name(), self.delivered);
                Err(DeviceError::Overrun { device, frames, advice })
            }
            Err(failure) => Err(library.error("read", failure)),
        }
    }
}

impl Input for NativeInput {
    fn stream(&self) -> &InputStream {
        &self.stream
    }

    fn start(&mut self) -> Result<(), DeviceError> {
        self.opened.call("start", self.opened.library.table.start)
    }

    fn read(&mut self, samples: &mut [f64], timeout: Duration) -> Result<InputFrames, DeviceError> {
        if self.has_failed {
            return Err(DeviceError::Closed(self.opened.name()));
        }
        let read = function!(self.opened.library, read);
        // There is at least one channel, because `InputStream::check` refuses an input without
        // channels.
        let width = self.stream.channels.len();
        let frames = samples.len() / width;
        let (data, len) = (samples.as_mut_ptr(), frames * width);
        // SAFETY: the slice is live, and because of `&mut self` only one thread at a time uses the
        // handle.
        let answer = unsafe { read(self.opened.handle, data, len, wait_ms(timeout)) };
        let result = self.frames_read(answer, frames, samples);
        self.has_failed = result.is_err();
        result
    }

    fn finish(&mut self) -> Result<(), DeviceError> {
        self.opened.finish()
    }
}
