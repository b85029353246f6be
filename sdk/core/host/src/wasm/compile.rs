//! Compiles a module's bytes to machine code, within limits of time and memory.

use std::time::{Duration, Instant};

use wasmtime::{Engine, Module};

use super::cache::Cache;
use super::compile_error::CompileError;
use super::engine::{Effort, engine, here};
use super::estimate::estimate;
use super::process;
use crate::sandbox::Sandbox;
use crate::{WasmCompiler, WasmLimits};

/// A machine may be slower by this factor than the machine on which the estimate was measured. The
/// time limit then still holds.
const SLOWER: f64 = 3.0;

/// Returns the highest effort that the time limit allows.
fn effort_within(limits: &WasmLimits, bytes: &[u8]) -> Result<Effort, CompileError> {
    let estimate = estimate(bytes)?;
    let time = |us: f64| Duration::try_from_secs_f64(SLOWER * us / 1e6).unwrap_or(Duration::MAX);
    let (optimised, quick) = (time(estimate.optimised_us), time(estimate.quick_us));
    if optimised <= limits.compile {
        Ok(Effort::Optimised)
    } else if quick <= limits.compile {
        Ok(Effort::Quick)
    } else {
        Err(CompileError::TooSlow { ms: quick.as_millis(), allowed_ms: limits.compile.as_millis() })
    }
}

/// Returns the compiled module from the cache, or compiles and caches it.
pub(super) fn compiled(bytes: &[u8], sandbox: &Sandbox) -> Result<Module, CompileError> {
    let limits = &sandbox.limits;
    let cache = Cache::open(&limits.cache);
    let find = |engine: &Engine| cache.as_ref()?.find(engine, bytes);
    let optimised = engine(limits, Effort::Optimised)?;
    // The cache is searched before the time is estimated, because a module that is in the cache
    // needs no time to compile, whatever the estimate is.
    if let Some(module) = find(&optimised) {
        return Ok(module);
    }
    let effort = effort_within(limits, bytes)?;
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
    // The result is checked only after the time was subtracted, so that modules that cannot be
    // compiled also use up the budget.
    let module = compiled?;
    if let Some(cache) = cache
        && let Ok(artifact) = module.serialize()
    {
        // An error is ignored. The module is then compiled again next time.
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
) -> Result<Module, CompileError> {
    match &limits.compiler {
        WasmCompiler::Here => here(engine, bytes),
        WasmCompiler::Program(program, arguments) => {
            let artifact = process::compile((program, arguments), bytes, limits, effort, time)?;
            // SAFETY: the compiler that the caller named has just written the artifact to a pipe.
            // No other process has this pipe open.
            Ok(unsafe { Module::deserialize(engine, artifact) }?)
        }
    }
}
