//! Third-party models: the examples and the templates are built, loaded, fitted and played.

use crate::common::builds;

use std::fs;
use std::path::PathBuf;
use std::process::Command;

use builds::*;
use htex_check::templates;
use htex_host::{
    Band, Fit, FitCondition, FitInput, HostError, LoadedModel, Motion, Status, Stream,
};
use htex_tests::measure::{RATE_HZ, distance_db, measured_spectrum, rms};
use htex_tests::{deflated_bytes, smooth_spectrum, workspace};
use xtask::needs;

/// Largest deflated size of the template's module, bytes: the measured size plus a few percent for
/// other compilers.
const TEMPLATE_BYTES: usize = 23_500;

#[test]
fn the_example_in_c() {
    let project = bursts_project();
    let model = load(&build_c(&project, "native"));
    assert_eq!(model.id(), "org.example.bursts");
    holds(&model, 0.03);
    the_rhythm_is_found(&model);
    if has_clang() {
        is_the_same(&model, &load(&build_c(&project, "wasm")));
    }
}

#[test]
fn the_template_in_c() {
    let project = written(&templates::MODEL_C, "template-c");
    let model = load(&build_c(&project, "native"));
    assert_eq!(model.id(), "org.example.trial");
    holds(&model, 0.03);
    if has_clang() {
        is_the_same(&model, &load(&build_c(&project, "wasm")));
    }
    assert!(!model.follows_motion());
    let build = project.join("build.sh");
    let text = fs::read_to_string(&build).unwrap();
    fs::write(
        &build,
        text.replace("trial.", "moved.").replace("-std=c11", "-std=c11 -DFOLLOWS_MOTION=1"),
    )
    .unwrap();
    follows_the_speed(&load(&build_c(&project, "native")));
    if has_clang() {
        follows_the_speed(&load(&build_c(&project, "wasm")));
    }
}

/// The templates in C and in Zig are the same model, with the same samples.
#[test]
fn the_template_in_zig() {
    if !needs::ZIG.met(needs::zig().is_some()) {
        return;
    }
    let model = load(&build_c(&written(&templates::MODEL_ZIG, "template-zig"), "native"));
    let in_c = load(&build_c(&written(&templates::MODEL_C, "template-c-zig"), "native"));
    is_the_same(&in_c, &model);
    let module = build_c(&folder("template-zig"), "wasm");
    is_the_same(&in_c, &load(&module));
    let bytes = deflated_bytes(&fs::read(&module).unwrap());
    println!("{:20} {bytes} bytes deflated, in Zig", model.id());
}

/// A model or a device may be written in C++: every header compiles without warnings, and the test
/// uses its functions.
#[test]
fn the_headers_compile_as_cpp() {
    let there = Command::new("c++").arg("--version").output().is_ok();
    if !needs::CXX.met(there) {
        return;
    }
    let project = folder("headers-cpp");
    let include = workspace().join("spec/include");
    let mut text = String::new();
    for header in fs::read_dir(&include).unwrap() {
        let name = header.unwrap().file_name();
        text += &format!("#include \"{}\"\n", name.to_str().unwrap());
    }
    text += "int main() {
        const double numerator[3] = {1.0, 0.0, 0.0};
        struct biquad f = section(100.0, 0.7, 20000.0, numerator);
        uint64_t state = 1;
        double y = tick(&f, noise(&state));
        uint8_t text[4];
        bool all = copy_text(last_error, text, 4) == 0 && check_band(20, 1000) == HTEX_OK && clamp(y, -1, 1) == y;
        all = all && check_spectrum(nullptr, nullptr, 0) != HTEX_OK && check_signal(nullptr, 0, 0) == HTEX_OK;
        return all ? 0 : 1;
    }\n";
    let (source, program) = (project.join("all.cpp"), project.join("all"));
    fs::write(&source, text).unwrap();
    for standard in ["c++11", "c++14", "c++17", "c++20"] {
        let mut compiler = Command::new("c++");
        compiler.args(["-Wall", "-Wextra", "-pedantic", "-Werror", "-I"]);
        compiler.arg(&include).arg(format!("-std={standard}"));
        let compiled = compiler.arg("-o").arg(&program).arg(&source).output().unwrap();
        assert!(
            compiled.status.success(),
            "{standard}: {}",
            String::from_utf8_lossy(&compiled.stderr)
        );
        assert!(Command::new(&program).status().unwrap().success(), "{standard}");
    }
}

