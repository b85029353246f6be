//! What one instance takes of this machine.

use std::sync::Arc;

use wasmtime::ResourceLimiter;

use crate::WasmLimits;
use crate::sandbox::Budget;

/// Most tables of a module.
const TABLES: usize = 4;

/// An instance's memory and place in the budget, given back when it is dropped.
pub(super) struct Usage {
    budget: Arc<Budget>,
    memory_bytes: usize,
    most_memory_bytes: usize,
    most_elements: usize,
}

impl Usage {
    /// Takes the place of an instance.
    pub(super) fn new(limits: &WasmLimits, budget: &Arc<Budget>) -> Result<Self, String> {
        budget.take_instance()?;
        Ok(Self {
            budget: Arc::clone(budget),
            memory_bytes: 0,
            most_memory_bytes: limits.memory_bytes,
            most_elements: limits.table_elements,
        })
    }
}

impl Drop for Usage {
    fn drop(&mut self) {
        self.budget.give_memory(self.memory_bytes);
        self.budget.give_instance();
    }
}

/// An instance that asks for too much is stopped: an error is a trap, where `false` would be an answer to it.
impl ResourceLimiter for Usage {
    fn memory_growing(
        &mut self,
        _: usize,
        desired: usize,
        _: Option<usize>,
    ) -> wasmtime::Result<bool> {
        if desired > self.most_memory_bytes {
            wasmtime::bail!("its memory is limited to {} bytes", self.most_memory_bytes);
        }
        let more = desired.saturating_sub(self.memory_bytes);
        self.budget
            .take_memory(more)
            .map_err(wasmtime::Error::msg)?;
        self.memory_bytes += more;
        Ok(true)
    }

    fn table_growing(
        &mut self,
        _: usize,
        desired: usize,
        _: Option<usize>,
    ) -> wasmtime::Result<bool> {
        if desired > self.most_elements {
            wasmtime::bail!("a table is limited to {} elements", self.most_elements);
        }
        Ok(true)
    }

    fn instances(&self) -> usize {
        1
    }

    fn memories(&self) -> usize {
        1
    }

    fn tables(&self) -> usize {
        TABLES
    }
}
