//! Adapters and sources behind the C functions: safe calls, checked results.

use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use crate::crossing::{incoming, wait_ms};
use crate::library::{Common, Library, Symbols, Table, Trouble};
use crate::source::abi::{ABI_MARKER, Code, SourceTable};
use crate::source::{Channel, Delivered, Source, SourceAdapter, SourceDescriptor, SourceStream};
use crate::{Descriptor, DeviceError, Endpoint, Settings, abi};

impl Table for SourceTable {
    type Code = Code;
    const KIND: &'static str = "source";
    const MARKER: u32 = ABI_MARKER;
    const ABI_VERSION: &'static str = "htex_source_abi_version";

    unsafe fn of_symbols(symbols: &Symbols<'_>) -> Result<Self, DeviceError> {
        // SAFETY: each field's type is that of the function of its name, by the ABI.
        unsafe {
            Ok(Self {
                abi_version: symbols.get(Self::ABI_VERSION)?,
                descriptor: symbols.get("htex_source_descriptor")?,
                last_error: symbols.get("htex_source_last_error")?,
                endpoints: symbols.get("htex_source_endpoints")?,
                open: symbols.get("htex_source_open")?,
                stream: symbols.get("htex_source_stream")?,
                start: symbols.get("htex_source_start")?,
                read: symbols.get("htex_source_read")?,
                stop: symbols.get("htex_source_stop")?,
                close: symbols.get("htex_source_close")?,
                extension: symbols.get("htex_source_extension")?,
            })
        }
    }

    fn common(&self) -> Common {
        Common {
            abi_version: self.abi_version,
            descriptor: self.descriptor,
            last_error: self.last_error,
            endpoints: self.endpoints,
            extension: self.extension,
        }
    }

    fn code(answer: i64) -> Code {
        Code::from_answer(answer)
    }

    /// `Overrun` and `End`, which only a read may return, become failures.
    fn incoming(code: Code, text: String, name: &str, library: &str) -> DeviceError {
        match code {
            Code::InvalidRate => DeviceError::Told(text),
            Code::Overrun | Code::End => DeviceError::Failed {
                device: name.to_owned(),
                what: text,
            },
            // The others have the numbers of devices.
            code => incoming(abi::Code::from_answer(code as i64), text, name, library),
        }
    }
}

/// An adapter of sources of a native library. Cheap to clone.
#[derive(Clone)]
pub struct NativeSourceAdapter {
    about: Arc<SourceDescriptor>,
    library: Library<SourceTable>,
}

impl std::fmt::Debug for NativeSourceAdapter {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (id, library) = (&self.descriptor().id, &self.library.name);
        let mut tuple = f.debug_tuple("NativeSourceAdapter");
        tuple.field(id).field(library).finish()
    }
}

impl NativeSourceAdapter {
    /// Loads a native library, which runs with all rights of this program.
    ///
    /// # Errors
    /// When the file is not a library of this machine or not a source of this ABI, or its descriptor
    /// is invalid.
    pub fn load(path: &Path) -> Result<Self, DeviceError> {
        Self::new(Library::load(path)?)
    }

    /// An adapter behind a table of this program; `name` identifies it in messages.
    ///
    /// # Errors
    /// As [`Self::load`].
    pub fn from_table(name: &str, table: &'static SourceTable) -> Result<Self, DeviceError> {
        Self::new(Library::of_table(name, table)?)
    }

    fn new(library: Library<SourceTable>) -> Result<Self, DeviceError> {
        let about = library.descriptor(SourceDescriptor::check)?;
        Ok(Self {
            about: Arc::new(about),
            library,
        })
    }

    /// Whether the source has the extension `id` (`htex.NAME/REV`, `com.vendor.NAME/REV`).
    ///
    /// # Errors
    /// When the result is neither 0 nor 1.
    pub fn has_extension(&self, id: &str) -> Result<bool, DeviceError> {
        self.library.has_extension(id)
    }

    /// As [`SourceAdapter::open`], as a type with further functions for checkers, and of lines that need not be settings.
    ///
    /// # Errors
    /// As [`SourceAdapter::open`].
    pub fn open_lines(&self, lines: &str) -> Result<NativeSource, DeviceError> {
        // SAFETY: a live text.
        let handle = unsafe { (self.library.table.open)(lines.as_ptr(), lines.len()) };
        match self.library.count(handle) {
            Ok(0) => Err(self.library.broken("open: the handle is 0")),
            Ok(_) => NativeSource::new(self.clone(), handle),
            Err(trouble) => Err(self
                .library
                .trouble(&self.about.descriptor.name, "open", trouble)),
        }
    }

    /// As [`SourceAdapter::open`], as a type with further functions for checkers.
    ///
    /// # Errors
    /// As [`SourceAdapter::open`].
    pub fn open_native(&self, settings: &Settings) -> Result<NativeSource, DeviceError> {
        self.open_lines(&settings.to_lines(self.descriptor()))
    }
}

impl SourceAdapter for NativeSourceAdapter {
    fn descriptor(&self) -> &Descriptor {
        &self.about.descriptor
    }

    fn target(&self) -> &str {
        &self.about.target
    }

