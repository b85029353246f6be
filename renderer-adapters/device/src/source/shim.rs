//! From the traits of sources to the C functions: checks arguments and catches panics.
//!
//! Called by the functions that [`export_source!`](crate::export_source) makes; not by hand.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::OnceLock;
use std::time::Duration;

use crate::crossing::outgoing;
use crate::exported::{self, Refusal, answer, argument, bad_handle, copy_json};
use crate::handles::Handles;
use crate::source::abi::Code;
use crate::source::{Delivered, Source, SourceAdapter, SourceDescriptor, SourceStream};
use crate::{DeviceError, Settings};

pub use crate::exported::{Input, Output};

/// What messages call it.
const KIND: &str = "source";

/// The state of an exported adapter: itself and its open sources.
pub struct State<A> {
    adapter: OnceLock<A>,
    sources: Handles<dyn Source>,
}

impl<A: SourceAdapter + Default> Default for State<A> {
    fn default() -> Self {
        Self::new()
    }
}

impl<A: SourceAdapter + Default> State<A> {
    /// No adapter yet, nothing open.
    pub const fn new() -> Self {
        Self {
            adapter: OnceLock::new(),
            sources: Handles::new(),
        }
    }

    fn adapter(&self) -> &A {
        self.adapter.get_or_init(A::default)
    }

    fn settings(&self, lines: Input<'_, u8>) -> Result<Settings, Refusal> {
        exported::settings(self.adapter().descriptor(), lines)
    }

    fn with<R>(
        &self,
        handle: i64,
        call: impl FnOnce(&mut (dyn Source + 'static)) -> Result<R, Refusal>,
    ) -> Result<R, Refusal> {
        let called = self.sources.with(handle, call);
        called.ok_or_else(|| bad_handle(KIND))?
    }

    /// See [`crate::abi::DescriptorJson`].
    pub fn descriptor(&self, out: Output<'_, u8>) -> i64 {
        answer(KIND, || {
            let descriptor = SourceDescriptor {
                descriptor: self.adapter().descriptor().clone(),
                target: self.adapter().target().to_owned(),
            };
            copy_json(&descriptor, out)
        })
    }

    /// See [`crate::abi::EndpointsJson`].
    pub fn endpoints(&self, out: Output<'_, u8>) -> i64 {
        answer(KIND, || {
            copy_json(&self.adapter().endpoints().map_err(refused)?, out)
        })
    }

    /// See [`crate::source::abi::OpenFn`].
    pub fn open(&self, settings: Input<'_, u8>) -> i64 {
        answer(KIND, || {
            let settings = self.settings(settings)?;
            let source = self.adapter().open(&settings).map_err(refused)?;
            Ok(self.sources.insert(source))
        })
    }

    /// See [`crate::source::abi::StreamJson`].
    pub fn stream(&self, handle: i64, out: Output<'_, u8>) -> i64 {
        answer(KIND, || {
            let stream = self.with(handle, |source| {
                Ok(SourceStream {
                    rate_hz: source.rate_hz(),
                    channels: source.channels().to_vec(),
                })
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
        let answered = answer(KIND, || {
            let samples = out.get("samples")?;
            let timeout = Duration::from_millis(u64::from(timeout_ms));
            let delivered = self.with(handle, |source| {
                let channels = source.channels().len();
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
        });
        self.close_if_panicked(handle, answered)
    }

    /// See [`crate::source::abi::StopFn`]. A panic closes the source.
    pub fn stop(&self, handle: i64) -> i64 {
        self.done(handle, |source| source.stop())
    }

    /// See [`crate::source::abi::CloseFn`].
    pub fn close(&self, handle: i64) -> i64 {
        answer(KIND, || {
            let closed = self.sources.remove(handle).map(|_| 0);
            closed.ok_or_else(|| bad_handle(KIND))
        })
    }

    fn done(
        &self,
        handle: i64,
        call: impl FnOnce(&mut (dyn Source + 'static)) -> Result<(), DeviceError>,
    ) -> i64 {
        let call = |source: &mut (dyn Source + 'static)| call(source).map_err(refused);
        let answered = answer(KIND, || self.with(handle, call).map(|()| 0));
        self.close_if_panicked(handle, answered)
    }

    /// Drops the source, which stops it, and returns the result with its text.
    fn close_if_panicked(&self, handle: i64, answered: i64) -> i64 {
        if answered == Code::Panicked as i64 {
            // A second panic, in the drop, adds nothing.
            let _ = catch_unwind(AssertUnwindSafe(|| drop(self.sources.remove(handle))));
        }
        answered
    }
}

/// The code and the text of a source's error.
fn refused(error: DeviceError) -> Refusal {
    let failed = |text: String| Refusal(Code::Failed as i64, text);
    match error {
        DeviceError::Overrun { advice, .. } => Refusal(Code::Overrun as i64, advice),
        // Their numbers mean something else here.
        DeviceError::OverLimit { .. } | DeviceError::Underflow { .. } => failed(error.to_string()),
        other => {
            let (code, text) = outgoing(&other);
            Refusal(code as i64, text)
        }
    }
}
