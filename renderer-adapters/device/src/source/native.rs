//! Source adapters and sources of native libraries: safe calls of the C functions, checked results.

use std::time::Duration;

use htex_base::native::{Symbols, table_of_symbols};

use crate::crossing::{incoming, wait_ms};
use crate::library::{Common, Table, Trouble};
use crate::loaded::{Native, Opened};
use crate::source::abi::{ABI_MARKER, Code, SourceTable};
use crate::source::{Channel, Delivered, Source, SourceAdapter, SourceDescriptor, SourceStream};
use crate::{Descriptor, DescriptorError, DeviceError, Endpoint, Settings, abi};

impl Table for SourceTable {
    type Code = Code;
    type About = SourceDescriptor;
    const KIND: &'static str = "source";
    const MARKER: u32 = ABI_MARKER;
    const ABI_VERSION: &'static str = "htex_source_abi_version";

    unsafe fn of_symbols(symbols: &Symbols<'_, DeviceError>) -> Result<Self, DeviceError> {
        // SAFETY: each field's type is that of the function of its name, by the ABI.
        Ok(unsafe {
            table_of_symbols!(
                symbols, Self, "htex_source_",
                abi_version descriptor last_error endpoints
                open stream start read stop close extension
            )
        })
    }

    fn common(&self) -> Common {
        Common {
            abi_version: self.abi_version,
            descriptor: self.descriptor,
            last_error: self.last_error,
            endpoints: self.endpoints,
            close: self.close,
            extension: self.extension,
        }
    }

    fn check(about: &SourceDescriptor) -> Result<(), DescriptorError> {
        about.check()
    }

    fn descriptor_of(about: &SourceDescriptor) -> &Descriptor {
        &about.descriptor
    }

    fn code(answer: i64) -> Code {
        Code::from_answer(answer)
    }

    /// Only a read may return `Overrun` and `End`; from another call they become failures.
    fn incoming(code: Code, text: String, name: &str, library: &str) -> DeviceError {
        match code {
            Code::InvalidRate => DeviceError::Told(text),
            Code::Overrun | Code::End => {
                DeviceError::Failed { device: name.to_owned(), what: text }
            }
            // The other codes have the same numbers as for devices.
            code => incoming(abi::Code::from_answer(code as i64), text, name, library),
        }
    }
}

/// A source adapter from a native library.
pub type NativeSourceAdapter = Native<SourceTable>;

impl NativeSourceAdapter {
    /// Opens a source from lines of settings, which may be invalid. The returned type has further
    /// functions for checkers.
    ///
    /// # Errors
    /// The errors of [`SourceAdapter::open`].
    pub fn open_lines(&self, lines: &str) -> Result<NativeSource, DeviceError> {
        // SAFETY: a live text.
        let handle = unsafe { (self.library.table.open)(lines.as_ptr(), lines.len()) };
        let opened = self.opened(handle);
        NativeSource::new(opened.map_err(|trouble| self.error("open", trouble))?)
    }

    /// Opens a source as [`SourceAdapter::open`] does. The returned type has further functions for
    /// checkers.
    ///
    /// # Errors
    /// The errors of [`SourceAdapter::open`].
    pub fn open_native(&self, settings: &Settings) -> Result<NativeSource, DeviceError> {
        self.open_lines(&self.lines(settings))
    }
}

impl SourceAdapter for NativeSourceAdapter {
    fn descriptor(&self) -> &Descriptor {
        self.described()
    }

    fn target(&self) -> &str {
        &self.about.target
    }

    fn endpoints(&self) -> Result<Vec<Endpoint>, DeviceError> {
        self.library.endpoints(self.name())
    }

    fn open(&self, settings: &Settings) -> Result<Box<dyn Source>, DeviceError> {
        Ok(Box::new(self.open_native(settings)?))
    }
}

/// An open source of a native library. Dropping it closes it.
#[derive(Debug)]
pub struct NativeSource {
    opened: Opened<SourceTable>,
    stream: SourceStream,
    delivered: u64,
    /// After an error nothing more is read.
    failed: bool,
}

impl NativeSource {
    /// Checks the rate and the channels. Closes the source if they are invalid.
    fn new(opened: Opened<SourceTable>) -> Result<Self, DeviceError> {
        let mut source = Self {
            opened,
            stream: SourceStream { rate_hz: 0.0, channels: Vec::new() },
            delivered: 0,
            failed: false,
        };
        source.stream = source.stream_again()?;
        Ok(source)
    }

    /// Asks the library for the rate and the channels.
    ///
    /// # Errors
    /// When the library does not return them, or they are invalid.
    pub fn stream_again(&self) -> Result<SourceStream, DeviceError> {
        let (library, name) = (&self.opened.adapter.library, self.name());
        // SAFETY: a buffer that is live and of this length, by `Library::text`.
        let call = |out, len| unsafe { (library.table.stream)(self.opened.handle, out, len) };
        let stream: SourceStream = library.json(name, "stream", call)?;
        let checked = stream.check();
        checked.map_err(|what| library.broken(format!("stream: {what}")))?;
        Ok(stream)
    }

    /// For checkers: closes the source and keeps its handle, so that later calls show whether the
    /// library refuses a closed handle. An app drops the source instead.
    ///
    /// # Errors
    /// The error of the source. A second call must return that the handle is unknown.
    pub fn close_and_keep_handle(&mut self) -> Result<(), DeviceError> {
        // Later reads must reach the library, because it is the one to refuse them.
        self.failed = false;
        self.opened.close()
    }

    fn name(&self) -> &str {
        self.opened.adapter.name()
    }

    pub(crate) fn handle(&self) -> i64 {
        self.opened.handle
    }

    /// Number of samples in a frame.
    pub(crate) fn width(&self) -> usize {
        self.stream.channels.len()
    }

    pub(crate) fn begin(&self) -> Result<(), DeviceError> {
        self.opened.done("start", self.opened.table().start)
    }

    /// Checks the answer to a read of at most `frames` frames.
    fn delivered(
        &mut self,
        answer: i64,
        frames: usize,
        samples: &[f64],
    ) -> Result<Delivered, DeviceError> {
        let adapter = &self.opened.adapter;
        let library = &adapter.library;
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
            Err(trouble) => Err(adapter.error("read", trouble)),
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
        self.begin()
    }

    fn read(&mut self, samples: &mut [f64], timeout: Duration) -> Result<Delivered, DeviceError> {
        if self.failed {
            return Err(DeviceError::Closed(self.name().to_owned()));
        }
        let width = self.stream.channels.len();
        // The width is not 0, because `SourceStream::check` refuses a source without channels.
        let frames = samples.len() / width;
        let (data, len) = (samples.as_mut_ptr(), frames * width);
        let read = self.opened.table().read;
        // SAFETY: a live slice; `&mut self` keeps the handle to one thread at a time.
        let answer = unsafe { read(self.opened.handle, data, len, wait_ms(timeout)) };
        let delivered = self.delivered(answer, frames, samples);
        self.failed = delivered.is_err();
        delivered
    }

    fn stop(&mut self) -> Result<(), DeviceError> {
        self.opened.done("stop", self.opened.table().stop)
    }
}
