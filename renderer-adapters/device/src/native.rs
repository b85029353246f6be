//! Adapters and devices of native libraries: safe calls of the C functions, checked results.

use std::time::Duration;

use htex_base::native::{Symbols, table_of_symbols};

use crate::abi::{ABI_MARKER, Code, DeviceTable, STATUS_NUMBERS};
use crate::crossing::{incoming, wait_ms};
use crate::library::{Common, Table, Trouble};
use crate::loaded::{Native, Opened};
use crate::{
    Adapter, Capabilities, Descriptor, DescriptorError, Device, DeviceError, DirectVoltage,
    Endpoint, Quantity, Settings, Status, StreamFormat,
};

impl Table for DeviceTable {
    type Code = Code;
    type About = Descriptor;
    const KIND: &'static str = "device";
    const MARKER: u32 = ABI_MARKER;
    const ABI_VERSION: &'static str = "htex_device_abi_version";

    unsafe fn of_symbols(symbols: &Symbols<'_, DeviceError>) -> Result<Self, DeviceError> {
        // SAFETY: each field's type is that of the function of its name, by the ABI.
        Ok(unsafe {
            table_of_symbols!(
                symbols, Self, "htex_device_",
                abi_version descriptor last_error endpoints capabilities
                open write status finish close extension
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

    fn check(about: &Descriptor) -> Result<(), DescriptorError> {
        about.check()
    }

    fn descriptor_of(about: &Descriptor) -> &Descriptor {
        about
    }

    fn code(answer: i64) -> Code {
        Code::from_answer(answer)
    }

    fn incoming(code: Code, text: String, name: &str, library: &str) -> DeviceError {
        incoming(code, text, name, library)
    }
}

/// A device adapter from a native library.
pub type NativeAdapter = Native<DeviceTable>;

impl NativeAdapter {
    /// For checkers: [`Adapter::capabilities`] with lines of settings, which may be invalid.
    ///
    /// # Errors
    /// The errors of [`Adapter::capabilities`].
    pub fn capabilities_of(&self, lines: &str) -> Result<Capabilities, DeviceError> {
        let name = "capabilities";
        // SAFETY: a live text, and a buffer that is live and of this length, by `Library::text`.
        let call = |out, len| unsafe {
            (self.library.table.capabilities)(lines.as_ptr(), lines.len(), out, len)
        };
        let capabilities: Capabilities = self.library.json(self.name(), name, call)?;
        let checked = capabilities.check();
        checked.map_err(|what| self.library.broken(format!("{name}: {what}")))?;
        Ok(capabilities)
    }

    /// Opens a device as [`Adapter::open`] does. The returned type has further functions for
    /// checkers.
    ///
    /// # Errors
    /// The errors of [`Adapter::open`].
    pub fn open_native(
        &self,
        settings: &Settings,
        format: &StreamFormat,
    ) -> Result<NativeDevice, DeviceError> {
        let capabilities = self.capabilities(settings)?;
        let lines = self.lines(settings);
        // The rates that a library states may be too low for its carrier.
        if format.rate_hz < capabilities.lowest_with_carrier_hz() {
            return Err(DeviceError::Rate {
                device: self.name().to_owned(),
                rate_hz: format.rate_hz,
                rates: capabilities.rates_text(),
            });
        }
        let is_display = capabilities.quantity == Quantity::DisplayVoltage && capabilities.paced;
        let direct = is_display.then(|| DirectVoltage::of(settings, format.rate_hz));
        let (rate_hz, block) = (format.rate_hz, format.block_frames);
        // SAFETY: a live text.
        let handle =
            unsafe { (self.library.table.open)(lines.as_ptr(), lines.len(), rate_hz, block) };
        let opened = self.opened(handle).map_err(|trouble| match trouble {
            Trouble::Told(Code::InvalidRate, _) => DeviceError::Rate {
                device: self.name().to_owned(),
                rate_hz,
                rates: capabilities.rates.to_string(),
            },
            trouble => self.error("open", trouble),
        })?;
        Ok(NativeDevice { opened, capabilities, direct, written: 0 })
    }
}

impl Adapter for NativeAdapter {
    fn descriptor(&self) -> &Descriptor {
        self.described()
    }

    fn endpoints(&self) -> Result<Vec<Endpoint>, DeviceError> {
        self.library.endpoints(self.name())
    }

    fn capabilities(&self, settings: &Settings) -> Result<Capabilities, DeviceError> {
        self.capabilities_of(&self.lines(settings))
    }

    fn open(
        &self,
        settings: &Settings,
        format: &StreamFormat,
    ) -> Result<Box<dyn Device>, DeviceError> {
        Ok(Box::new(self.open_native(settings, format)?))
    }
}

/// An open device of a native library. Dropping it closes it.
#[derive(Debug)]
pub struct NativeDevice {
    opened: Opened<DeviceTable>,
    capabilities: Capabilities,
    /// Present if the device is a paced display.
    direct: Option<DirectVoltage>,
    written: u64,
}

impl NativeDevice {
    /// Returns the status as [`Device::status`] does, but reports an invalid result as an error.
    ///
    /// # Errors
    /// When the device returns too few numbers, or one that is negative or not finite.
    pub fn checked_status(&self) -> Result<Status, DeviceError> {
        // NaN, so that a number that the device does not write is noticed.
        let mut numbers = [f64::NAN; STATUS_NUMBERS];
        let (adapter, handle) = (&self.opened.adapter, self.opened.handle);
        let status = self.opened.table().status;
        // SAFETY: a live buffer of this length.
        let count = unsafe { status(handle, numbers.as_mut_ptr(), numbers.len()) };
        let count =
            adapter.library.count(count).map_err(|trouble| adapter.error("status", trouble))?;
        let sane = |x: &f64| x.is_finite() && *x >= 0.0;
        if count < STATUS_NUMBERS || !numbers.iter().all(sane) {
            let what = format!("status: {count} numbers, {numbers:?}");
            return Err(adapter.library.broken(what));
        }
        Ok(numbers.into())
    }

    /// For checkers: closes the device and keeps its handle, so that later calls show whether the
    /// library refuses a closed handle. An app drops the device instead.
    ///
    /// # Errors
    /// The error of the device. A second call must return that the handle is unknown.
    pub fn close_and_keep_handle(&mut self) -> Result<(), DeviceError> {
        self.opened.close()
    }

    /// Closes the device if these samples would make a direct voltage. Its output is then at zero.
    fn check_direct(&mut self, samples: &[f32]) -> Result<(), DeviceError> {
        let Some(direct) = &self.direct else {
            return Ok(());
        };
        let Some(excess) = direct.excess(samples) else {
            return Ok(());
        };
        let error = match self.capabilities.check_samples(samples, self.written) {
            // A library may take what it must refuse, and would then hide later excesses.
            Err(not_a_number) if excess.mean_v.is_nan() => not_a_number,
            _ => DeviceError::DirectVoltage {
                frame: self.written + excess.at as u64,
                mean_v: excess.mean_v,
                limit_v: direct.limit_v(),
            },
        };
        // Closing is what takes the output of a library's device to zero.
        self.opened.close()?;
        Err(error)
    }

    /// Builds the error of a write, with details that only the host knows.
    fn write_error(&self, trouble: Trouble<Code>, samples: &[f32]) -> DeviceError {
        let adapter = &self.opened.adapter;
        match trouble {
            Trouble::Told(Code::OverLimit, text) => {
                let found = self.capabilities.check_samples(samples, self.written);
                let at_fault = || adapter.error("write", Trouble::Told(Code::OverLimit, text));
                found.err().unwrap_or_else(at_fault)
            }
            Trouble::Told(Code::Underflow, advice) => DeviceError::Underflow {
                device: adapter.name().to_owned(),
                frames: self.status().frames_played,
                advice,
            },
            trouble => adapter.error("write", trouble),
        }
    }
}

impl Device for NativeDevice {
    fn write(&mut self, samples: &[f32], timeout: Duration) -> Result<usize, DeviceError> {
        self.check_direct(samples)?;
        let (data, len) = (samples.as_ptr(), samples.len());
        let (library, handle) = (&self.opened.adapter.library, self.opened.handle);
        // SAFETY: a live slice; `&mut self` keeps the handle to one thread at a time.
        let taken = unsafe { (library.table.write)(handle, data, len, wait_ms(timeout)) };
        match library.count(taken) {
            Ok(taken) if taken <= len => {
                self.written += taken as u64;
                if let Some(direct) = &mut self.direct {
                    direct.take(&samples[..taken]);
                }
                Ok(taken)
            }
            Ok(taken) => {
                let what = format!("write: it took {taken} frames of {len}");
                Err(library.broken(what))
            }
            Err(trouble) => Err(self.write_error(trouble, samples)),
        }
    }

    fn status(&self) -> Status {
        // If the device returns no valid status, the host still knows how many frames it took.
        self.checked_status()
            .unwrap_or(Status { frames_written: self.written, ..Status::default() })
    }

    fn finish(&mut self) -> Result<(), DeviceError> {
        self.opened.done("finish", self.opened.table().finish)
    }
}
