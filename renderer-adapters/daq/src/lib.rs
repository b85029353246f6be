//! The analog output of a National Instruments card, and the amplifier behind it: electrovibration;
//! and its analog inputs.
//!
//! Samples are volts *at the display*, the carrier included; this adapter divides by the
//! amplifier's gain and streams through NI-DAQmx, which is loaded at run time and not linked.
//!
//! The voltage is limited by:
//! - a sample beyond `limit_v` is never output, and the driver's own channel limits are set to the
//!   same;
//! - the output goes to zero before a stream, after it, on every error, and when the device is
//!   dropped; a thread of the device detects an empty buffer even if no more samples are
//!   written, and sets the output to zero if a call of the driver does not return for 0.3 s;
//! - a mean over 100 ms beyond `dc_limit_v` is never output, whatever produced it;
//! - a stream that does not begin or end at zero gets a ramp of `ramp_ms` *before its first and
//!   after its last* sample: the mirror image of what is there, under a falling weight, so that a
//!   carrier stays one. Samples themselves are never changed;
//! - buffer and ramp together have at most 400 ms.
//!
//! [`DaqInput`] is the reverse: the analog inputs of a card as a source, in volts.
#![deny(unsafe_code)]

mod claim;
mod descriptor;
mod driver;
mod fault;
mod input;
mod input_stream;
mod inputs;
mod rig;
mod session;
mod stream;
mod watchdog;
mod zero;

use htex_device::{
    Adapter, Capabilities, Descriptor, Device, DeviceError, Endpoint, Settings, StreamFormat,
};

pub use input::DaqInput;

use driver::Driver;
use rig::Rig;

/// The adapter; see the crate's documentation.
pub struct Daq {
    descriptor: Descriptor,
}

impl Daq {
    /// The adapter. The driver is loaded at the first use.
    pub fn new() -> Self {
        Self { descriptor: descriptor::descriptor() }
    }
}

impl Default for Daq {
    fn default() -> Self {
        Self::new()
    }
}

impl Adapter for Daq {
    fn descriptor(&self) -> &Descriptor {
        &self.descriptor
    }

    /// The analog outputs of all cards that the installed driver knows.
    fn endpoints(&self) -> Result<Vec<Endpoint>, DeviceError> {
        let driver = Driver::load("")?;
        let outputs = driver.outputs().map_err(|f| f.failed("NI-DAQmx"))?;
        let endpoint = |(name, product)| Endpoint {
            name,
            setting: "device".to_owned(),
            summary: format!("analog output of NI {product}"),
        };
        Ok(outputs.into_iter().map(endpoint).collect())
    }

    fn capabilities(&self, settings: &Settings) -> Result<Capabilities, DeviceError> {
        let rig = Rig::new(settings)?;
        rig.capabilities(Driver::load(&rig.driver)?)
    }

    fn open(
        &self,
        settings: &Settings,
        format: &StreamFormat,
    ) -> Result<Box<dyn Device>, DeviceError> {
        let rig = Rig::new(settings)?;
        let driver = Driver::load(&rig.driver)?;
        let able = rig.capabilities(driver)?;
        if !able.has_rate(format.rate_hz) {
            return Err(DeviceError::Rate {
                device: rig.device,
                rate_hz: format.rate_hz,
                rates: able.rates_text(),
            });
        }
        Ok(Box::new(stream::Stream::open(rig, driver, format)?))
    }
}
