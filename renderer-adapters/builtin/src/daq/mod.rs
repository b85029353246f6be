//! National Instruments cards. An analog output drives an electrovibration display through an
//! amplifier, and analog inputs record signals.
//!
//! The samples of an output are volts *at the display*, including the carrier. The adapter divides
//! these samples by the amplifier's gain and streams them through NI-DAQmx. The NI-DAQmx library is
//! not linked, but loaded at run time.
//!
//! The voltage is limited in these ways:
//! - A sample beyond `limit_v` is never output. The driver's own limits of the output channel are
//!   set to the same voltage, divided by the amplifier's gain.
//! - The output goes to zero before and after a stream, on every error, and when the device is
//!   dropped. A thread of the device, the watchdog, detects an empty buffer even if the program has
//!   stopped writing samples. The watchdog also sets the output to zero if a call to the driver
//!   takes longer than 0.3 s.
//! - Samples whose mean over 100 ms would exceed `dc_limit_v` are never output.
//! - If a stream does not begin at zero, the adapter outputs a ramp of `ramp_ms` *before* the first
//!   sample of the stream. If the stream does not end at zero, the adapter outputs such a ramp
//!   *after* the last sample. The ramp consists of the samples next to it in the stream, mirrored
//!   in time and multiplied by a weight. The weight falls to zero with the distance from the
//!   stream. Because the ramp is made from the stream, it keeps the frequency of the carrier. The
//!   samples of the stream are never changed.
//! - Buffer and ramp together last at most 400 ms.
//!
//! [`DaqInput`] records the analog inputs of a card, in volts.
#![deny(unsafe_code)]

mod descriptor;
mod driver;
mod fault;
mod input;
mod inputs;
mod rig;
mod sampler;
mod session;
mod stream;
mod watchdog;
mod zero;

use std::sync::LazyLock;

use htex_device::{
    Adapter, Capabilities, Descriptor, DeviceError, Endpoint, Output, Settings, StreamFormat,
};

pub use input::DaqInput;

use driver::Driver;
use rig::Rig;

/// The analog output adapter. See the crate's documentation.
#[derive(Debug, Clone, Copy, Default)]
pub struct Daq;

static DESCRIPTOR: LazyLock<Descriptor> = LazyLock::new(descriptor::descriptor);

impl Adapter for Daq {
    fn descriptor(&self) -> &Descriptor {
        &DESCRIPTOR
    }

    /// Lists the analog outputs of all cards that the installed driver knows.
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

    fn open_output(
        &self,
        settings: &Settings,
        format: &StreamFormat,
    ) -> Result<Box<dyn Output>, DeviceError> {
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
