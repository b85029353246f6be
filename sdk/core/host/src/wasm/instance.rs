//! One instance of a module: its functions, and a buffer in its memory for arguments and results.
//! Both engines share this code. The module `guest` contains the code that differs between the
//! engines.

use std::sync::Arc;
use std::time::Duration;

use super::allowance::Allowance;
use super::fault::Fault;
use super::functions::{Functions, Usize};
use super::guest::{Guest, Number};
use super::module::WasmModule;
use super::typed::{Parameters, Returned, TypedFunc};
use crate::clock::Instant;

/// An instance with a separate memory.
pub(super) struct Instance {
    module: Arc<WasmModule>,
    guest: Guest,
    functions: Functions,
    /// The time left for a voice, if this is the instance of a voice. Other instances use the time
    /// of the modules' budget.
    allowance: Option<Allowance>,
    /// Address and length of the buffer. The length is 0 until the buffer is allocated.
    buffer: (Usize, Usize),
}

/// Guard bytes behind an array. If a call writes beyond the array, these bytes change.
const GUARD: [u8; 4096] = [0xA5; 4096];

/// The time limit of a call.
#[derive(Clone, Copy)]
pub(super) enum Deadline {
    Call,
    Render,
}

impl Instance {
    /// Creates an instance and runs the module's start function.
    pub(super) fn new(module: &Arc<WasmModule>) -> Result<Self, Fault> {
        let (guest, functions) = Guest::new(module)?;
        Ok(Self { module: Arc::clone(module), guest, functions, allowance: None, buffer: (0, 0) })
    }

    /// Makes this the instance of a voice with a time limit of its own. `rate_hz` is the voice's
    /// sample rate.
    pub(super) fn limit_as_voice(&mut self, rate_hz: f64) {
        self.allowance = Some(Allowance::new(rate_hz));
    }

    /// Adds the time that the voice earns by rendering `samples` samples.
    pub(super) fn earn(&mut self, samples: usize) {
        if let Some(allowance) = &mut self.allowance {
            allowance.earn(samples);
        }
    }

    /// Returns the time left for this instance.
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

    /// Calls one of the functions within the deadline.
    pub(super) fn call<P: Parameters, R: Returned>(
        &mut self,
        deadline: Deadline,
        function: impl Fn(&Functions) -> &TypedFunc<P, R>,
        parameters: P,
    ) -> Result<R, Fault> {
        self.call_if(deadline, |functions| Some(function(functions)), parameters)
    }

    /// Calls a function that only some models have. Otherwise the same as [`Self::call`].
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
        let time = most.min(self.time_left()?);
        let Some(function) = function(&self.functions) else {
            return Err(Fault::NoExtension);
        };
        let start = Instant::now();
        let result = self.guest.call(&self.module, function, parameters, time);
        let taken = start.elapsed();
        self.spend(taken);
        let returned = self.guest.returned(&self.module, result, taken, time);
        returned.map_err(|fault| match self.time_left() {
            // The fault does not say which limit stopped the call. If a budget is empty, that
            // budget was the limit.
            Err(used_up) => Fault::Stopped(Box::new(used_up)),
            Ok(_) => fault,
        })
    }

    /// Returns whether the module has the extension `htex.motion/1`.
    pub(super) fn follows_motion(&self) -> bool {
        self.functions.motion.is_some()
    }

    pub(super) fn memory_bytes(&self) -> usize {
        self.guest.memory_bytes()
    }

    /// Returns the address of a buffer of at least `bytes` bytes in the module's memory. The address
    /// is a multiple of 8. The buffer is reallocated only if it is too small.
    pub(super) fn buffer(&mut self, bytes: usize) -> Result<Usize, Fault> {
        let bytes = if self.module.limits.guards { bytes + GUARD.len() } else { bytes };
        if bytes <= self.buffer.1 as usize {
            return Ok(self.buffer.0);
        }
        let too_much = || Fault::TooManyBytes { bytes, most: self.module.limits.memory_bytes };
        // The size is rounded up to a power of two, so that calls whose data grows slowly rarely
        // need a new buffer.
        let bytes = bytes.next_power_of_two();
        let fits = bytes <= self.module.limits.memory_bytes;
        let len = Usize::try_from(bytes).ok().filter(|_| fits).ok_or_else(too_much)?;
        // The old buffer is removed from `self` first. If a call below fails, `self` does not keep
        // a freed address.
        let old = std::mem::take(&mut self.buffer);
        if old.1 > 0 {
            self.call(Deadline::Call, |f| &f.free, old)?;
        }
        let at = self.call(Deadline::Call, |f| &f.alloc, len)?;
        // The sum is computed with 64 bits, because the address comes from the module, and the sum
        // may exceed 32 bits.
        let inside = u64::from(at) + u64::from(len) <= self.memory_bytes() as u64;
        if at == 0 || at % 8 != 0 || !inside {
            return Err(Fault::Allocation { at, len });
        }
        self.buffer = (at, len);
        Ok(at)
    }

    /// Writes numbers at an address and returns the address after them.
    pub(super) fn write(&mut self, at: Usize, numbers: &[f64]) -> Result<Usize, Fault> {
        self.guest.write(at, numbers)?;
        Ok(at + (numbers.len() * 8) as Usize)
    }

    pub(super) fn write_text(&mut self, at: Usize, text: &[u8]) -> Result<(), Fault> {
        self.guest.write(at, text)
    }

    /// Writes guard bytes after an array if the limits require this.
    pub(super) fn guard(&mut self, behind: Usize) -> Result<(), Fault> {
        if self.module.limits.guards { self.guest.write(behind, &GUARD) } else { Ok(()) }
    }

    /// Returns an error if a call wrote to the guard bytes after an array of `len` values. `bound`
    /// is the name of the argument that states the length.
    pub(super) fn unharmed(
        &self,
        behind: Usize,
        bound: &'static str,
        len: usize,
    ) -> Result<(), Fault> {
        if !self.module.limits.guards {
            return Ok(());
        }
        let mut found = [0; GUARD.len()];
        self.guest.read(behind, &mut found)?;
        if found == GUARD { Ok(()) } else { Err(Fault::Beyond { bound, len }) }
    }

    /// Reads numbers, samples or bytes at an address.
    pub(super) fn read<T: Number>(&self, at: Usize, out: &mut [T]) -> Result<(), Fault> {
        self.guest.read(at, out)
    }
}
