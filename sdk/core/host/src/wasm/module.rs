//! A checked and compiled module.

use std::sync::Arc;

use wasmtime::{ExternType, Module};

use super::compile;
use super::compile_error::CompileError;
use super::engine::ClockedEngine;
use super::shared::Shared;
use crate::WasmLimits;
use crate::sandbox::{Budget, Sandbox};

/// A compiled module, and the data that its instances share.
pub(super) struct WasmModule {
    pub(super) engine: ClockedEngine,
    pub(super) module: Module,
    pub(super) limits: WasmLimits,
    pub(super) budget: Arc<Budget>,
    pub(super) shared: Arc<Shared>,
}

impl WasmModule {
    /// Checks a module, and compiles it or loads it from the cache.
    pub(super) fn new(bytes: &[u8], sandbox: &Sandbox) -> Result<Self, CompileError> {
        let limits = &sandbox.limits;
        if bytes.len() > limits.module_bytes {
            return Err(CompileError::TooLarge { bytes: limits.module_bytes });
        }
        let module = compile::compiled(bytes, sandbox)?;
        check_imports(&module)?;
        check_memory(&module)?;
        Ok(Self {
            engine: ClockedEngine::start(module.engine().clone(), limits)?,
            module,
            limits: limits.clone(),
            budget: Arc::clone(&sandbox.budget),
            shared: Arc::default(),
        })
    }
}

/// Refuses modules with imports.
fn check_imports(module: &Module) -> Result<(), CompileError> {
    match module.imports().next() {
        None => Ok(()),
        Some(import) => Err(CompileError::Import {
            module: import.module().to_owned(),
            name: import.name().to_owned(),
        }),
    }
}

fn check_memory(module: &Module) -> Result<(), CompileError> {
    match module.get_export("memory") {
        Some(ExternType::Memory(_)) => Ok(()),
        _ => Err(CompileError::NoMemory),
    }
}
