//! Errors that a call of a module's function can return.

use htex_model::Status;

use crate::sandbox::BudgetError;

/// An error of a call to a module. After such an error, the instance is not used again.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub(super) enum Fault {
    #[error(transparent)]
    Budget(#[from] BudgetError),
    #[error("the voice takes more than {times} times the duration of its samples to render")]
    VoiceTime { times: f64 },
    /// The voice's time, or the time of all modules together, ran out during the call.
    #[error("the module was stopped: {0}")]
    Stopped(Box<Self>),
    /// The host refused a resource, or the engine reported an error that is not a trap.
    #[error("the module was stopped: {what}")]
    Refused { what: String },
    #[error("the module was stopped: it ran longer than {ms} ms")]
    Deadline { ms: u128 },
    #[error("the module was stopped: it ran more than {instructions} instructions")]
    Fuel { instructions: u64 },
    #[error("the module was stopped: it used more than {bytes} bytes of stack")]
    Stack { bytes: usize },
    #[error("the module trapped: it panicked, or ran into `unreachable`")]
    Unreachable,
    #[error("the module trapped: {0}")]
    Trap(String),
    /// An error in the module's start function.
    #[error("at its start: {0}")]
    Start(Box<Self>),
    #[error("the module exports no `memory`")]
    NoMemory,
    #[error("the module exports no function `{name}`; it is not an htex model")]
    NoFunction { name: String },
    #[error("`{name}` does not have the arguments of the model ABI: {what}")]
    Signature { name: String, what: String },
    #[error("the module does not have the extension of this call")]
    NoExtension,
    #[error("a call passes {bytes} bytes; the module's memory is limited to {most}")]
    TooManyBytes { bytes: usize, most: usize },
    #[error(
        "`htex_model_alloc` returned {at:#x} for {len} bytes, which is not an aligned block in the module's memory"
    )]
    Allocation { at: u32, len: u32 },
    #[error("an argument or result lies outside the module's memory")]
    Outside,
    #[error("the call wrote beyond `{bound}`, which was {len}")]
    Beyond { bound: &'static str, len: usize },
    #[error("`htex_model_voice_new` returned the handle 0")]
    HandleZero,
}

impl Fault {
    /// The status that a call with a fault returns.
    pub(super) const STATUS: i64 = Status::Failed as i64;
}
