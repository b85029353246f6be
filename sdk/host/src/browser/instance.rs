//! One instance of a module: its functions, and a buffer in its memory for arguments and results.

use std::sync::Arc;
use std::time::Duration;

use super::allowance::Allowance;
use super::fault::Fault;
use super::imports::{GuestInstance, Outside};
use super::module::WasmModule;
use super::typed::{Parameters, Returned, TypedFunc};
use crate::clock::Instant;
use crate::sandbox::{Budget, BudgetError};

/// Addresses and lengths in the module's memory.
type Usize = u32;

/// The names of the functions of [`Functions`], by index.
const NAMES: &str = "htex_model_abi_version,htex_model_descriptor,htex_model_last_error,htex_model_fit,\
                     htex_model_magnitude,htex_model_interpolate,htex_model_voice_rate,htex_model_voice_new,\
                     htex_model_voice_render,htex_model_voice_retune,htex_model_voice_free,htex_model_extension,\
                     htex_model_alloc,htex_model_free";
/// Those of models that follow the motion.
const MOTION_NAMES: &str = "htex_motion_1_set,htex_motion_1_fit";

/// The functions of the model ABI (`htex_model::abi`).
pub(super) struct Functions {
    pub(super) abi_version: TypedFunc<(), u32>,
    pub(super) descriptor: TypedFunc<(Usize, Usize), i64>,
    pub(super) last_error: TypedFunc<(Usize, Usize), i64>,
    pub(super) fit: TypedFunc<FitParams, i64>,
    pub(super) magnitude: TypedFunc<MagnitudeParams, i64>,
    pub(super) interpolate: TypedFunc<(Usize, Usize, Usize, Usize, Usize, Usize), i64>,
    pub(super) voice_rate: TypedFunc<(Usize, Usize, f64, f64, f64), f64>,
    pub(super) voice_new: TypedFunc<(Usize, Usize, f64, f64, f64, u64), i64>,
    pub(super) voice_render: TypedFunc<(i64, Usize, Usize), i64>,
    pub(super) voice_retune: TypedFunc<(i64, Usize, Usize), i64>,
    pub(super) voice_free: TypedFunc<i64, i64>,
    pub(super) extension: TypedFunc<(Usize, Usize), i64>,
    alloc: TypedFunc<Usize, Usize>,
    free: TypedFunc<(Usize, Usize), ()>,
    /// If the model has the extension `htex.motion/1`.
    pub(super) motion: Option<MotionFunctions>,
}

/// The functions of `htex.motion/1` (`htex_model::motion_1`).
pub(super) struct MotionFunctions {
    pub(super) set: TypedFunc<(i64, f64, f64, f64), i64>,
    pub(super) fit: TypedFunc<MotionFitParams, i64>,
}

type FitParams = (
    f64,
    f64,
    Usize,
    Usize,
    Usize,
    Usize,
    Usize,
    f64,
    Usize,
    Usize,
    Usize,
    Usize,
    Usize,
);

type MotionFitParams = (
    f64,
    f64,
    Usize,
    Usize,
    Usize,
    Usize,
    Usize,
    f64,
    Usize,
    Usize,
    f64,
    f64,
    Usize,
    Usize,
    Usize,
);

type MagnitudeParams = (Usize, Usize, f64, f64, Usize, Usize, Usize);

impl Functions {
    fn new(motion: bool) -> Self {
        Self {
            abi_version: TypedFunc::new(0),
            descriptor: TypedFunc::new(1),
            last_error: TypedFunc::new(2),
            fit: TypedFunc::new(3),
            magnitude: TypedFunc::new(4),
            interpolate: TypedFunc::new(5),
            voice_rate: TypedFunc::new(6),
            voice_new: TypedFunc::new(7),
            voice_render: TypedFunc::new(8),
            voice_retune: TypedFunc::new(9),
            voice_free: TypedFunc::new(10),
            extension: TypedFunc::new(11),
            alloc: TypedFunc::new(12),
            free: TypedFunc::new(13),
            motion: motion.then(|| MotionFunctions {
                set: TypedFunc::new(14),
                fit: TypedFunc::new(15),
            }),
        }
    }
}

/// An instance with a separate memory.
pub(super) struct Instance {
    module: Arc<WasmModule>,
    guest: GuestInstance,
    functions: Functions,
    usage: Usage,
    /// The time of a voice; the time of other calls is part of the modules' budget.
    allowance: Option<Allowance>,
    /// Address and length of the buffer; length 0 until it is allocated.
    buffer: (Usize, Usize),
}

/// The time limit of a call.
#[derive(Clone, Copy)]
pub(super) enum Deadline {
    Call,
    Render,
}

impl Instance {
    /// Makes an instance, which runs the module's start function.
    pub(super) fn new(module: &Arc<WasmModule>) -> Result<Self, Fault> {
        let mut usage = Usage::new(&module.budget)?;
        module.budget.time_left()?;
        let motion = module.follows_motion();
        let names = match motion {
            true => format!("{NAMES},{MOTION_NAMES}"),
            false => NAMES.to_owned(),
        };
        let start = Instant::now();
        let guest = module.guest.instance(&names);
        module.budget.spend(start.elapsed());
        let guest = guest.map_err(|what| Fault::Start(Box::new(Fault::Refused { what })))?;
        usage.grow(guest.memory_bytes())?;
        Ok(Self {
            module: Arc::clone(module),
            guest,
            functions: Functions::new(motion),
            usage,
            allowance: None,
            buffer: (0, 0),
        })
    }

