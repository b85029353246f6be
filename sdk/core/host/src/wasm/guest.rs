//! A module instance that runs in wasmtime.

use std::sync::Arc;
use std::time::{Duration, Instant};

use wasmtime::{Instance, Memory, Store};

use super::fault::Fault;
use super::functions::{Find, Functions, Usize};
use super::module::WasmModule;
use super::typed::{Parameters, Returned, TypedFunc};
use super::usage::Usage;

/// A wasmtime store, and the memory of the instance in this store.
pub(super) struct Guest {
    store: Store<Usage>,
    memory: Memory,
}

impl Guest {
    /// Creates an instance and finds its functions.
    pub(super) fn new(module: &Arc<WasmModule>) -> Result<(Self, Functions), Fault> {
        let limits = &module.limits;
        let usage = Usage::new(limits, &module.budget)?;
        let mut store = Store::new(&module.engine.engine, usage);
        store.limiter(|usage| usage);
        let time = limits.call.min(module.budget.time_left()?);
        let fault = |e| Fault::from_trap(&e, limits, time.as_millis());
        // The start function is also code of the module, so it gets a deadline.
        arm(&mut store, module, time).map_err(fault)?;
        let start = Instant::now();
        let raw = Instance::new(&mut store, &module.module, &[]);
        // The time is subtracted before the result is checked, because a failed start has also
        // taken time.
        module.budget.spend(start.elapsed());
        let raw = raw.map_err(|error| Fault::Start(Box::new(fault(error))))?;
        let memory = raw.get_memory(&mut store, "memory").ok_or(Fault::NoMemory)?;
        let mut exports = Exports { store: &mut store, raw: &raw };
        let functions = Functions::find(&mut exports, module.shared.follows_motion())?;
        Ok((Self { store, memory }, functions))
    }

    /// Calls a function and stops it when its time is over.
    pub(super) fn call<P: Parameters, R: Returned>(
        &mut self,
        module: &WasmModule,
        function: &TypedFunc<P, R>,
        parameters: P,
        time: Duration,
    ) -> wasmtime::Result<R> {
        arm(&mut self.store, module, time)?;
        function.call(&mut self.store, parameters)
    }

    /// Checks the result of a call whose time limit was `most`.
    pub(super) fn returned<R>(
        &mut self,
        module: &WasmModule,
        result: wasmtime::Result<R>,
        _taken: Duration,
        most: Duration,
    ) -> Result<R, Fault> {
        result.map_err(|error| Fault::from_trap(&error, &module.limits, most.as_millis()))
    }

    pub(super) fn memory_bytes(&self) -> usize {
        self.memory.data_size(&self.store)
    }

    pub(super) fn read<T: Number>(&self, at: Usize, out: &mut [T]) -> Result<(), Fault> {
        let data = self.memory.data(&self.store);
        let bytes = data.get(at as usize..).and_then(|rest| rest.get(..size_of_val(out)));
        T::read(bytes.ok_or(Fault::Outside)?, out);
        Ok(())
    }

    pub(super) fn write<T: Number>(&mut self, at: Usize, numbers: &[T]) -> Result<(), Fault> {
        let data = self.memory.data_mut(&mut self.store);
        let bytes =
            data.get_mut(at as usize..).and_then(|rest| rest.get_mut(..size_of_val(numbers)));
        T::write(numbers, bytes.ok_or(Fault::Outside)?);
        Ok(())
    }
}

/// Sets the limits of time and instructions for the next call.
fn arm(store: &mut Store<Usage>, module: &WasmModule, time: Duration) -> wasmtime::Result<()> {
    store.set_epoch_deadline(module.engine.ticks(time));
    match module.limits.fuel {
        Some(fuel) => store.set_fuel(fuel),
        None => Ok(()),
    }
}

/// A new instance with its store.
struct Exports<'a> {
    store: &'a mut Store<Usage>,
    raw: &'a Instance,
}

impl Find for Exports<'_> {
    fn get<P: Parameters, R: Returned>(
        &mut self,
        name: &'static str,
    ) -> Result<TypedFunc<P, R>, Fault> {
        let function = self
            .raw
            .get_func(&mut *self.store, name)
            .ok_or_else(|| Fault::NoFunction { name: name.to_owned() })?;
        function
            .typed(&*self.store)
            .map_err(|error| Fault::Signature { name: name.to_owned(), what: format!("{error:#}") })
    }
}

/// A number in a module's memory, little-endian.
pub(super) trait Number: Sized {
    fn read(bytes: &[u8], out: &mut [Self]);
    fn write(numbers: &[Self], bytes: &mut [u8]);
}

macro_rules! numbers {
    ($($number:ty)+) => {$(
        impl Number for $number {
            fn read(bytes: &[u8], out: &mut [Self]) {
                for (x, from) in out.iter_mut().zip(bytes.as_chunks().0) {
                    *x = Self::from_le_bytes(*from);
                }
            }

            fn write(numbers: &[Self], bytes: &mut [u8]) {
                for (to, x) in bytes.as_chunks_mut().0.iter_mut().zip(numbers) {
                    *to = x.to_le_bytes();
                }
            }
        }
    )+};
}

numbers!(u8 f32 f64);
