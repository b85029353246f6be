//! A module: checked, compiled, ready to be instantiated.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use wasmtime::{ExternType, Module};

use super::compile;
use super::engine::WasmEngine;
use crate::WasmLimits;
use crate::sandbox::{Budget, Sandbox};

/// A compiled module and what its instances share.
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
    pub(super) fn new(bytes: &[u8], sandbox: &Sandbox) -> Result<Self, String> {
        let limits = &sandbox.limits;
        if bytes.len() > limits.module_bytes {
            return Err(format!(
                "the module is larger than the {} bytes allowed",
                limits.module_bytes
            ));
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

    /// Whether instances have the functions of `htex.motion/1`: no, until it is said.
    pub(super) fn follows_motion(&self) -> bool {
        self.follows_motion.load(Ordering::Relaxed)
    }

    /// From now on instances must have the functions of `htex.motion/1`.
    pub(super) fn want_motion(&self) {
        self.follows_motion.store(true, Ordering::Relaxed);
    }

    /// Takes one of the places for voices; `None` when all are taken.
    pub(super) fn place(self: &Arc<Self>) -> Option<Place> {
        let most = self.limits.voices;
        let take = |n: usize| (n < most).then_some(n + 1);
        let taken = self
            .voices
            .fetch_update(Ordering::Relaxed, Ordering::Relaxed, take);
        taken.ok().map(|_| Place(Arc::clone(self)))
    }
}

/// The place of one voice, given back when it is dropped.
pub(super) struct Place(Arc<WasmModule>);

impl Drop for Place {
    fn drop(&mut self) {
        self.0.voices.fetch_sub(1, Ordering::Relaxed);
    }
}

/// A model imports nothing: whatever it asks for, it is refused.
fn check_imports(module: &Module) -> Result<(), String> {
    let Some(import) = module.imports().next() else {
        return Ok(());
    };
    Err(format!(
        "the module imports `{}.{}`; a model may import nothing (build it for \
         wasm32-unknown-unknown, without files, clocks and randomness)",
        import.module(),
        import.name()
    ))
}

fn check_memory(module: &Module) -> Result<(), String> {
    match module.get_export("memory") {
        Some(ExternType::Memory(_)) => Ok(()),
        _ => Err("the module exports no `memory`; it is no htex model".to_owned()),
    }
}