    fn endpoints(&self) -> Result<Vec<Endpoint>, DeviceError> {
        self.library.endpoints(&self.about.descriptor.name)
    }

    fn open(&self, settings: &Settings) -> Result<Box<dyn Source>, DeviceError> {
        Ok(Box::new(self.open_native(settings)?))
    }
}

/// An open source of a native library; dropping it closes it.
#[derive(Debug)]
pub struct NativeSource {
    adapter: NativeSourceAdapter,
    handle: i64,
    stream: SourceStream,
    delivered: u64,
    /// Nothing is read any more: an error occurred.
    failed: bool,
    closed: bool,
}

impl NativeSource {
    /// The source of a handle, whose rate and channels are checked; closes the handle if they are invalid.
    fn new(adapter: NativeSourceAdapter, handle: i64) -> Result<Self, DeviceError> {
        let mut source = Self {
            adapter,
            handle,
            stream: SourceStream {
                rate_hz: 0.0,
                channels: Vec::new(),
            },
            delivered: 0,
            failed: false,
            closed: false,
        };
        source.stream = source.stream_again()?;
        Ok(source)
    }

    /// Asks for rate and channels.
    ///
    /// # Errors
    /// When they cannot be had, or are invalid.
    pub fn stream_again(&self) -> Result<SourceStream, DeviceError> {
        let (library, name) = (&self.adapter.library, self.name());
        // SAFETY: a buffer that is live and of this length, by `Library::text`.
        let call = |out, len| unsafe { (library.table.stream)(self.handle, out, len) };
        let stream: SourceStream = library.json(name, "stream", call)?;
        let checked = stream.check();
        checked.map_err(|what| library.broken(format!("stream: {what}")))?;
        Ok(stream)
    }

    /// For checkers of sources: closes the source and keeps its handle, so that later calls show
    /// whether the source refuses a handle that was closed. An app drops the source instead.
    ///
    /// # Errors
    /// The error of the source; when called a second time, that the handle is unknown.
    pub fn close_and_keep_handle(&mut self) -> Result<(), DeviceError> {
        (self.closed, self.failed) = (true, false);
        self.done("close", self.adapter.library.table.close)
    }

    fn name(&self) -> &str {
        &self.adapter.about.descriptor.name
    }

    fn done(&self, call: &str, function: extern "C" fn(i64) -> i64) -> Result<(), DeviceError> {
        let answer = function(self.handle);
        self.adapter.library.done(self.name(), call, answer)
    }

    /// The result of a read of at most `frames`.
    fn delivered(
        &mut self,
        answer: i64,
        frames: usize,
        samples: &[f64],
    ) -> Result<Delivered, DeviceError> {
        let library = &self.adapter.library;
        let width = self.stream.channels.len();
        match library.count(answer) {
            Ok(count) if count <= frames => {
                let written = &samples[..count * width];
                if let Some(bad) = written.iter().position(|x| !x.is_finite()) {
                    let (frame, channel) = (self.delivered + (bad / width) as u64, bad % width);
                    let (value, name) = (written[bad], &self.stream.channels[channel].name);
                    let what = format!("read: frame {frame} of channel `{name}` is {value}");
                    return Err(library.broken(what));
                }
                self.delivered += count as u64;
                Ok(Delivered::Frames(count))
            }
            Ok(count) => {
                let what = format!("read: it delivered {count} frames of {frames}");
                Err(library.broken(what))
            }
            Err(Trouble::Told(Code::End, _)) => Ok(Delivered::End),
            Err(Trouble::Told(Code::Overrun, advice)) => Err(DeviceError::Overrun {
                source_name: self.name().to_owned(),
                frames: self.delivered,
                advice,
            }),
            Err(trouble) => Err(library.trouble(self.name(), "read", trouble)),
        }
    }
}

impl Source for NativeSource {
    fn channels(&self) -> &[Channel] {
        &self.stream.channels
    }

    fn rate_hz(&self) -> f64 {
        self.stream.rate_hz
    }

    fn start(&mut self) -> Result<(), DeviceError> {
        self.done("start", self.adapter.library.table.start)
    }

    fn read(&mut self, samples: &mut [f64], timeout: Duration) -> Result<Delivered, DeviceError> {
        if self.failed {
            return Err(DeviceError::Closed(self.name().to_owned()));
        }
        let width = self.stream.channels.len();
        let frames = samples.len() / width;
        let (data, len) = (samples.as_mut_ptr(), frames * width);
        let read = self.adapter.library.table.read;
        // SAFETY: a live slice; `&mut self` keeps the handle to one thread at a time.
        let answer = unsafe { read(self.handle, data, len, wait_ms(timeout)) };
        let delivered = self.delivered(answer, frames, samples);
        self.failed = delivered.is_err();
        delivered
    }

    fn stop(&mut self) -> Result<(), DeviceError> {
        self.done("stop", self.adapter.library.table.stop)
    }
}

impl Drop for NativeSource {
    fn drop(&mut self) {
        if !self.closed {
            // An error of closing cannot be returned from a drop.
            (self.adapter.library.table.close)(self.handle);
        }
    }
}
