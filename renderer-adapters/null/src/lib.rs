//! A device that discards its samples: it measures what a scene costs, without a file or a card.

use std::sync::LazyLock;
use std::time::Duration;

use htex_device::{
    Adapter, Capabilities, Descriptor, Device, DeviceError, Endpoint, Quantity, Rates, Settings,
    Status, StreamFormat,
};

htex_device::export_device!(NullAdapter, symbols: "plugin");

/// Lowest and highest rate, hertz.
const RATES_HZ: (f64, f64) = (100.0, 1_000_000.0);

static DESCRIPTOR: LazyLock<Descriptor> = LazyLock::new(|| Descriptor {
    id: "org.htex.null".to_owned(),
    name: "Null".to_owned(),
    version: "1.0.0".to_owned(),
    summary: "Discards the samples, as fast as they are made.".to_owned(),
    settings: Vec::new(),
    profiles: Vec::new(),
});

/// The adapter `org.htex.null`.
#[derive(Debug, Clone, Copy, Default)]
pub struct NullAdapter;

impl Adapter for NullAdapter {
    fn descriptor(&self) -> &Descriptor {
        &DESCRIPTOR
    }

    fn endpoints(&self) -> Result<Vec<Endpoint>, DeviceError> {
        Ok(Vec::new())
    }

    fn capabilities(&self, _: &Settings) -> Result<Capabilities, DeviceError> {
        Ok(Capabilities {
            quantity: Quantity::LateralForce,
            rates: Rates::Range {
                min_hz: RATES_HZ.0,
                max_hz: RATES_HZ.1,
            },
            default_rate_hz: 20_000.0,
            limit: None,
            step: None,
            carrier_hz: None,
            paced: false,
            block_frames: 4_096,
        })
    }

    fn open(
        &self,
        settings: &Settings,
        format: &StreamFormat,
    ) -> Result<Box<dyn Device>, DeviceError> {
        let capabilities = self.capabilities(settings)?;
        if !capabilities.rates.has(format.rate_hz) {
            return Err(DeviceError::Rate {
                device: DESCRIPTOR.name.clone(),
                rate_hz: format.rate_hz,
                rates: format!("{} to {} Hz", RATES_HZ.0, RATES_HZ.1),
            });
        }
        Ok(Box::new(Null {
            capabilities,
            is_open: true,
            frames: 0,
            peak: 0.0,
        }))
    }
}

/// The open device.
struct Null {
    capabilities: Capabilities,
    is_open: bool,
    frames: u64,
    peak: f32,
}

impl Null {
    fn check_open(&self) -> Result<(), DeviceError> {
        match self.is_open {
            true => Ok(()),
            false => Err(DeviceError::Closed(DESCRIPTOR.name.clone())),
        }
    }
}

impl Device for Null {
    fn write(&mut self, samples: &[f32], _timeout: Duration) -> Result<usize, DeviceError> {
        self.check_open()?;
        let checked = self.capabilities.check_samples(samples, self.frames);
        checked.inspect_err(|_| self.is_open = false)?;
        self.frames += samples.len() as u64;
        let magnitudes = samples.iter().map(|sample| sample.abs());
        self.peak = magnitudes.fold(self.peak, f32::max);
        Ok(samples.len())
    }

    fn status(&self) -> Status {
        Status {
            frames_written: self.frames,
            frames_played: self.frames,
            peak: f64::from(self.peak),
            ..Status::default()
        }
    }

    fn finish(&mut self) -> Result<(), DeviceError> {
        self.check_open()?;
        self.is_open = false;
        Ok(())
    }
}