    /// Makes this the instance of a voice, which renders at a rate and has a separate time limit.
    pub(super) fn limit_as_voice(&mut self, rate_hz: f64) {
        self.allowance = Some(Allowance::new(rate_hz));
    }

    /// Adds the time that rendered samples allow.
    pub(super) fn earn(&mut self, samples: usize) {
        if let Some(allowance) = &mut self.allowance {
            allowance.earn(samples);
        }
    }

    /// Returns the time left to this instance.
    fn time_left(&self) -> Result<Duration, Fault> {
        match &self.allowance {
            Some(allowance) => allowance.left(),
            None => Ok(self.module.budget.time_left()?),
        }
    }

    fn spend(&mut self, time: Duration) {
        match &mut self.allowance {
            Some(allowance) => allowance.spend(time),
            None => self.module.budget.spend(time),
        }
    }

    /// Calls one of the functions. A call that takes longer than the deadline fails afterwards.
    pub(super) fn call<P: Parameters, R: Returned>(
        &mut self,
        deadline: Deadline,
        function: impl Fn(&Functions) -> &TypedFunc<P, R>,
        parameters: P,
    ) -> Result<R, Fault> {
        self.call_if(deadline, |functions| Some(function(functions)), parameters)
    }

    /// As [`Self::call`], of a function that only some models have.
    pub(super) fn call_if<P: Parameters, R: Returned>(
        &mut self,
        deadline: Deadline,
        function: impl Fn(&Functions) -> Option<&TypedFunc<P, R>>,
        parameters: P,
    ) -> Result<R, Fault> {
        let most = match deadline {
            Deadline::Call => self.module.limits.call,
            Deadline::Render => self.module.limits.render,
        };
        let most = most.min(self.time_left()?);
        let Some(function) = function(&self.functions) else {
            return Err(Fault::NoExtension);
        };
        let start = Instant::now();
        let result = function.call(&self.guest, parameters);
        let time = start.elapsed();
        self.spend(time);
        if time > most {
            let ms = most.as_millis();
            return Err(Fault::Deadline { ms });
        }
        let returned = result?;
        self.usage.grow(self.guest.memory_bytes())?;
        Ok(returned)
    }

    /// Returns whether the module has the extension `htex.motion/1`.
    pub(super) fn follows_motion(&self) -> bool {
        self.functions.motion.is_some()
    }

    /// Size of the module's memory, bytes.
    pub(super) fn memory_bytes(&self) -> usize {
        self.guest.memory_bytes()
    }

    /// Returns the address of a buffer of at least `bytes`, a multiple of 8, in the module's memory. The buffer is
    /// reallocated only for more bytes.
    pub(super) fn buffer(&mut self, bytes: usize) -> Result<Usize, Fault> {
        if bytes <= self.buffer.1 as usize {
            return Ok(self.buffer.0);
        }
        let most = self.module.limits.memory_bytes;
        let len = bytes.next_power_of_two();
        if len > most {
            return Err(Fault::TooManyBytes { bytes, most });
        }
        let len = len as Usize;
        let old = std::mem::take(&mut self.buffer);
        if old.1 > 0 {
            self.call(Deadline::Call, |f| &f.free, old)?;
        }
        let at = self.call(Deadline::Call, |f| &f.alloc, len)?;
        let inside = u64::from(at) + u64::from(len) <= self.memory_bytes() as u64;
        if at == 0 || at % 8 != 0 || !inside {
            return Err(Fault::Allocation { at, len });
        }
        self.buffer = (at, len);
        Ok(at)
    }

    /// Writes numbers at an address; returns the address after them.
    pub(super) fn write(&mut self, at: Usize, numbers: &[f64]) -> Result<Usize, Fault> {
        self.guest.write(at, numbers)?;
        Ok(at + (numbers.len() * 8) as Usize)
    }

    /// Writes a text at an address.
    pub(super) fn write_text(&mut self, at: Usize, text: &[u8]) -> Result<(), Fault> {
        Ok(self.guest.write(at, text)?)
    }

    /// Reads numbers at an address.
    pub(super) fn read(&self, at: Usize, numbers: &mut [f64]) -> Result<(), Fault> {
        Ok(self.guest.read(at, numbers)?)
    }

    /// Reads samples at an address.
    pub(super) fn read_samples(&self, at: Usize, samples: &mut [f32]) -> Result<(), Fault> {
        Ok(self.guest.read(at, samples)?)
    }

    /// Reads bytes at an address.
    pub(super) fn read_bytes(&self, at: Usize, out: &mut [u8]) -> Result<(), Fault> {
        Ok(self.guest.read(at, out)?)
    }
}

impl From<Outside> for Fault {
    fn from(_: Outside) -> Self {
        Self::Outside
    }
}

/// An instance's part of the budget, released when it is dropped.
struct Usage {
    budget: Arc<Budget>,
    memory_bytes: usize,
}

impl Usage {
    /// Counts one more instance in the budget.
    fn new(budget: &Arc<Budget>) -> Result<Self, BudgetError> {
        budget.take_instance()?;
        Ok(Self {
            budget: Arc::clone(budget),
            memory_bytes: 0,
        })
    }

    /// Counts the memory that the instance has grown by.
    fn grow(&mut self, memory_bytes: usize) -> Result<(), BudgetError> {
        let more = memory_bytes.saturating_sub(self.memory_bytes);
        if more > 0 {
            self.budget.take_memory(more)?;
            self.memory_bytes += more;
        }
        Ok(())
    }
}

impl Drop for Usage {
    fn drop(&mut self) {
        self.budget.give_memory(self.memory_bytes);
        self.budget.give_instance();
    }
}
