//! A model has the same samples when built in, as a native library, and as a WASM module.

use std::path::{Path, PathBuf};
use std::time::Instant;

use htex_host::{
    Band, FitCondition, FitInput, LoadedModel, Origin, Registry, WasmCache, WasmLimits,
};
use xtask::plugins;

const RATE_HZ: f64 = 20_000.0;
const SEED: u64 = 7;

fn native(folder: &Path, name: &str) -> PathBuf {
    use std::env::consts::{DLL_PREFIX, DLL_SUFFIX};
    folder.join(format!("{DLL_PREFIX}htex_{name}{DLL_SUFFIX}"))
}

fn wasm(folder: &Path, name: &str) -> PathBuf {
    folder.join(format!("htex_{name}.wasm"))
}

fn uncached() -> WasmLimits {
    WasmLimits::default().with_cache(WasmCache::Off)
}

fn fitted(model: &LoadedModel) -> Vec<f64> {
    let grid = Band::TACTILE.grid_hz();
    let request = FitInput {
        band: Band::TACTILE,
        frequency_hz: &grid,
        magnitude: &smooth_spectrum(&grid),
        signal: &[],
        signal_rate_hz: RATE_HZ,
        options: &model.options(&[]).unwrap(),
        condition: FitCondition::default(),
    };
    model.fit(&request).unwrap().parameters
}

/// A smooth spectrum with two bumps.
fn smooth_spectrum(frequency_hz: &[f64]) -> Vec<f64> {
    let curve = |f: f64| {
        0.01 * (-(f / 150.0).ln().powi(2)).exp() + 0.002 * (-((f - 600.0) / 120.0).powi(2)).exp()
    };
    frequency_hz.iter().map(|&f| curve(f)).collect()
}

/// Renders one second of a voice in blocks of several sizes, with a retune in the middle.
fn rendered(model: &LoadedModel, parameters: &[f64]) -> Vec<f32> {
    let rate_hz = model.voice_rate_hz(parameters, Band::TACTILE, RATE_HZ).unwrap();
    let mut voice = model.voice(parameters, Band::TACTILE, rate_hz, SEED).unwrap();
    let mut out = vec![0.0f32; 20_000];
    for (i, block) in out.chunks_mut(997).enumerate() {
        if i == 10 {
            voice.retune(parameters).unwrap();
        }
        voice.render(block).unwrap();
    }
    out
}

/// Returns the largest difference, relative to the largest sample.
fn difference(a: &[f32], b: &[f32]) -> f64 {
    let full = a.iter().fold(0.0f32, |m, x| m.max(x.abs()));
    let largest = a.iter().zip(b).fold(0.0f32, |m, (x, y)| m.max((x - y).abs()));
    f64::from(largest / full)
}

#[test]
fn the_same_samples_three_ways() {
    let registry = Registry::builtin();
    let native_folder = plugins::native().unwrap();
    let wasm_folder = plugins::wasm_if_there();
    for name in Registry::builtin_names() {
        let builtin = registry.find(name).unwrap();
        let mut others = vec![LoadedModel::from_file(&native(&native_folder, name)).unwrap()];
        if let Some(folder) = &wasm_folder {
            let path = wasm(folder, name);
            others.push(LoadedModel::from_file_within(&path, &uncached()).unwrap());
        }
        let parameters = fitted(builtin);
        let expected = rendered(builtin, &parameters);
        for other in others {
            assert_eq!(other.descriptor(), builtin.descriptor());
            let got = rendered(&other, &parameters);
            let kind = match other.origin() {
                Origin::Wasm(_) => "wasm",
                _ => "native",
            };
            let difference = difference(&expected, &got);
            println!("{name:8} built in and {kind:6}: differ by {difference:e} of full scale");
            assert!(difference <= 0.0, "{name} {kind}");
            let refitted = fitted(&other);
            let near = |(a, b): (&f64, &f64)| (a - b).abs() <= 1e-9 * a.abs().max(1e-6);
            assert!(parameters.iter().zip(&refitted).all(near), "{name} {kind}: fit");
        }
    }
}

/// Prints the time per sample for each kind of loading and the time to the first samples, and
/// compares them with the bounds for rendering in real time.
#[test]
fn what_each_way_costs() {
    let Some(folder) = plugins::wasm_if_there() else {
        return;
    };
    let native_folder = plugins::native().unwrap();
    let registry = Registry::builtin();
    println!("ns a sample at blocks of 64 / 256, and us a call of 64");
    for name in Registry::builtin_names() {
        let builtin = registry.find(name).unwrap().clone();
        let parameters = fitted(&builtin);
        let fuel = uncached().with_fuel(u64::MAX / 2);
        let native = LoadedModel::from_file(&native(&native_folder, name)).unwrap();
        let module = wasm(&folder, name);
        let within = |limits| LoadedModel::from_file_within(&module, limits).unwrap();
        let ways = [
            ("built in", builtin),
            ("native", native),
            ("wasm", within(&uncached())),
            ("wasm, fuel", within(&fuel)),
        ];
        for (way, model) in ways {
            let [small, large] = [64, 256].map(|block| ns_a_sample(&model, &parameters, block));
            let call_us = small * 64.0 / 1000.0;
            println!("{name:8} {way:10} {small:8.1} {large:8.1} {call_us:8.2}");
            // A sample at the device's rate lasts 50,000 ns.
            assert!(large < 25_000.0, "{name} {way}: {large} ns a sample");
        }
        first_sample(name, &module, &parameters);
    }
}

/// Returns the minimum over many blocks, which excludes other load of the machine.
fn ns_a_sample(model: &LoadedModel, parameters: &[f64], block: usize) -> f64 {
    let rate_hz = model.voice_rate_hz(parameters, Band::TACTILE, RATE_HZ).unwrap();
    let mut voice = model.voice(parameters, Band::TACTILE, rate_hz, SEED).unwrap();
    let mut out = vec![0.0f32; block];
    // A frame of noise is computed once for several blocks, so the test compares means of 64
    // blocks.
    let mean = |_| {
        let start = Instant::now();
        (0..64).for_each(|_| voice.render(&mut out).unwrap());
        start.elapsed().as_secs_f64() * 1e9 / (64 * block) as f64
    };
    (0..8).map(mean).fold(f64::INFINITY, f64::min)
}

/// Measures the time from the file to the first block, with compilation and with the cache.
fn first_sample(name: &str, module: &Path, parameters: &[f64]) {
    let folder = tempfile::tempdir().unwrap();
    let limits = WasmLimits::default().with_cache(WasmCache::Dir(folder.path().join("wasm")));
    let time = || {
        let start = Instant::now();
        let model = LoadedModel::from_file_within(module, &limits).unwrap();
        rendered(&model, parameters);
        start.elapsed().as_secs_f64() * 1e3
    };
    let (cold, warm) = (time(), time());
    println!("{name:8} first second of samples: {cold:.1} ms cold, {warm:.1} ms warm");
}