#[test]
fn the_example_in_rust() {
    let project = texel_project();
    let model = load(&build_rust(&project, None));
    assert_eq!(model.id(), "org.example.texel");
    holds(&model, 0.02);
    the_pitch_is_found(&model);
    if has_wasm_target() {
        is_the_same(&model, &load(&build_rust(&project, Some(WASM))));
    }
}

#[test]
fn the_template_in_rust() {
    let project = written(&templates::MODEL_RUST, "template-rust");
    // Uses the versions in the lock file.
    fs::copy(workspace().join("Cargo.lock"), project.join("Cargo.lock")).unwrap();
    let model = load(&build_rust(&project, None));
    assert_eq!(model.id(), "org.example.trial");
    holds(&model, 0.02);
    if has_wasm_target() {
        let module = build_rust(&project, Some(WASM));
        is_the_same(&model, &load(&module));
        let bytes = deflated_bytes(&fs::read(&module).unwrap());
        println!("{:20} {bytes} bytes deflated", model.id());
        assert!(bytes < TEMPLATE_BYTES, "the template's module: {bytes} bytes");
    }
    assert!(!model.follows_motion());
    let manifest = fs::read_to_string(project.join("Cargo.toml")).unwrap();
    let moved = manifest
        .replace("\"trial\"", "\"moved\"")
        .replace("default = [\"plugin\"]", "default = [\"plugin\", \"motion\"]");
    fs::write(project.join("Cargo.toml"), moved).unwrap();
    follows_the_speed(&load(&build_rust(&project, None)));
    if has_wasm_target() {
        follows_the_speed(&load(&build_rust(&project, Some(WASM))));
    }
}

/// Twice the speed gives twice the level. Without a motion it plays as at 100 mm/s.
fn follows_the_speed(model: &LoadedModel) {
    assert!(model.follows_motion());
    holds(model, 0.03);
    let p = fit(model, &spectra()[0].1, &[]).unwrap().parameters;
    let rate_hz = model.voice_rate_hz(&p, Band::TACTILE, RATE_HZ).unwrap();
    let played = |speed_mm_s: Option<f64>| {
        let mut voice = model.voice(&p, Band::TACTILE, rate_hz, 1).unwrap();
        if let Some(speed_mm_s) = speed_mm_s {
            let (force_n, position_mm) = (0.4, 0.0);
            voice
                .set_motion(Motion { speed_mm_s, force_n, position_mm, x_mm: 0.0, y_mm: 0.0 })
                .unwrap();
        }
        let mut out = vec![0.0; 20_000];
        voice.render(&mut out).unwrap();
        rms(&out[1_000..])
    };
    let still = played(None);
    for (speed_mm_s, gain) in [(-100.0, 1.0), (200.0, 2.0), (0.0, 0.0)] {
        let found = played(Some(speed_mm_s)) / still;
        assert!((found - gain).abs() < 1e-3, "{speed_mm_s} mm/s: {found}");
    }
}

// ---- what each must do ----

