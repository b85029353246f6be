//! A device that is a file: the mechanical quantity at the finger, or the drive of a display, as
//! WAV, CSV, NPY or raw samples.
//!
//! Samples are written as fast as they are made, through a buffer of fixed size, into a temporary
//! file beside the named one, which is renamed when the device is finished. A device that is
//! dropped before leaves no file.
//!
//! A WAV file is limited to 4 GiB, with an error: few programs read RF64.
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod describe;
mod device;
mod encoding;
mod plan;
mod sink;

use htex_device::{Adapter, Capabilities, Descriptor, Device, DeviceError, Endpoint};
use htex_device::{Settings, StreamFormat};

use device::FileDevice;
use plan::Plan;

htex_device::export_device!(FileAdapter, symbols: "plugin");

/// The adapter `org.htex.file`.
#[derive(Debug, Clone, Copy, Default)]
pub struct FileAdapter;

impl Adapter for FileAdapter {
    fn descriptor(&self) -> &Descriptor {
        &describe::DESCRIPTOR
    }

    fn endpoints(&self) -> Result<Vec<Endpoint>, DeviceError> {
        Ok(Vec::new())
    }

    fn capabilities(&self, settings: &Settings) -> Result<Capabilities, DeviceError> {
        Ok(Plan::new(settings)?.capabilities())
    }

    fn open(
        &self,
        settings: &Settings,
        format: &StreamFormat,
    ) -> Result<Box<dyn Device>, DeviceError> {
        let device = FileDevice::create(&Plan::new(settings)?, format.rate_hz)?;
        Ok(Box::new(device))
    }
}

/// Opens a WAV file of sound, of 32-bit floats, with a channel for each factor: what the channel
/// plays of each sample.
///
/// # Errors
/// When the rate is none of a WAV file, or the file cannot be made.
pub fn open_channels(
    path: std::path::PathBuf,
    factors: &[f32],
    rate_hz: f64,
) -> Result<Box<dyn Device>, DeviceError> {
    let plan = Plan::channels(path, factors.to_vec());
    Ok(Box::new(FileDevice::create(&plan, rate_hz)?))
}
