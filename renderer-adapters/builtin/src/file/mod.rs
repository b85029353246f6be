//! A device that writes a file. The samples are the mechanical quantity at the finger or the drive
//! signal of a display. The format is WAV, CSV, NPY or raw samples.
//!
//! The device writes samples as fast as they are generated. The samples go through a buffer of
//! fixed size into a temporary file next to the final file. Finishing the output renames the
//! temporary file. An output that is dropped before it is finished leaves no file.
//!
//! A WAV file larger than 4 GiB is an error. The RF64 format allows larger files, but few programs
//! read RF64.
#![allow(unsafe_code, reason = "the C functions of the device ABI")]
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod describe;
mod device;
mod encoding;
mod plan;
mod sink;

use htex_device::{
    Adapter, Capabilities, Descriptor, DeviceError, Endpoint, Output, Settings, StreamFormat,
};

use device::FileDevice;
use plan::Plan;

htex_device::export_device!(FileAdapter, symbols: "plugin");

/// The file adapter, `org.htex.file`.
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

    fn open_output(
        &self,
        settings: &Settings,
        format: &StreamFormat,
    ) -> Result<Box<dyn Output>, DeviceError> {
        let device = FileDevice::create(&Plan::new(settings)?, format.rate_hz)?;
        Ok(Box::new(device))
    }
}

/// Creates a WAV sound file with samples that are 32-bit floats. The file has one channel for each
/// factor in `factors`. A channel contains the samples multiplied by the channel's factor.
///
/// # Errors
/// Returns an error if a WAV file cannot have this rate, or the file cannot be created.
pub fn open_channels(
    path: std::path::PathBuf,
    factors: &[f32],
    rate_hz: f64,
) -> Result<Box<dyn Output>, DeviceError> {
    let plan = Plan::channels(path, factors.to_vec());
    Ok(Box::new(FileDevice::create(&plan, rate_hz)?))
}
