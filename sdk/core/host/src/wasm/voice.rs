//! A voice in a separate instance. After a trap, the host does not call this instance again.
//!
//! Each voice has a buffer in the module's memory, which is allocated once. The host copies
//! arguments into this buffer and, in each call, copies the rendered samples out of it.

use std::sync::Arc;

use htex_model::shim::copy;
use htex_model::{Band, Motion};

use super::calls::BLOCK;
use super::fault::Fault;
use super::instance::Instance;
use super::module::WasmModule;
use super::shared::VoicePlace;
use crate::raw::RawVoice;

/// A voice with its instance.
pub(super) struct WasmVoice {
    instance: Instance,
    handle: i64,
    last_error: String,
    /// Whether the instance trapped. After a trap, the host does not call the instance again.
    faulted: bool,
    _place: VoicePlace,
}

impl WasmVoice {
    /// Creates a voice. The error is a status code and its text.
    pub(super) fn new(
        module: &Arc<WasmModule>,
        place: VoicePlace,
        (parameters, band): (&[f64], Band),
        rate_hz: f64,
        seed: u64,
    ) -> Result<Self, (i64, String)> {
        let fault = |fault: Fault| (Fault::STATUS, fault.to_string());
        let mut instance = Instance::new(module).map_err(fault)?;
        let handle = instance.voice_new(parameters, band, rate_hz, seed).map_err(fault)?;
        if handle < 0 {
            return Err((handle, instance.last_error().map_err(fault)?));
        }
        if handle == 0 {
            return Err(fault(Fault::HandleZero));
        }
        // The limit is set only now, so that the time for creating the voice counts towards the
        // budget of all modules.
        instance.limit_as_voice(rate_hz);
        Ok(Self { instance, handle, last_error: String::new(), faulted: false, _place: place })
    }

    /// Converts a result to a status, and stores the text of an error.
    fn status_of(&mut self, result: Result<i64, Fault>) -> i64 {
        let result = result.and_then(|status| {
            if status < 0 {
                self.last_error = self.instance.last_error()?;
            }
            Ok(status)
        });
        result.unwrap_or_else(|fault| {
            self.faulted = true;
            self.last_error = fault.to_string();
            Fault::STATUS
        })
    }
}

impl RawVoice for WasmVoice {
    fn render(&mut self, out: &mut [f32]) -> i64 {
        for block in out.chunks_mut(BLOCK) {
            if self.faulted {
                return Fault::STATUS;
            }
            let result = self.instance.voice_render(self.handle, block);
            let status = self.status_of(result);
            if status != 0 {
                return status;
            }
            // Time is added only after success, so that a call that fails adds no time.
            self.instance.earn(block.len());
        }
        0
    }

    fn retune(&mut self, parameters: &[f64]) -> i64 {
        if self.faulted {
            return Fault::STATUS;
        }
        let result = self.instance.voice_retune(self.handle, parameters);
        self.status_of(result)
    }

    fn set_motion(&mut self, motion: Motion) -> i64 {
        if self.faulted {
            return Fault::STATUS;
        }
        let result = self.instance.motion_set(self.handle, motion);
        self.status_of(result)
    }

    fn interpolate(&mut self, sets: &[f64], weights: &[f64], parameters: &mut [f64]) -> i64 {
        if self.faulted {
            return Fault::STATUS;
        }
        let result = self.instance.interpolate(sets, weights, parameters);
        self.status_of(result)
    }

    fn free(&mut self) -> i64 {
        if self.faulted {
            return Fault::STATUS;
        }
        let result = self.instance.voice_free(self.handle);
        self.status_of(result)
    }

    fn memory_bytes(&self) -> Option<usize> {
        Some(self.instance.memory_bytes())
    }

    fn last_error(&self, out: &mut [u8]) -> i64 {
        copy(self.last_error.as_bytes(), out)
    }
}
