//! Errors of compiling a module.

use wasmparser::BinaryReaderError;

use crate::sandbox::BudgetError;

/// Error: a module cannot be compiled.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub(super) enum CompileError {
    #[error("the module is larger than the {bytes} bytes allowed")]
    TooLarge { bytes: usize },
    #[error("invalid module: {what}")]
    Invalid { what: String },
    #[error(
        "the module imports `{module}.{name}`; a model may import nothing (build it for wasm32-unknown-unknown, \
         without files, clocks and randomness)"
    )]
    Import { module: String, name: String },
    #[error("the module exports no `memory`; it is not an htex model")]
    NoMemory,
    #[error(
        "the module may take {ms} ms to compile, and {allowed_ms} ms are allowed; it has too much code, or functions \
         with too many variables and nested blocks"
    )]
    TooSlow { ms: u128, allowed_ms: u128 },
    #[error(transparent)]
    Budget(#[from] BudgetError),
    /// An error of the engine, in this process or in the process that compiles.
    #[error("{what}")]
    Engine { what: String },
    #[error("cannot start the clock that interrupts modules: {what}")]
    Clock { what: String },
    #[error("cannot start {program} to compile: {what}")]
    Start { program: String, what: String },
    #[error(
        "the compiler process ended without a result: the module needs more than {bytes} bytes to compile, or it \
         crashes the compiler"
    )]
    NoReply { bytes: usize },
    #[error("the module took longer than {ms} ms to compile, and compilation was stopped")]
    Timeout { ms: u128 },
    #[error("the output of the compiler process cannot be read")]
    NoOutput,
}

impl From<wasmtime::Error> for CompileError {
    /// Converts an error of the engine, including its causes.
    fn from(error: wasmtime::Error) -> Self {
        Self::Engine { what: format!("{error:#}") }
    }
}

impl From<BinaryReaderError> for CompileError {
    fn from(error: BinaryReaderError) -> Self {
        Self::Invalid { what: error.to_string() }
    }
}

/// An error of the process that compiles modules for a host
/// ([`serve_compiler`](crate::serve_compiler)).
///
/// ```
/// let error = htex_host::serve_compiler(&[]).unwrap_err();
/// assert!(matches!(error, htex_host::CompilerError::Arguments));
/// ```
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CompilerError {
    /// The arguments do not come from a host of this version.
    #[error("invalid arguments: only a host starts this process, to compile a module")]
    Arguments,
    /// The process cannot limit its memory and time.
    #[error("cannot limit the compiler process: {0}")]
    Limits(#[source] std::io::Error),
    /// The module cannot be read, or the result cannot be written.
    #[error("the pipe to the host failed: {0}")]
    Pipe(#[from] std::io::Error),
}
