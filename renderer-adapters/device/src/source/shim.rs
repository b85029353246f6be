//! Implements the C functions by the source traits: checks arguments and catches panics.
//!
//! The functions that [`export_source!`](crate::export_source) generates call it. Do not call it by
//! hand.

use std::time::Duration;

use crate::crossing::outgoing;
use crate::exported::{self, Exported, Refusal, argument, copy_json};
use crate::source::abi::Code;
use crate::source::{Delivered, Source, SourceAdapter, SourceDescriptor, SourceStream};
use crate::{DeviceError, Settings};

pub use crate::exported::{Input, Output};

/// The state of an exported adapter: the adapter itself and its open sources.
pub struct State<A>(Exported<A, dyn Source>);

impl<A: SourceAdapter + Default> Default for State<A> {
    fn default() -> Self {
        Self::new()
    }
}

impl<A: SourceAdapter + Default> State<A> {
    /// Creates a state without an adapter and with nothing open.
    pub const fn new() -> Self {
        Self(Exported::new("source"))
    }

    fn adapter(&self) -> &A {
        self.0.adapter()
    }

    fn settings(&self, lines: Input<'_, u8>) -> Result<Settings, Refusal> {
        exported::settings(self.adapter().descriptor(), lines)
    }

    /// See [`crate::abi::DescriptorJson`].
    pub fn descriptor(&self, out: Output<'_, u8>) -> i64 {
        self.0.answer(|| {
            let descriptor = SourceDescriptor {
                descriptor: self.adapter().descriptor().clone(),
                target: self.adapter().target().to_owned(),
            };
            copy_json(&descriptor, out)
        })
    }

    /// See [`crate::abi::EndpointsJson`].
    pub fn endpoints(&self, out: Output<'_, u8>) -> i64 {
        self.0.answer(|| copy_json(&self.adapter().endpoints().map_err(refused)?, out))
    }

    /// See [`crate::source::abi::OpenFn`].
    pub fn open(&self, settings: Input<'_, u8>) -> i64 {
        self.0.answer(|| {
            let settings = self.settings(settings)?;
            let source = self.adapter().open(&settings).map_err(refused)?;
            Ok(self.0.insert(source))
        })
    }

    /// See [`crate::source::abi::StreamJson`].
    pub fn stream(&self, handle: i64, out: Output<'_, u8>) -> i64 {
        self.0.answer(|| {
            let stream = self.0.with(handle, |source| {
                Ok(SourceStream { rate_hz: source.rate_hz(), channels: source.channels().to_vec() })
            })?;
            copy_json(&stream, out)
        })
    }

    /// See [`crate::source::abi::StartFn`]. A panic closes the source.
    pub fn start(&self, handle: i64) -> i64 {
        self.done(handle, |source| source.start())
    }

    /// See [`crate::source::abi::ReadFn`]. A panic closes the source.
    pub fn read(&self, handle: i64, out: Output<'_, f64>, timeout_ms: u32) -> i64 {
        self.0.answer_of(handle, || {
            let samples = out.get("samples")?;
            let timeout = Duration::from_millis(u64::from(timeout_ms));
            let delivered = self.0.with(handle, |source| {
                let channels = source.channels().len();
                // `checked_rem` also covers a faulty source without channels.
                if samples.len().checked_rem(channels) != Some(0) {
                    let len = samples.len();
                    return Err(argument(format!("{len} samples of {channels} channels")));
                }
                source.read(samples, timeout).map_err(refused)
            })?;
            match delivered {
                Delivered::Frames(frames) => Ok(frames as i64),
                Delivered::End => Err(Refusal(Code::End as i64, "the source has ended".to_owned())),
            }
        })
    }

    /// See [`crate::source::abi::StopFn`]. A panic closes the source.
    pub fn stop(&self, handle: i64) -> i64 {
        self.done(handle, |source| source.stop())
    }

    /// See [`crate::source::abi::CloseFn`].
    pub fn close(&self, handle: i64) -> i64 {
        self.0.close(handle)
    }

    fn done(
        &self,
        handle: i64,
        call: impl FnOnce(&mut (dyn Source + 'static)) -> Result<(), DeviceError>,
    ) -> i64 {
        let call = |source: &mut (dyn Source + 'static)| call(source).map_err(refused);
        self.0.answer_of(handle, || self.0.with(handle, call).map(|()| 0))
    }
}

/// Converts a source's error to its code and text.
fn refused(error: DeviceError) -> Refusal {
    let failed = |text: String| Refusal(Code::Failed as i64, text);
    match error {
        DeviceError::Overrun { advice, .. } => Refusal(Code::Overrun as i64, advice),
        // In the source ABI, the numbers of these device codes mean something else.
        DeviceError::OverLimit { .. } | DeviceError::Underflow { .. } => failed(error.to_string()),
        other => {
            let (code, text) = outgoing(&other);
            Refusal(code as i64, text)
        }
    }
}
