//! Adapters and devices behind the C functions: safe calls, checked results.

use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use crate::abi::{ABI_MARKER, Code, DeviceTable, STATUS_NUMBERS};
use crate::crossing::{incoming, wait_ms};
use crate::library::{Common, Library, Symbols, Table, Trouble};
use crate::{
    Adapter, Capabilities, Descriptor, Device, DeviceError, Endpoint, Settings, Status,
    StreamFormat,
};

impl Table for DeviceTable {
    type Code = Code;
    const KIND: &'static str = "device";
    const MARKER: u32 = ABI_MARKER;
    const ABI_VERSION: &'static str = "htex_device_abi_version";

    unsafe fn of_symbols(symbols: &Symbols<'_>) -> Result<Self, DeviceError> {
        // SAFETY: each field's type is that of the function of its name, by the ABI.
        unsafe {
            Ok(Self {
                abi_version: symbols.get(Self::ABI_VERSION)?,
                descriptor: symbols.get("htex_device_descriptor")?,
                last_error: symbols.get("htex_device_last_error")?,
                endpoints: symbols.get("htex_device_endpoints")?,
                capabilities: symbols.get("htex_device_capabilities")?,
                open: symbols.get("htex_device_open")?,
                write: symbols.get("htex_device_write")?,
                status: symbols.get("htex_device_status")?,
                finish: symbols.get("htex_device_finish")?,
                close: symbols.get("htex_device_close")?,
                extension: symbols.get("htex_device_extension")?,
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

    fn incoming(code: Code, text: String, name: &str, library: &str) -> DeviceError {
        incoming(code, text, name, library)
    }
}

/// An adapter of a native library. Cheap to clone.
#[derive(Clone)]
pub struct NativeAdapter {
    descriptor: Arc<Descriptor>,
    library: Library<DeviceTable>,
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

    fn new(library: Library<DeviceTable>) -> Result<Self, DeviceError> {
        let descriptor = library.descriptor(Descriptor::check)?;
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
        self.library.has_extension(id)
    }

    /// As [`Adapter::capabilities`], of lines that need not be settings: for checkers of devices.
    ///
    /// # Errors
    /// As [`Adapter::capabilities`].
    pub fn capabilities_of(&self, lines: &str) -> Result<Capabilities, DeviceError> {
        let name = "capabilities";
        // SAFETY: a live text, and a buffer that is live and of this length, by `Library::text`.
        let call = |out, len| unsafe {
            (self.library.table.capabilities)(lines.as_ptr(), lines.len(), out, len)
        };
        let capabilities: Capabilities = self.library.json(&self.descriptor.name, name, call)?;
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

    fn error(&self, call: &str, trouble: Trouble<Code>) -> DeviceError {
        self.library.trouble(&self.descriptor.name, call, trouble)
    }
}

impl Adapter for NativeAdapter {
    fn descriptor(&self) -> &Descriptor {
        &self.descriptor
    }

    fn endpoints(&self) -> Result<Vec<Endpoint>, DeviceError> {
        self.library.endpoints(&self.descriptor.name)
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
        let (adapter, library) = (&self.adapter.descriptor.name, &self.adapter.library);
        library.done(adapter, call, answer)
    }

    /// The error of a write, with the details that only this side knows.
    fn write_error(&self, trouble: Trouble<Code>, samples: &[f32]) -> DeviceError {
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
        let (data, len) = (samples.as_ptr(), samples.len());
        // SAFETY: a live slice; `&mut self` keeps the handle to one thread at a time.
        let taken = unsafe { (self.table().write)(self.handle, data, len, wait_ms(timeout)) };
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
