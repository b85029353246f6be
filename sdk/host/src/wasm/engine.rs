//! The engine that compiles and runs modules, and the clock that interrupts them.

use std::time::Duration;

use wasmtime::{Config, Engine, OptLevel, RegallocAlgorithm};

use super::compile::Effort;
use crate::WasmLimits;

/// Shortest and longest time between two ticks.
const TICK: (Duration, Duration) = (Duration::from_millis(1), Duration::from_millis(50));

/// An engine whose epoch counts on as long as it lives.
#[derive(Clone)]
pub(super) struct WasmEngine {
    pub(super) engine: Engine,
    tick: Duration,
}

impl WasmEngine {
    /// Starts an engine's clock.
    pub(super) fn start(engine: Engine, limits: &WasmLimits) -> Result<Self, String> {
        let shortest = limits.call.min(limits.render);
        let tick = (shortest / 8).clamp(TICK.0, TICK.1);
        let clock = engine.weak();
        // Ends within a tick after the last module of this engine is gone.
        let counting = move || {
            while let Some(engine) = clock.upgrade() {
                engine.increment_epoch();
                drop(engine);
                std::thread::sleep(tick);
            }
        };
        std::thread::Builder::new()
            .name("htex-wasm-clock".to_owned())
            .spawn(counting)
            .map_err(|e| format!("cannot start the clock that interrupts modules: {e}"))?;
        Ok(Self { engine, tick })
    }

    /// A time in ticks, rounded up, and one more since the next tick may come at once.
    pub(super) fn ticks(&self, time: Duration) -> u64 {
        let ticks = time.as_nanos().div_ceil(self.tick.as_nanos().max(1));
        u64::try_from(ticks)
            .unwrap_or(u64::MAX / 2)
            .saturating_add(1)
    }
}

/// An engine without a clock, which is enough to compile.
pub(super) fn engine(limits: &WasmLimits, effort: Effort) -> Result<Engine, String> {
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
        // Answers that differ between machines, and memories that the calls here do not know of.
        .wasm_relaxed_simd(false)
        .wasm_memory64(false)
        .wasm_multi_memory(false);
    Engine::new(&config).map_err(|e| format!("{e:#}"))
}