/// Five kinds of spectra on the grid of the tactile band, newtons.
fn spectra() -> [(&'static str, Vec<f64>); 5] {
    let grid = Band::TACTILE.grid_hz();
    let curve = |f: &dyn Fn(f64) -> f64| grid.iter().map(|&hz| f(hz)).collect();
    let smooth = smooth_spectrum(&grid);
    let ripple = |(i, m): (usize, &f64)| m * (1.0 + 0.3 * (i as f64 * 0.9).sin());
    [
        ("rippled", smooth.iter().enumerate().map(ripple).collect()),
        ("smooth", smooth),
        ("falling", curve(&|f| (-f / 90.0).exp() * (1.2 + (f / 25.0).sin()))),
        ("resonant", curve(&|f| 0.02 / (1.0 + ((f - 300.0) / 30.0).powi(2)))),
        ("comb", comb_spectrum(&grid)),
    ]
}

/// Lines at the multiples of 65 Hz, as a Hann window shows them.
fn comb_spectrum(grid: &[f64]) -> Vec<f64> {
    let line = |f: f64| match (f % 65.0).min(65.0 - f % 65.0) {
        d if d < 1.0 => 1.0,
        d if d < 6.0 => 0.5,
        _ => 1e-3,
    };
    grid.iter().map(|&f| 0.01 * line(f) * (-f / 300.0).exp()).collect()
}

/// The requirements for a model: its voice has its magnitude and level, depends on its seed but not
/// on the block size, and changes without a click. It refuses empty spectra and wrong parameters.
fn holds(model: &LoadedModel, level_tolerance: f64) {
    for (name, magnitude) in spectra() {
        let fit = fit(model, &magnitude, &[]).unwrap();
        let p = &fit.parameters;
        let reference = model.magnitude(p, Band::TACTILE, &Band::TACTILE.grid_hz()).unwrap();
        let unit = htex_dsp::grid::level_rms(&reference);
        let samples = rendered(model, p, 11, 4_096, 60.0);
        let (rms, db) = (rms(&samples), distance_db(&measured_spectrum(&samples), &reference));
        let id = model.id();
        println!("{id:20} {name:9} unit {unit:.5}  RMS {rms:.4}  voice within {db:.3} dB RMS");
        assert!((unit - 1.0).abs() < 1e-3, "{id} {name}: unit RMS is {unit}");
        assert!((rms - 1.0).abs() < level_tolerance, "{id} {name}: RMS {rms}");
        assert!(db < 1.0, "{id} {name}: {db} dB");
    }
    samples_follow_the_seed_alone(model);
    retunes_do_not_click(model);
    edges_are_answered(model);
}

fn samples_follow_the_seed_alone(model: &LoadedModel) {
    let p = fit(model, &spectra()[0].1, &[]).unwrap().parameters;
    let whole = rendered(model, &p, 5, usize::MAX, 0.3);
    for block in [1, 7, 64] {
        assert_eq!(rendered(model, &p, 5, block, 0.3), whole, "{} in {block}", model.id());
    }
    assert_ne!(rendered(model, &p, 6, 64, 0.3), whole, "{}", model.id());
    let subnormal = |x: &f32| x.is_subnormal() || !x.is_finite();
    assert!(!whole.iter().any(subnormal), "{}", model.id());
}

fn retunes_do_not_click(model: &LoadedModel) {
    let all = spectra();
    let [a, b] = [&all[0].1, &all[2].1].map(|m| fit(model, m, &[]).unwrap().parameters);
    let half = model.interpolate(&[&a, &b], &[0.5, 0.5]).unwrap();
    assert_eq!(model.interpolate(&[&a, &b], &[0.0, 1.0]).unwrap(), b);
    let mut stream = Stream::new(model, &a, Band::TACTILE, RATE_HZ, 3).unwrap();
    let mut out = vec![0.0f32; 40_000];
    for (i, block) in out.chunks_mut(500).enumerate() {
        stream.retune([&a, &half, &b][i % 3]).unwrap();
        stream.render(block).unwrap();
    }
    let bend = |x: &[f32]| (x[2] - 2.0 * x[1] + x[0]).abs();
    let sharpest = |x: &[f32]| x.windows(3).map(bend).fold(0.0, f32::max);
    let steady = [&a, &half, &b].map(|p| sharpest(&rendered(model, p, 3, 500, 2.0)));
    let bound = 2.0 * steady.into_iter().fold(0.0, f32::max);
    assert!(sharpest(&out) < bound, "{}: {} {bound}", model.id(), sharpest(&out));
}

fn edges_are_answered(model: &LoadedModel) {
    let grid = Band::TACTILE.grid_hz();
    let at = |hz: &[f64]| -> Vec<f64> {
        grid.iter().map(|f| f64::from(u8::from(hz.contains(f)))).collect()
    };
    let hard = [vec![0.0; grid.len()], vec![1.0; grid.len()], at(&[20.0]), at(&[400.0, 405.0])];
    for magnitude in hard {
        match fit(model, &magnitude, &[]) {
            Ok(fit) => {
                assert!(rendered(model, &fit.parameters, 1, 64, 0.1).iter().all(|x| x.is_finite()))
            }
            Err(error) => assert_eq!(status(&error), Status::CannotFit, "{error}"),
        }
    }
    let good = fit(model, &spectra()[1].1, &[]).unwrap().parameters;
    let mut wrong = vec![vec![], good[1..].to_vec(), [&good[..], &[1.0]].concat()];
    for i in 0..good.len() {
        for value in [f64::NAN, f64::INFINITY, -1e9, 1e9] {
            wrong.push(good.clone());
            wrong.last_mut().unwrap()[i] = value;
        }
    }
    let mut stream = Stream::new(model, &good, Band::TACTILE, RATE_HZ, 3).unwrap();
    for p in wrong {
        let error = model.magnitude(&p, Band::TACTILE, &grid).unwrap_err();
        assert_eq!(status(&error), Status::InvalidParameters, "{p:?}: {error}");
        assert_eq!(status(&stream.retune(&p).unwrap_err()), Status::InvalidParameters);
        assert!(Stream::new(model, &p, Band::TACTILE, RATE_HZ, 3).is_err());
    }
}

/// The model finds bursts that it played itself in the signal.
fn the_rhythm_is_found(model: &LoadedModel) {
    let played = [150.0, 100.0, 0.1, 0.3, 0.0, 100.0, 0.0];
    let grid = Band::TACTILE.grid_hz();
    let magnitude = model.magnitude(&played, Band::TACTILE, &grid).unwrap();
    let signal = rendered(model, &played, 4, 512, 4.0);
    let signal: Vec<f64> = signal.into_iter().map(f64::from).collect();
    let found = fit(model, &magnitude, &signal).unwrap().parameters;
    println!("{:20} played {played:?}, found {found:.2?}", model.id());
    assert!((found[0] - 150.0).abs() < 1.0 && (found[1] - 100.0).abs() < 2.0);
    assert!((found[2] - 0.1).abs() < 0.003 && (found[3] - 0.3).abs() < 0.1);
}

/// The model finds the fundamental of a comb, not half or twice that frequency.
fn the_pitch_is_found(model: &LoadedModel) {
    let comb = comb_spectrum(&Band::TACTILE.grid_hz());
    let found = fit(model, &comb, &[]).unwrap().parameters;
    println!("{:20} 65 Hz: found {:.3} Hz", model.id(), found[1] / found[0]);
    assert!((found[1] / found[0] - 65.0).abs() < 0.1);
}

/// A WASM module, or a library from another language, fits and plays bit for bit like the library.
fn is_the_same(native: &LoadedModel, wasm: &LoadedModel) {
    for (name, magnitude) in spectra() {
        let [a, b] = [native, wasm].map(|model| fit(model, &magnitude, &[]).unwrap());
        assert_eq!(a, b, "{} {name}", native.id());
        let [x, y] = [native, wasm].map(|model| rendered(model, &a.parameters, 9, 333, 1.0));
        assert_eq!(x, y, "{} {name}", native.id());
    }
    edges_are_answered(wasm);
    println!("{:20} the same samples", native.id());
}

// ---- ways and means ----

fn fit(model: &LoadedModel, magnitude: &[f64], signal: &[f64]) -> Result<Fit, HostError> {
    model.fit(&FitInput {
        band: Band::TACTILE,
        frequency_hz: &Band::TACTILE.grid_hz(),
        magnitude,
        signal,
        signal_rate_hz: RATE_HZ,
        options: &model.options(&[]).unwrap(),
        condition: FitCondition::default(),
    })
}

fn rendered(model: &LoadedModel, p: &[f64], seed: u64, block: usize, seconds: f64) -> Vec<f32> {
    let mut stream = Stream::new(model, p, Band::TACTILE, RATE_HZ, seed).unwrap();
    let mut out = vec![0.0f32; (seconds * RATE_HZ) as usize];
    let block = block.min(out.len());
    out.chunks_mut(block).for_each(|part| stream.render(part).unwrap());
    out
}

fn status(error: &HostError) -> Status {
    match error {
        HostError::Call { status, .. } => *status,
        other => panic!("{other}"),
    }
}

/// Writes the project of a template to a folder that stays between runs.
fn written(template: &templates::Template, name: &str) -> PathBuf {
    let project = folder(name);
    let sources = workspace().canonicalize().unwrap();
    for (file, text) in template.files("trial", Some(sources.to_str().unwrap())) {
        let file = project.join(file);
        fs::create_dir_all(file.parent().unwrap()).unwrap();
        fs::write(file, text).unwrap();
    }
    project
}
