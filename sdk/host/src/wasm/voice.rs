//! A voice in an instance of its own.

use std::sync::Arc;

use htex_model::{Band, Motion};

use super::calls::BLOCK;
use super::fault::Fault;
use super::instance::Instance;
use super::module::{Place, WasmModule};
use crate::raw::RawVoice;

/// A voice, alone in its instance; both are gone when it is dropped.
pub(super) struct WasmVoice {
    instance: Instance,
    handle: i64,
    /// What stands behind the last negative answer.
    last_error: String,
    /// The instance trapped: it is not called again.
    faulted: bool,
    _place: Place,
}

impl WasmVoice {
    /// Makes a voice; or answers why not, with the status.
    pub(super) fn new(
        module: &Arc<WasmModule>,
        place: Place,
        (parameters, band): (&[f64], Band),
        rate_hz: f64,
        seed: u64,
    ) -> Result<Self, (i64, String)> {
        let fault = |fault: Fault| (Fault::STATUS, fault.0);
        let mut instance = Instance::new(module).map_err(fault)?;
        let handle = instance.voice_new(parameters, band, rate_hz, seed);
        let handle = handle.map_err(fault)?;
        if handle < 0 {
            return Err((handle, instance.last_error().map_err(fault)?));
        }
        if handle == 0 {
            return Err(fault(Fault("it answered the handle 0".to_owned())));
        }
        instance.be_a_voice(rate_hz);
        Ok(Self {
            instance,
            handle,
            last_error: String::new(),
            faulted: false,
            _place: place,
        })
    }

    /// Keeps what stands behind a negative answer.
    fn answer(&mut self, result: Result<i64, Fault>) -> i64 {
        let result = result.and_then(|answer| {
            if answer < 0 {
                self.last_error = self.instance.last_error()?;
            }
            Ok(answer)
        });
        result.unwrap_or_else(|fault| {
            self.faulted = true;
            self.last_error = fault.0;
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
            let answer = self.answer(result);
            if answer < 0 {
                return answer;
            }
            self.instance.earn(block.len());
        }
        0
    }

    fn retune(&mut self, parameters: &[f64]) -> i64 {
        if self.faulted {
            return Fault::STATUS;
        }
        let result = self.instance.voice_retune(self.handle, parameters);
        self.answer(result)
    }

    fn set_motion(&mut self, motion: Motion) -> i64 {
        if self.faulted {
            return Fault::STATUS;
        }
        let result = self.instance.motion_set(self.handle, motion);
        self.answer(result)
    }

    fn interpolate(&mut self, sets: &[f64], weights: &[f64], parameters: &mut [f64]) -> i64 {
        if self.faulted {
            return Fault::STATUS;
        }
        let result = self.instance.interpolate(sets, weights, parameters);
        self.answer(result)
    }

    fn free(&mut self) -> i64 {
        if self.faulted {
            return Fault::STATUS;
        }
        let result = self.instance.voice_free(self.handle);
        self.answer(result)
    }

    fn memory_bytes(&self) -> Option<usize> {
        Some(self.instance.memory_bytes())
    }

    fn last_error(&self, out: &mut [u8]) -> i64 {
        copy_text(&self.last_error, out)
    }
}

/// Copies what fits; answers the whole length.
pub(super) fn copy_text(text: &str, out: &mut [u8]) -> i64 {
    let n = text.len().min(out.len());
    out[..n].copy_from_slice(&text.as_bytes()[..n]);
    text.len() as i64
}
