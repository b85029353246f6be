//! From a module's bytes to machine code, within limits of time and memory.

use std::time::{Duration, Instant};

use wasmtime::{Engine, Module};

use super::cache::Cache;
use super::engine::engine;
use super::estimate::estimate;
use super::process;
use crate::sandbox::Sandbox;
use crate::{WasmCompiler, WasmLimits};

/// How much slower than the machine that the estimate was measured on one may be that still keeps the limit.
const SLOWER: f64 = 3.0;

/// What the compiler does for the speed of the code.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Effort {
    Optimised,
    /// As little as it can: its time is then nearly proportional to the module.
    Quick,
}

impl Effort {
    /// The most that the limit of time allows.
    fn within(limits: &WasmLimits, bytes: &[u8]) -> Result<Self, String> {
        let estimate = estimate(bytes)?;
        let time =
            |us: f64| Duration::try_from_secs_f64(SLOWER * us / 1e6).unwrap_or(Duration::MAX);
        let (optimised, quick) = (time(estimate.optimised_us), time(estimate.quick_us));
        match () {
            () if optimised <= limits.compile => Ok(Self::Optimised),
            () if quick <= limits.compile => Ok(Self::Quick),
            () => Err(format!(
                "the module may take {} ms to compile, and {} ms are allowed; it has too much code, or functions \
                 with too many variables and nested blocks",
                quick.as_millis(),
                limits.compile.as_millis()
            )),
        }
    }
}

/// The compiled module: from the cache, or compiled and kept there.
pub(super) fn compiled(bytes: &[u8], sandbox: &Sandbox) -> Result<Module, String> {
    let limits = &sandbox.limits;
    let cache = Cache::of(&limits.cache);
    let find = |engine: &Engine| cache.as_ref()?.find(engine, bytes);
    let optimised = engine(limits, Effort::Optimised)?;
    if let Some(module) = find(&optimised) {
        return Ok(module);
    }
    let effort = Effort::within(limits, bytes)?;
    let engine = match effort {
        Effort::Optimised => optimised,
        Effort::Quick => engine(limits, effort)?,
    };
    if effort == Effort::Quick
        && let Some(module) = find(&engine)
    {
        return Ok(module);
    }
    let time = limits.compile.min(sandbox.budget.time_left()?);
    let start = Instant::now();
    let compiled = compile(&engine, bytes, limits, effort, time);
    sandbox.budget.spend(start.elapsed());
    let module = compiled?;
    if let Some(cache) = cache
        && let Ok(artifact) = module.serialize()
    {
        // Without a cache everything works, only slower.
        let _ = cache.keep(&engine, bytes, &artifact);
    }
    Ok(module)
}

fn compile(
    engine: &Engine,
    bytes: &[u8],
    limits: &WasmLimits,
    effort: Effort,
    time: Duration,
) -> Result<Module, String> {
    match &limits.compiler {
        WasmCompiler::Here => here(engine, bytes),
        WasmCompiler::Program(program, arguments) => {
            let artifact = process::compile((program, arguments), bytes, limits, effort, time)?;
            // SAFETY: this program's own compiler has just made the artifact, and sent it through a pipe that
            // nobody else holds.
            unsafe { Module::deserialize(engine, artifact) }.map_err(|e| format!("{e:#}"))
        }
    }
}

pub(super) fn here(engine: &Engine, bytes: &[u8]) -> Result<Module, String> {
    Module::new(engine, bytes).map_err(|e| format!("no valid module: {e:#}"))
}
