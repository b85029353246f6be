//! One instance of a module: its functions, and a buffer in its memory for arguments and results.

use std::sync::Arc;
use std::time::Duration;

use super::allowance::Allowance;
use super::fault::Fault;
use super::functions::{Find, Functions, Usize};
use super::imports::{GuestInstance, Outside};
use super::module::WasmModule;
use super::typed::{Parameters, Returned, TypedFunc};
use crate::clock::Instant;
use crate::sandbox::{Budget, BudgetError};

/// The functions that are asked for, by their place in the list.
#[derive(Default)]
struct Names(Vec<&'static str>);

impl Find for Names {
    fn find<P: Parameters, R: Returned>(
        &mut self,
        name: &'static str,
    ) -> Result<TypedFunc<P, R>, Fault> {
        self.0.push(name);
        Ok(TypedFunc::new(self.0.len() as u32 - 1))
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
        let mut names = Names::default();
        let functions = Functions::of(&mut names, module.follows_motion())?;
        let start = Instant::now();
        let guest = module.guest.instance(&names.0.join(","));
        module.budget.spend(start.elapsed());
        let guest = guest.map_err(|what| Fault::Start(Box::new(Fault::Refused { what })))?;
        usage.grow(guest.memory_bytes())?;
        Ok(Self {
            module: Arc::clone(module),
            guest,
            functions,
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
