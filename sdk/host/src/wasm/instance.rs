//! One instance of a module: its functions, and a buffer in its memory for arguments and results.

use std::sync::Arc;
use std::time::{Duration, Instant};

use wasmtime::{Instance as Raw, Memory, Store};

use super::allowance::Allowance;
use super::fault::Fault;
use super::functions::{Find, Functions, Usize};
use super::module::WasmModule;
use super::typed::{Parameters, Returned, TypedFunc};
use super::usage::Usage;

/// An instance with a separate store.
pub(super) struct Instance {
    module: Arc<WasmModule>,
    store: Store<Usage>,
    memory: Memory,
    functions: Functions,
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
        let limits = &module.limits;
        let usage = Usage::new(limits, &module.budget)?;
        let mut store = Store::new(&module.engine.engine, usage);
        store.limiter(|usage| usage);
        let time = limits.call.min(module.budget.time_left()?);
        let fault = |e| Fault::of(&e, limits, time.as_millis());
        arm(&mut store, module, time).map_err(fault)?;
        let start = Instant::now();
        let raw = Raw::new(&mut store, &module.module, &[]);
        module.budget.spend(start.elapsed());
        let raw = raw.map_err(|error| Fault::Start(Box::new(fault(error))))?;
        let memory = raw
            .get_memory(&mut store, "memory")
            .ok_or(Fault::NoMemory)?;
        let mut exports = Exports {
            store: &mut store,
            raw: &raw,
        };
        let functions = Functions::of(&mut exports, module.follows_motion())?;
        Ok(Self {
            module: Arc::clone(module),
            functions,
            store,
            memory,
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

    /// Calls one of the functions within the deadline.
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
        let time = most.min(self.time_left()?);
        let Some(function) = function(&self.functions) else {
            return Err(Fault::NoExtension);
        };
        let start = Instant::now();
        let result = arm(&mut self.store, &self.module, time)
            .and_then(|()| function.call(&mut self.store, parameters));
        self.spend(start.elapsed());
        result.map_err(|e| match self.time_left() {
            Err(used_up) => Fault::Stopped(Box::new(used_up)),
            Ok(_) => Fault::of(&e, &self.module.limits, time.as_millis()),
        })
    }

    /// Returns whether the module has the extension `htex.motion/1`.
    pub(super) fn follows_motion(&self) -> bool {
        self.functions.motion.is_some()
    }

    /// Size of the module's memory, bytes.
    pub(super) fn memory_bytes(&self) -> usize {
        self.memory.data_size(&self.store)
    }

    /// Returns the address of a buffer of at least `bytes`, a multiple of 8, in the module's memory. The buffer is
    /// reallocated only for more bytes.
    pub(super) fn buffer(&mut self, bytes: usize) -> Result<Usize, Fault> {
        if bytes <= self.buffer.1 as usize {
            return Ok(self.buffer.0);
        }
        let too_much = || Fault::TooManyBytes {
            bytes,
            most: self.module.limits.memory_bytes,
        };
        let bytes = bytes.next_power_of_two();
        let fits = bytes <= self.module.limits.memory_bytes;
        let len = Usize::try_from(bytes).ok().filter(|_| fits);
        let len = len.ok_or_else(too_much)?;
        let old = std::mem::take(&mut self.buffer);
        if old.1 > 0 {
            self.call(Deadline::Call, |f| &f.free, old)?;
        }
        let at = self.call(Deadline::Call, |f| &f.alloc, len)?;
        let inside = u64::from(at) + u64::from(len) <= self.memory.data_size(&self.store) as u64;
        if at == 0 || at % 8 != 0 || !inside {
            return Err(Fault::Allocation { at, len });
        }
        self.buffer = (at, len);
        Ok(at)
    }

    /// Writes numbers at an address; returns the address after them.
    pub(super) fn write(&mut self, at: Usize, numbers: &[f64]) -> Result<Usize, Fault> {
        let bytes = self.bytes_mut(at, numbers.len() * 8)?;
        for (to, x) in bytes.chunks_exact_mut(8).zip(numbers) {
            to.copy_from_slice(&x.to_le_bytes());
        }
        Ok(at + (numbers.len() * 8) as Usize)
    }

    /// Writes a text at an address.
    pub(super) fn write_text(&mut self, at: Usize, text: &[u8]) -> Result<(), Fault> {
        self.bytes_mut(at, text.len())?.copy_from_slice(text);
        Ok(())
    }

    /// Reads numbers at an address.
    pub(super) fn read(&self, at: Usize, numbers: &mut [f64]) -> Result<(), Fault> {
        let bytes = self.bytes(at, numbers.len() * 8)?;
        for (x, from) in numbers.iter_mut().zip(bytes.as_chunks().0) {
            *x = f64::from_le_bytes(*from);
        }
        Ok(())
    }

    /// Reads samples at an address.
    pub(super) fn read_samples(&self, at: Usize, samples: &mut [f32]) -> Result<(), Fault> {
        let bytes = self.bytes(at, samples.len() * 4)?;
        for (x, from) in samples.iter_mut().zip(bytes.as_chunks().0) {
            *x = f32::from_le_bytes(*from);
        }
        Ok(())
    }

    /// Reads bytes at an address.
    pub(super) fn read_bytes(&self, at: Usize, out: &mut [u8]) -> Result<(), Fault> {
        out.copy_from_slice(self.bytes(at, out.len())?);
        Ok(())
    }

    fn bytes(&self, at: Usize, len: usize) -> Result<&[u8], Fault> {
        let data = self.memory.data(&self.store);
        data.get(at as usize..)
            .and_then(|rest| rest.get(..len))
            .ok_or(Fault::Outside)
    }

    fn bytes_mut(&mut self, at: Usize, len: usize) -> Result<&mut [u8], Fault> {
        let data = self.memory.data_mut(&mut self.store);
        data.get_mut(at as usize..)
            .and_then(|rest| rest.get_mut(..len))
            .ok_or(Fault::Outside)
    }
}

/// Sets the time and the instructions of the next call.
fn arm(store: &mut Store<Usage>, module: &WasmModule, time: Duration) -> wasmtime::Result<()> {
    store.set_epoch_deadline(module.engine.ticks(time));
    match module.limits.fuel {
        Some(fuel) => store.set_fuel(fuel),
        None => Ok(()),
    }
}

/// A new instance, and its store.
struct Exports<'a> {
    store: &'a mut Store<Usage>,
    raw: &'a Raw,
}

impl Find for Exports<'_> {
    fn find<P: Parameters, R: Returned>(
        &mut self,
        name: &'static str,
    ) -> Result<TypedFunc<P, R>, Fault> {
        let function = self.raw.get_func(&mut *self.store, name);
        let function = function.ok_or_else(|| Fault::NoFunction {
            name: name.to_owned(),
        })?;
        function
            .typed(&*self.store)
            .map_err(|error| Fault::Signature {
                name: name.to_owned(),
                what: format!("{error:#}"),
            })
    }
}
