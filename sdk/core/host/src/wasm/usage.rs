//! The memory that one instance of a WASM module uses.

use std::sync::Arc;

use wasmtime::ResourceLimiter;

use crate::WasmLimits;
use crate::sandbox::{Budget, BudgetError};

/// Maximum number of tables of a module.
const TABLES: usize = 4;

/// An instance's share of the budget, released when it is dropped.
pub(super) struct Usage {
    budget: Arc<Budget>,
    memory_bytes: usize,
    most_memory_bytes: usize,
    most_elements: usize,
}

impl Usage {
    /// Counts one more instance in the budget.
    pub(super) fn new(limits: &WasmLimits, budget: &Arc<Budget>) -> Result<Self, BudgetError> {
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

/// Stops an instance that exceeds a limit. The functions return an error, which stops the instance.
/// If they returned `false` instead, the instance would continue, and only the instruction that
/// requested memory would fail.
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
        self.budget.take_memory(more).map_err(wasmtime::Error::new)?;
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
