//! A call that did not come back in order.

use htex_model::Status;
use wasmtime::Trap;

use crate::WasmLimits;

/// Why a call did not come back in order; its instance is not used again.
#[derive(Debug, Clone)]
pub(super) struct Fault(pub(super) String);

impl Fault {
    /// What the call answers in place of the module.
    pub(super) const STATUS: i64 = Status::Failed as i64;

    /// A trap, in words that name the limit if there was one.
    pub(super) fn of(error: &wasmtime::Error, limits: &WasmLimits, deadline_ms: u128) -> Self {
        let Some(trap) = error.downcast_ref::<Trap>() else {
            // What `Usage` refuses is no trap but an error with its own words.
            // Around it stand the functions that were running, a line each.
            return Self(format!("the module was stopped: {}", error.root_cause()));
        };
        Self(match trap {
            Trap::Interrupt => {
                format!("the module was stopped: it ran longer than {deadline_ms} ms")
            }
            Trap::OutOfFuel => format!(
                "the module was stopped: it ran more than {} instructions",
                limits.fuel.unwrap_or_default()
            ),
            Trap::StackOverflow => format!(
                "the module was stopped: it used more than {} bytes of stack",
                limits.stack_bytes
            ),
            Trap::UnreachableCodeReached => {
                "the module trapped: it panicked, or ran into `unreachable`".to_owned()
            }
            other => format!("the module trapped: {other}"),
        })
    }
}
