//! Converts errors of the WASM engine to `Fault` values.

use wasmtime::Trap;

use super::fault::Fault;
use crate::WasmLimits;

impl Fault {
    /// Converts an error of the engine. The message of an exceeded limit names the limit.
    pub(super) fn from_trap(
        error: &wasmtime::Error,
        limits: &WasmLimits,
        deadline_ms: u128,
    ) -> Self {
        let Some(trap) = error.downcast_ref::<Trap>() else {
            // An error of `Usage` is not a trap. Its context, one line for each running function,
            // is left out.
            return Self::Refused { what: error.root_cause().to_string() };
        };
        match *trap {
            Trap::Interrupt => Self::Deadline { ms: deadline_ms },
            Trap::OutOfFuel => Self::Fuel { instructions: limits.fuel.unwrap_or_default() },
            Trap::StackOverflow => Self::Stack { bytes: limits.stack_bytes },
            Trap::UnreachableCodeReached => Self::Unreachable,
            other => Self::Trap(other.to_string()),
        }
    }
}
