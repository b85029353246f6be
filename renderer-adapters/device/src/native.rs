//! Adapters and devices behind the C functions: safe calls, checked results.

use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use serde::de::DeserializeOwned;

use crate::abi::{Code, DeviceTable, STATUS_NUMBERS};
use crate::crossing::incoming;
use crate::library::{Library, Trouble};
use crate::{
    AbiFault, Adapter, Capabilities, Descriptor, Device, DeviceError, Endpoint, Settings, Status,
    StreamFormat,
};

/// Longest wait of one call, ms: a day.
const MAX_WAIT_MS: u32 = 86_400_000;

/// An adapter of a native library. Cheap to clone.
#[derive(Clone)]
pub struct NativeAdapter {
    descriptor: Arc<Descriptor>,
    library: Library,
}

impl std::fmt::Debug for NativeAdapter {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (id, library) = (&self.descriptor.id, &self.library.name);
        f.debug_tuple("NativeAdapter")
            .field(id)
            .field(library)
            .finish()
    }
}

impl NativeAdapter {
    /// Loads a native library, which runs with all rights of this program.
    ///
    /// # Errors
    /// When the file is not a library of this machine or not a device of this ABI, or its descriptor
    /// is invalid.
    pub fn load(path: &Path) -> Result<Self, DeviceError> {
        Self::new(Library::load(path)?)
    }

    /// An adapter behind a table of this program; `name` identifies it in messages.
    ///
    /// # Errors
    /// As [`Self::load`].
    pub fn from_table(name: &str, table: &'static DeviceTable) -> Result<Self, DeviceError> {
        Self::new(Library::of_table(name, table)?)
    }

    fn new(library: Library) -> Result<Self, DeviceError> {
        // SAFETY: the buffer is live and of this length, by `Library::text`.
        let json = library.text(|out, len| unsafe { (library.table.descriptor)(out, len) });
        let wrong = |what: String| library.error(AbiFault::Descriptor(what));
        let json = json.map_err(|trouble| match trouble {
            Trouble::Told(_, text) | Trouble::Broken(text) => wrong(text),
        })?;
        let descriptor: Descriptor =
            serde_json::from_str(&json).map_err(|e| wrong(e.to_string()))?;
        descriptor
            .check()
            .map_err(|error| wrong(error.to_string()))?;
        Ok(Self {
            descriptor: Arc::new(descriptor),
            library,
        })
    }

    /// Whether the device has the extension `id` (`htex.NAME/REV`, `com.vendor.NAME/REV`).
    ///
    /// # Errors
    /// When the result is neither 0 nor 1.
    pub fn has_extension(&self, id: &str) -> Result<bool, DeviceError> {
        // SAFETY: a live text.
        match unsafe { (self.library.table.extension)(id.as_ptr(), id.len()) } {
            0 => Ok(false),
            1 => Ok(true),
            other => Err(self
                .library
                .broken(format!("extension `{id}`: it returns {other}"))),
        }
    }

    /// As [`Adapter::capabilities`], of lines that need not be settings: for checkers of devices.
    ///
    /// # Errors
    /// As [`Adapter::capabilities`].
    pub fn capabilities_of(&self, lines: &str) -> Result<Capabilities, DeviceError> {
        let name = "capabilities";
        // SAFETY: a live text, and a buffer that is live and of this length, by `Library::text`.
        let capabilities: Capabilities = self.json(name, |out, len| unsafe {
            (self.library.table.capabilities)(lines.as_ptr(), lines.len(), out, len)
        })?;
        let checked = capabilities.check();
        checked.map_err(|what| self.library.broken(format!("{name}: {what}")))?;
        Ok(capabilities)
    }

    /// As [`Adapter::open`], as a type with further functions for checkers.
    ///
    /// # Errors
    /// As [`Adapter::open`].
    pub fn open_native(
        &self,
        settings: &Settings,
        format: &StreamFormat,
    ) -> Result<NativeDevice, DeviceError> {
        let capabilities = self.capabilities(settings)?;
        let lines = settings.to_lines(&self.descriptor);
        let (rate_hz, block) = (format.rate_hz, format.block_frames);
        // SAFETY: a live text.
        let handle =
            unsafe { (self.library.table.open)(lines.as_ptr(), lines.len(), rate_hz, block) };
        match self.library.count(handle) {
            Ok(0) => Err(self.library.broken("open: the handle is 0")),
            Ok(_) => Ok(NativeDevice {
                adapter: self.clone(),
                capabilities,
                handle,
                written: 0,
                closed: false,
            }),
            Err(Trouble::Told(Code::InvalidRate, _)) => Err(DeviceError::Rate {
                device: self.descriptor.name.clone(),
                rate_hz,
                rates: capabilities.rates.to_string(),
            }),
            Err(trouble) => Err(self.error("open", trouble)),
        }
    }

    fn error(&self, call: &str, trouble: Trouble) -> DeviceError {
        match trouble {
            Trouble::Told(code, text) => {
                incoming(code, text, &self.descriptor.name, &self.library.name)
            }
            Trouble::Broken(what) => self.library.broken(format!("{call}: {what}")),
        }
    }

