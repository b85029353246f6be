//! A module that is checked and compiled.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use wasmtime::{ExternType, Module};

use super::compile;
use super::compile_error::CompileError;
use super::engine::WasmEngine;
use crate::WasmLimits;
use crate::sandbox::{Budget, Sandbox};

/// A compiled module, and the data that its instances share.
pub(super) struct WasmModule {
    pub(super) engine: WasmEngine,
    pub(super) module: Module,
    pub(super) limits: WasmLimits,
    pub(super) budget: Arc<Budget>,
    voices: AtomicUsize,
    follows_motion: AtomicBool,
}

impl WasmModule {
    /// Checks and compiles a module, or takes it from the cache.
    pub(super) fn new(bytes: &[u8], sandbox: &Sandbox) -> Result<Self, CompileError> {
        let limits = &sandbox.limits;
        if bytes.len() > limits.module_bytes {
            return Err(CompileError::TooLarge {
                bytes: limits.module_bytes,
            });
        }
        let module = compile::compiled(bytes, sandbox)?;
        check_imports(&module)?;
        check_memory(&module)?;
        Ok(Self {
            engine: WasmEngine::start(module.engine().clone(), limits)?,
            module,
            limits: limits.clone(),
            budget: Arc::clone(&sandbox.budget),
            voices: AtomicUsize::new(0),
            follows_motion: AtomicBool::new(false),
        })
    }

    /// Returns whether instances must have the functions of `htex.motion/1`.
    pub(super) fn follows_motion(&self) -> bool {
        self.follows_motion.load(Ordering::Relaxed)
    }

    /// Requires the functions of `htex.motion/1` of all later instances.
    pub(super) fn require_motion(&self) {
        self.follows_motion.store(true, Ordering::Relaxed);
    }

    /// Counts one more voice; `None` at the limit.
    pub(super) fn place(self: &Arc<Self>) -> Option<Place> {
        let most = self.limits.voices;
        let take = |n: usize| (n < most).then_some(n + 1);
        let taken = self
            .voices
            .fetch_update(Ordering::Relaxed, Ordering::Relaxed, take);
        taken.ok().map(|_| Place(Arc::clone(self)))
    }
}

/// The count of one voice, released when it is dropped.
pub(super) struct Place(Arc<WasmModule>);

impl Drop for Place {
    fn drop(&mut self) {
        self.0.voices.fetch_sub(1, Ordering::Relaxed);
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
