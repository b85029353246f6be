//! Measures the time to the first sample of a WASM module.

use std::path::Path;
use std::time::Instant;

use htex_host::{Band, HostError, LoadedModel, Origin, WasmCache, WasmLimits};
use serde::Serialize;

use crate::harness::Finding;
use crate::model::case::RATE_HZ;

/// Numbers of measurements, first without and then with a cached module. The minimum of each
/// counts.
const COLD: usize = 3;
const WARM: usize = 10;

/// Times from opening a module's file to its first sample, milliseconds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Start {
    /// Time if the module must be compiled.
    pub cold_ms: f64,
    /// Time if the compiled module is in the cache.
    pub warm_ms: f64,
}

/// Measures a WASM module with a new cache folder. Returns `None` for a model that is not a WASM
/// module in a file.
pub(crate) fn start(model: &LoadedModel, parameters: &[f64]) -> Result<Option<Start>, Finding> {
    let Origin::Wasm(file) = model.origin() else {
        return Ok(None);
    };
    let mut best = Start { cold_ms: f64::INFINITY, warm_ms: f64::INFINITY };
    for _ in 0..COLD {
        let folder = tempfile::tempdir()
            .map_err(|e| Finding::failed(format!("cannot create a cache folder: {e}")))?;
        let limits = WasmLimits::default().with_cache(WasmCache::Dir(folder.path().join("wasm")));
        best.cold_ms = best.cold_ms.min(first_sample_ms(file, &limits, parameters)?);
        for _ in 0..WARM {
            best.warm_ms = best.warm_ms.min(first_sample_ms(file, &limits, parameters)?);
        }
    }
    Ok(Some(best))
}

fn first_sample_ms(file: &Path, limits: &WasmLimits, parameters: &[f64]) -> Result<f64, HostError> {
    let begun = Instant::now();
    let model = LoadedModel::from_file_within(file, limits)?;
    let rate_hz = model.voice_rate_hz(parameters, Band::TACTILE, RATE_HZ)?;
    let mut voice = model.voice(parameters, Band::TACTILE, rate_hz, 1)?;
    voice.render(&mut [0.0])?;
    Ok(begun.elapsed().as_secs_f64() * 1e3)
}
