//! A model in a WASM module: all calls to the model, except the calls to its voices.

use std::cell::RefCell;
use std::sync::{Arc, Mutex, PoisonError};

use htex_model::motion_1::MotionTable;
use htex_model::shim::copy;
use htex_model::{Band, FitInput, Status};

use super::calls::BLOCK;
use super::fault::Fault;
use super::instance::Instance;
use super::module::WasmModule;
use super::voice::WasmVoice;
use crate::HostError;
use crate::raw::{RawModel, RawVoice, check_marker};

std::thread_local! {
    /// The text of this thread's last error. A native model also stores it for each thread.
    static LAST_ERROR: RefCell<String> = const { RefCell::new(String::new()) };
}

/// A model in a module.
pub(crate) struct WasmModel {
    module: Arc<WasmModule>,
    marker: u32,
    /// The instance for all calls except the calls of voices; `None` after a trap.
    shared: Mutex<Option<Instance>>,
}

impl WasmModel {
    /// Creates the first instance and checks the marker.
    pub(super) fn new(origin: &str, module: Arc<WasmModule>) -> Result<Self, HostError> {
        let mut instance = first(&module, origin)?;
        let marker = instance.abi_version().map_err(|fault| HostError::Call {
            model: origin.to_owned(),
            call: "htex_model_abi_version",
            status: Status::Failed,
            message: fault.to_string(),
        })?;
        check_marker(origin, marker)?;
        // If the call fails, the module counts as a module without the extension. A failed instance
        // is not used again.
        let shared = match instance.extension(MotionTable::ID.as_bytes()) {
            Ok(1) => {
                // The first instance does not include the functions of the extension, so it is
                // replaced.
                module.shared.require_motion();
                Some(first(&module, origin)?)
            }
            Ok(_) => Some(instance),
            Err(_) => None,
        };
        Ok(Self { module, marker, shared: Mutex::new(shared) })
    }

    /// Calls the shared instance. If the call fails, `failed` converts the status to the result.
    fn call<T: Copy>(
        &self,
        failed: impl Fn(i64) -> T,
        is_negative: impl Fn(T) -> bool,
        call: impl FnOnce(&mut Instance) -> Result<T, Fault>,
    ) -> T {
        let mut shared = self.shared.lock().unwrap_or_else(PoisonError::into_inner);
        // The instance is taken out, so that a fault drops it.
        let result = shared.take().map_or_else(|| Instance::new(&self.module), Ok).and_then(
            |mut instance| {
                let returned = call(&mut instance)?;
                if is_negative(returned) {
                    remember(instance.last_error()?);
                }
                *shared = Some(instance);
                Ok(returned)
            },
        );
        result.unwrap_or_else(|fault| {
            remember(fault.to_string());
            failed(Fault::STATUS)
        })
    }

    fn status(&self, call: impl FnOnce(&mut Instance) -> Result<i64, Fault>) -> i64 {
        self.call(|status| status, |returned| returned < 0, call)
    }
}

/// Creates the first instance of a module. The module may lack a function.
fn first(module: &Arc<WasmModule>, origin: &str) -> Result<Instance, HostError> {
    match Instance::new(module) {
        Err(Fault::NoFunction { name }) => {
            Err(HostError::NoFunction { path: origin.to_owned(), name })
        }
        other => other.map_err(HostError::loading(origin)),
    }
}

fn remember(text: String) {
    LAST_ERROR.with(|last| *last.borrow_mut() = text);
}

impl RawModel for WasmModel {
    fn abi_version(&self) -> u32 {
        self.marker
    }

    fn descriptor(&self, out: &mut [u8]) -> i64 {
        self.status(|instance| instance.descriptor(out))
    }

    fn last_error(&self, out: &mut [u8]) -> i64 {
        LAST_ERROR.with(|last| copy(last.borrow().as_bytes(), out))
    }

    fn fit(&self, input: &FitInput<'_>, parameters: &mut [f64], level_rms: &mut f64) -> i64 {
        self.status(|instance| instance.fit(input, parameters, level_rms))
    }

    fn magnitude(
        &self,
        parameters: &[f64],
        band: Band,
        frequency_hz: &[f64],
        magnitude: &mut [f64],
    ) -> i64 {
        self.status(|instance| instance.magnitude(parameters, band, frequency_hz, magnitude))
    }

    fn interpolate(&self, sets: &[f64], weights: &[f64], parameters: &mut [f64]) -> i64 {
        self.status(|instance| instance.interpolate(sets, weights, parameters))
    }

    fn extension(&self, id: &[u8]) -> i64 {
        self.status(|instance| instance.extension(id))
    }

    fn follows_motion(&self) -> bool {
        self.module.shared.follows_motion()
    }

    fn voice_rate(&self, parameters: &[f64], band: Band, wanted_hz: f64) -> f64 {
        self.call(
            |status| status as f64,
            |rate_hz| rate_hz < 0.0,
            |instance| instance.voice_rate(parameters, band, wanted_hz),
        )
    }

    fn two_voices(
        &self,
        parameters: &[f64],
        band: Band,
        rate_hz: f64,
        seed: u64,
        out: &mut [Vec<f32>; 2],
    ) -> Option<i64> {
        Some(self.status(|instance| {
            for out in out {
                let handle = instance.voice_new(parameters, band, rate_hz, seed)?;
                if handle < 0 {
                    return Ok(handle);
                }
                for block in out.chunks_mut(BLOCK) {
                    let status = instance.voice_render(handle, block)?;
                    if status < 0 {
                        return Ok(status);
                    }
                }
                instance.voice_free(handle)?;
            }
            Ok(0)
        }))
    }

    fn voice_new(
        &self,
        parameters: &[f64],
        band: Band,
        rate_hz: f64,
        seed: u64,
    ) -> Result<Box<dyn RawVoice>, i64> {
        let Some(place) = self.module.shared.place(self.module.limits.voices) else {
            let most = self.module.limits.voices;
            remember(format!("a WASM model may have {most} voices at a time; free some"));
            return Err(Status::TooManyVoices as i64);
        };
        match WasmVoice::new(&self.module, place, (parameters, band), rate_hz, seed) {
            Ok(voice) => Ok(Box::new(voice)),
            Err((status, message)) => {
                remember(message);
                Err(status)
            }
        }
    }
}
