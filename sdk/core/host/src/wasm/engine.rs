//! The engine that compiles and runs modules, and the clock that interrupts them.
//!
//! Time limits use wasmtime's epochs: a thread increments a counter (20 times per second with the
//! default limits), and wasmtime stops a call when the counter reaches the call's deadline.
//! Therefore, the time limit also stops endless loops. The engine can also count instructions
//! (`fuel`). A limit on instructions stops the same calls on every machine. With
//! [`WasmEngine::Signals`], a memory limit takes no time while a module runs, because the engine
//! reserves addresses and need not compare each access with a bound.

use std::sync::{Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

use wasmtime::{Config, Engine, EngineWeak, Module, OptLevel, RegallocAlgorithm};

use super::compile_error::CompileError;
use crate::{WasmEngine, WasmLimits};

/// Shortest and longest time between two increments of the epoch.
const TICK: (Duration, Duration) = (Duration::from_millis(1), Duration::from_millis(50));

/// The effort that the compiler makes to optimise.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Effort {
    Optimised,
    /// The least possible effort, so that compilation time is nearly proportional to the module's
    /// size.
    Quick,
}

/// The thread that increments an engine's epoch.
struct Clock {
    engine: EngineWeak,
    thread: JoinHandle<()>,
}

static CLOCKS: Mutex<Vec<Clock>> = Mutex::new(Vec::new());

/// Waits until the clock threads of engines without modules have ended, at most 50 ms for each
/// thread. If this code is in a plugin, the program must call this function before it unloads the
/// plugin.
pub fn end_wasm_clocks() {
    // The clocks are taken out of the list, so that the lock is free while threads end.
    let clocks = std::mem::take(&mut *CLOCKS.lock().unwrap_or_else(PoisonError::into_inner));
    let (live, ended): (Vec<Clock>, Vec<Clock>) =
        clocks.into_iter().partition(|clock| clock.engine.upgrade().is_some());
    for clock in ended {
        // The thread only counts, so it cannot have panicked.
        let _ = clock.thread.join();
    }
    let mut clocks = CLOCKS.lock().unwrap_or_else(PoisonError::into_inner);
    clocks.extend(live);
}

/// An engine with a thread that increments its epoch.
#[derive(Clone)]
pub(super) struct ClockedEngine {
    pub(super) engine: Engine,
    tick: Duration,
}

impl ClockedEngine {
    /// Starts an engine's clock.
    pub(super) fn start(engine: Engine, limits: &WasmLimits) -> Result<Self, CompileError> {
        let shortest = limits.call.min(limits.render);
        let tick = (shortest / 8).clamp(TICK.0, TICK.1);
        let clock = engine.weak();
        // The thread ends within a tick after the last module of this engine is dropped.
        let counting = move || {
            while let Some(engine) = clock.upgrade() {
                engine.increment_epoch();
                // If this reference were kept during the sleep, it would keep an unused engine
                // alive.
                drop(engine);
                std::thread::sleep(tick);
            }
        };
        let thread = std::thread::Builder::new()
            .name("htex-wasm-clock".to_owned())
            .spawn(counting)
            .map_err(|error| CompileError::Clock { what: error.to_string() })?;
        let mut clocks = CLOCKS.lock().unwrap_or_else(PoisonError::into_inner);
        clocks.retain(|clock| !clock.thread.is_finished());
        clocks.push(Clock { engine: engine.weak(), thread });
        Ok(Self { engine, tick })
    }

    /// Converts a time to a number of epochs. Rounds up and adds one, because the first increment
    /// may come immediately.
    pub(super) fn ticks(&self, time: Duration) -> u64 {
        let ticks = time.as_nanos().div_ceil(self.tick.as_nanos().max(1));
        u64::try_from(ticks).unwrap_or(u64::MAX / 2).saturating_add(1)
    }
}

/// Returns an engine without a clock. A clock is only needed to run modules.
pub(super) fn engine(limits: &WasmLimits, effort: Effort) -> Result<Engine, CompileError> {
    let mut config = Config::new();
    if effort == Effort::Quick {
        config
            .cranelift_opt_level(OptLevel::None)
            .cranelift_regalloc_algorithm(RegallocAlgorithm::SinglePass);
    }
    config
        .epoch_interruption(true)
        .consume_fuel(limits.fuel.is_some())
        .max_wasm_stack(limits.stack_bytes)
        .signals_based_traps(limits.engine == WasmEngine::Signals)
        // Relaxed SIMD operations have different results on different machines. The host's code
        // supports only one 32-bit memory.
        .wasm_relaxed_simd(false)
        .wasm_memory64(false)
        .wasm_multi_memory(false);
    Ok(Engine::new(&config)?)
}

/// Compiles a module in this process.
pub(super) fn here(engine: &Engine, bytes: &[u8]) -> Result<Module, CompileError> {
    Module::new(engine, bytes).map_err(|error| CompileError::Invalid { what: format!("{error:#}") })
}