    /// The JSON that a call returns.
    fn json<T: DeserializeOwned>(
        &self,
        name: &str,
        call: impl FnMut(*mut u8, usize) -> i64,
    ) -> Result<T, DeviceError> {
        let json = self
            .library
            .text(call)
            .map_err(|trouble| self.error(name, trouble))?;
        serde_json::from_str(&json).map_err(|e| self.library.broken(format!("{name}: {e}")))
    }
}

impl Adapter for NativeAdapter {
    fn descriptor(&self) -> &Descriptor {
        &self.descriptor
    }

    fn endpoints(&self) -> Result<Vec<Endpoint>, DeviceError> {
        // SAFETY: the buffer is live and of this length, by `Library::text`.
        self.json("endpoints", |out, len| unsafe {
            (self.library.table.endpoints)(out, len)
        })
    }

    fn capabilities(&self, settings: &Settings) -> Result<Capabilities, DeviceError> {
        self.capabilities_of(&settings.to_lines(&self.descriptor))
    }

    fn open(
        &self,
        settings: &Settings,
        format: &StreamFormat,
    ) -> Result<Box<dyn Device>, DeviceError> {
        Ok(Box::new(self.open_native(settings, format)?))
    }
}

/// An open device of a native library; dropping it closes it.
#[derive(Debug)]
pub struct NativeDevice {
    adapter: NativeAdapter,
    capabilities: Capabilities,
    handle: i64,
    written: u64,
    closed: bool,
}

impl NativeDevice {
    fn table(&self) -> &'static DeviceTable {
        self.adapter.library.table
    }

    /// As [`Device::status`], with an error for an invalid result.
    ///
    /// # Errors
    /// When the device returns too few numbers, or NaN.
    pub fn checked_status(&self) -> Result<Status, DeviceError> {
        let mut numbers = [f64::NAN; STATUS_NUMBERS];
        // SAFETY: a live buffer of this length.
        let count =
            unsafe { (self.table().status)(self.handle, numbers.as_mut_ptr(), numbers.len()) };
        let count = self.adapter.library.count(count);
        let count = count.map_err(|trouble| self.adapter.error("status", trouble))?;
        let sane = |x: &f64| x.is_finite() && *x >= 0.0;
        if count < STATUS_NUMBERS || !numbers.iter().all(sane) {
            let what = format!("status: {count} numbers, {numbers:?}");
            return Err(self.adapter.library.broken(what));
        }
        Ok(numbers.into())
    }

    /// For checkers of devices: closes the device and keeps its handle, so that later calls show
    /// whether the device refuses a handle that was closed. An app drops the device instead.
    ///
    /// # Errors
    /// The error of the device; when called a second time, that the handle is unknown.
    pub fn close_and_keep_handle(&mut self) -> Result<(), DeviceError> {
        self.closed = true;
        self.done("close", (self.table().close)(self.handle))
    }

    /// A status that must be 0.
    fn done(&self, call: &str, answer: i64) -> Result<(), DeviceError> {
        match self.adapter.library.count(answer) {
            Ok(0) => Ok(()),
            Ok(other) => Err(self
                .adapter
                .library
                .broken(format!("{call}: it returned {other}"))),
            Err(trouble) => Err(self.adapter.error(call, trouble)),
        }
    }

    /// The error of a write, with the details that only this side knows.
    fn write_error(&self, trouble: Trouble, samples: &[f32]) -> DeviceError {
        match trouble {
            Trouble::Told(Code::OverLimit, text) => {
                let found = self.capabilities.check_samples(samples, self.written);
                let at_fault = || {
                    self.adapter
                        .error("write", Trouble::Told(Code::OverLimit, text))
                };
                found.err().unwrap_or_else(at_fault)
            }
            Trouble::Told(Code::Underflow, advice) => DeviceError::Underflow {
                device: self.adapter.descriptor.name.clone(),
                frames: self.status().frames_played,
                advice,
            },
            trouble => self.adapter.error("write", trouble),
        }
    }
}

impl Device for NativeDevice {
    fn write(&mut self, samples: &[f32], timeout: Duration) -> Result<usize, DeviceError> {
        // A wait shorter than a millisecond is still a wait.
        let wait_ms = timeout
            .as_micros()
            .div_ceil(1000)
            .min(u128::from(MAX_WAIT_MS)) as u32;
        let (data, len) = (samples.as_ptr(), samples.len());
        // SAFETY: a live slice; `&mut self` keeps the handle to one thread at a time.
        let taken = unsafe { (self.table().write)(self.handle, data, len, wait_ms) };
        match self.adapter.library.count(taken) {
            Ok(taken) if taken <= len => {
                self.written += taken as u64;
                Ok(taken)
            }
            Ok(taken) => {
                let what = format!("write: it took {taken} frames of {len}");
                Err(self.adapter.library.broken(what))
            }
            Err(trouble) => Err(self.write_error(trouble, samples)),
        }
    }

    fn status(&self) -> Status {
        // A device that cannot tell has still taken what it took.
        self.checked_status().unwrap_or(Status {
            frames_written: self.written,
            ..Status::default()
        })
    }

    fn finish(&mut self) -> Result<(), DeviceError> {
        self.done("finish", (self.table().finish)(self.handle))
    }
}

impl Drop for NativeDevice {
    fn drop(&mut self) {
        if !self.closed {
            // An error of closing cannot be returned from a drop.
            (self.table().close)(self.handle);
        }
    }
}
