//! A module instance that runs in the browser.

use std::sync::Arc;
use std::time::Duration;

use super::fault::Fault;
use super::functions::{Find, Functions, Usize};
pub(super) use super::imports::Number;
use super::imports::{GuestInstance, Outside};
use super::module::WasmModule;
use super::typed::{Parameters, Returned, TypedFunc};
use crate::clock::Instant;
use crate::sandbox::{Budget, BudgetError};

/// The names of requested functions. A function's index is its position in the list.
#[derive(Default)]
struct Names(Vec<&'static str>);

impl Find for Names {
    fn get<P: Parameters, R: Returned>(
        &mut self,
        name: &'static str,
    ) -> Result<TypedFunc<P, R>, Fault> {
        self.0.push(name);
        Ok(TypedFunc::new(self.0.len() as u32 - 1))
    }
}

/// A module instance and its share of the budget.
pub(super) struct Guest {
    raw: GuestInstance,
    usage: Usage,
}

impl Guest {
    /// Creates an instance and finds its functions.
    pub(super) fn new(module: &Arc<WasmModule>) -> Result<(Self, Functions), Fault> {
        let mut usage = Usage::new(&module.budget)?;
        module.budget.time_left()?;
        let mut names = Names::default();
        let functions = Functions::find(&mut names, module.shared.follows_motion())?;
        let start = Instant::now();
        let raw = module.guest.instance(&names.0.join(","));
        // The time counts even if the call failed, because the start function may have run.
        module.budget.spend(start.elapsed());
        let raw = raw.map_err(|what| Fault::Start(Box::new(Fault::Refused { what })))?;
        usage.grow(raw.memory_bytes())?;
        Ok((Self { raw, usage }, functions))
    }

    /// Calls a function. Nothing can interrupt the call.
    pub(super) fn call<P: Parameters, R: Returned>(
        &mut self,
        _module: &WasmModule,
        function: &TypedFunc<P, R>,
        parameters: P,
        _time: Duration,
    ) -> Result<R, Fault> {
        function.call(&self.raw, parameters)
    }

    /// Checks the result of a call whose time limit was `most`. If a call took longer, it fails
    /// only here, because the host cannot interrupt it.
    pub(super) fn returned<R>(
        &mut self,
        _module: &WasmModule,
        result: Result<R, Fault>,
        taken: Duration,
        most: Duration,
    ) -> Result<R, Fault> {
        if taken > most {
            let ms = most.as_millis();
            return Err(Fault::Deadline { ms });
        }
        // A browser does not ask the host before a memory grows. Therefore, the growth is counted
        // after the call.
        let returned = result?;
        self.usage.grow(self.raw.memory_bytes())?;
        Ok(returned)
    }

    pub(super) fn memory_bytes(&self) -> usize {
        self.raw.memory_bytes()
    }

    pub(super) fn read<T: Number>(&self, at: Usize, out: &mut [T]) -> Result<(), Fault> {
        Ok(self.raw.read(at, out)?)
    }

    pub(super) fn write<T: Number>(&mut self, at: Usize, numbers: &[T]) -> Result<(), Fault> {
        Ok(self.raw.write(at, numbers)?)
    }
}

impl From<Outside> for Fault {
    fn from(_: Outside) -> Self {
        Self::Outside
    }
}

/// An instance's share of the budget, released when it is dropped.
struct Usage {
    budget: Arc<Budget>,
    memory_bytes: usize,
}

impl Usage {
    /// Counts one more instance in the budget.
    fn new(budget: &Arc<Budget>) -> Result<Self, BudgetError> {
        budget.take_instance()?;
        Ok(Self { budget: Arc::clone(budget), memory_bytes: 0 })
    }

    /// Adds the growth of the instance's memory to the budget.
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
