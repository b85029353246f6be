//! Implements the C functions by the device traits: checks arguments and catches panics.
//!
//! The functions that [`export_device!`](crate::export_device) generates call it. Do not call it by
//! hand.

use std::time::Duration;

use crate::abi::{Code, MAX_BLOCK_FRAMES, MAX_RATE_HZ, MIN_RATE_HZ, STATUS_NUMBERS};
use crate::exported::{self, Exported, Refusal, argument, copy_json};
use crate::{Adapter, Device, DeviceError, Settings, StreamFormat};

pub use crate::exported::{Input, Output, extension, last_error};

/// The state of an exported adapter: the adapter itself and its open devices.
pub struct State<A>(Exported<A, dyn Device>);

impl<A: Adapter + Default> Default for State<A> {
    fn default() -> Self {
        Self::new()
    }
}

impl<A: Adapter + Default> State<A> {
    /// Creates a state without an adapter and with nothing open.
    pub const fn new() -> Self {
        Self(Exported::new("device"))
    }

    fn adapter(&self) -> &A {
        self.0.adapter()
    }

    fn settings(&self, lines: Input<'_, u8>) -> Result<Settings, Refusal> {
        exported::settings(self.adapter().descriptor(), lines)
    }

    fn with<R>(
        &self,
        handle: i64,
        call: impl FnOnce(&mut (dyn Device + 'static)) -> Result<R, DeviceError>,
    ) -> Result<R, Refusal> {
        self.0.with(handle, |device| Ok(call(device)?))
    }

    /// See [`crate::abi::DescriptorJson`].
    pub fn descriptor(&self, out: Output<'_, u8>) -> i64 {
        self.0.answer(|| copy_json(self.adapter().descriptor(), out))
    }

    /// See [`crate::abi::EndpointsJson`].
    pub fn endpoints(&self, out: Output<'_, u8>) -> i64 {
        self.0.answer(|| copy_json(&self.adapter().endpoints()?, out))
    }

    /// See [`crate::abi::CapabilitiesJson`].
    pub fn capabilities(&self, settings: Input<'_, u8>, out: Output<'_, u8>) -> i64 {
        self.0.answer(|| {
            let settings = self.settings(settings)?;
            copy_json(&self.adapter().capabilities(&settings)?, out)
        })
    }

    /// See [`crate::abi::OpenFn`].
    pub fn open(&self, settings: Input<'_, u8>, rate_hz: f64, block_frames: u32) -> i64 {
        self.0.answer(|| {
            let settings = self.settings(settings)?;
            if !(MIN_RATE_HZ..=MAX_RATE_HZ).contains(&rate_hz) {
                let range = format!("{MIN_RATE_HZ} to {MAX_RATE_HZ} Hz");
                let text = format!("a rate of {rate_hz} Hz; {range} is allowed");
                return Err(Refusal(Code::InvalidRate as i64, text));
            }
            if !(1..=MAX_BLOCK_FRAMES).contains(&block_frames) {
                let text = format!("blocks of {block_frames}; 1 to {MAX_BLOCK_FRAMES} are allowed");
                return Err(argument(text));
            }
            let format = StreamFormat { rate_hz, block_frames };
            let device = self.adapter().open(&settings, &format)?;
            Ok(self.0.insert(device))
        })
    }

    /// See [`crate::abi::WriteFn`]. A panic closes the device.
    pub fn write(&self, handle: i64, samples: Input<'_, f32>, timeout_ms: u32) -> i64 {
        self.0.answer_of(handle, || {
            let samples = samples.get("samples")?;
            let timeout = Duration::from_millis(u64::from(timeout_ms));
            let taken = self.with(handle, |device| device.write(samples, timeout))?;
            Ok(taken as i64)
        })
    }

    /// See [`crate::abi::StatusFn`].
    pub fn status(&self, handle: i64, out: Output<'_, f64>) -> i64 {
        self.0.answer(|| {
            let out = out.get("out")?;
            let status = self.with(handle, |device| Ok(device.status()))?;
            let numbers: [f64; STATUS_NUMBERS] = status.into();
            for (to, number) in out.iter_mut().zip(numbers) {
                *to = number;
            }
            Ok(STATUS_NUMBERS as i64)
        })
    }

    /// See [`crate::abi::FinishFn`]. A panic closes the device.
    pub fn finish(&self, handle: i64) -> i64 {
        let finish = || self.with(handle, |device| device.finish()).map(|()| 0);
        self.0.answer_of(handle, finish)
    }

    /// See [`crate::abi::CloseFn`].
    pub fn close(&self, handle: i64) -> i64 {
        self.0.close(handle)
    }
}
