//! WASM modules used as models.

use std::time::Duration;

use htex_host::{
    Band, FitCondition, FitInput, HostError, LoadedModel, Stream, WasmCache, WasmLimits,
};

use crate::body::{Bytes, body, signature};
use crate::promise::{finite, sentence};

#[path = "../../../sdk/core/host/tests/it/common/mod.rs"]
pub(crate) mod model;

/// Tight limits on time and memory.
pub(crate) fn limits() -> WasmLimits {
    WasmLimits::default()
        .with_memory_bytes(2 << 20)
        .with_table_elements(100)
        .with_stack_bytes(64 << 10)
        .with_voices(2)
        .with_call(Duration::from_millis(500))
        .with_render(Duration::from_millis(500))
        .with_fuel(100_000)
        .with_cache(WasmCache::Off)
}

/// Loads a module and makes every call. Input that does not start like a module describes bodies
/// for the functions of a valid model.
pub fn wasm_module(input: &[u8]) -> bool {
    let written;
    let bytes = if input.starts_with(b"\0asm") {
        input
    } else {
        written = of_bodies(input);
        &written
    };
    match LoadedModel::from_wasm_bytes("fuzzed.wasm", bytes, &limits()) {
        Ok(model) => {
            use_all(&model);
            true
        }
        Err(error) => refused(&error),
    }
}

/// Makes a module. For each function, a byte chooses whether its body is generated from the
/// following bytes.
fn of_bodies(input: &[u8]) -> Vec<u8> {
    let mut bytes = Bytes(input);
    let mut bodies = Vec::new();
    for (name, text, _) in model::FUNCTIONS {
        if bytes.next() % 4 == 1 {
            let (parameters, result) = signature(text);
            bodies.push((*name, body(&mut bytes, &parameters, result)));
        }
    }
    let changed: Vec<(&str, &str)> = bodies.iter().map(|(n, b)| (*n, b.as_str())).collect();
    let text = model::text("1.0.0", &changed, "");
    wat::parse_str(&text).unwrap_or_else(|e| panic!("the maker of bodies is wrong: {e}\n{text}"))
}

fn refused(error: &HostError) -> bool {
    sentence(error);
    false
}

/// Makes every call that a host makes to a model.
fn use_all(model: &LoadedModel) {
    let band = Band::TACTILE;
    let (grid, ones) = (band.grid_hz(), vec![1.0; band.bins()]);
    let request = FitInput {
        band,
        frequency_hz: &grid,
        magnitude: &ones,
        signal: &ones,
        signal_rate_hz: 4000.0,
        options: &model.descriptor().default_options(),
        condition: FitCondition::default(),
    };
    let parameters = match model.fit(&request) {
        Ok(fit) => {
            finite("level", [fit.level_rms]);
            fit.parameters
        }
        Err(error) => {
            refused(&error);
            vec![0.5]
        }
    };
    finite("parameter", parameters.iter().copied());
    match model.magnitude(&parameters, band, &grid) {
        Ok(magnitude) => finite("magnitude", magnitude),
        Err(error) => drop(refused(&error)),
    }
    match model.interpolate(&[&parameters, &parameters], &[0.5, 0.5]) {
        Ok(mixed) => finite("mixed", mixed),
        Err(error) => drop(refused(&error)),
    }
    if let Err(error) = model.has_extension("htex.none/1") {
        refused(&error);
    }
    match Stream::new(model, &parameters, band, 8000.0, 1) {
        Ok(stream) => listen(stream, &parameters),
        Err(error) => drop(refused(&error)),
    }
}

fn listen(mut stream: Stream, parameters: &[f64]) {
    let mut block = [f32::NAN; 64];
    for _ in 0..2 {
        if let Err(error) = stream.render(&mut block) {
            refused(&error);
        }
        finite("sample", block.map(f64::from));
        if let Err(error) = stream.retune(parameters) {
            refused(&error);
        }
    }
}
