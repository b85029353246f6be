//! Models from files, on the command line.

use std::path::Path;
use std::process::{Command, Output};

fn htex(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_htex"));
    command.args(arguments).env_remove("HTEX_PLUGIN_PATH").output().unwrap()
}

fn text(output: &Output) -> String {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// A new model in C, built.
fn resonance(folder: &Path) -> String {
    let dir = folder.join("resonance");
    let dir = dir.to_str().unwrap();
    text(&htex(&["plugin", "new", "resonance", "--lang", "c", "--dir", dir]));
    let built = Command::new("sh").arg(format!("{dir}/build.sh")).status();
    assert!(built.unwrap().success());
    format!("{dir}/resonance{}", std::env::consts::DLL_SUFFIX)
}

#[test]
fn a_plugin_is_fitted_shown_and_played() {
    let folder = tempfile::tempdir().unwrap();
    let plugin = resonance(folder.path());
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let (recording, asset, wav) = (at("noise.csv"), at("noise.htex"), at("noise.wav"));
    let mut state = 1u32;
    let rows = (0..20_000).map(|i| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let force = f64::from(state >> 8) / f64::from(1 << 24) - 0.5;
        format!("{},{force}\n", f64::from(i) / 10_000.0)
    });
    let csv = "time_s,lateral_n\n".to_owned() + &rows.collect::<String>();
    std::fs::write(&recording, csv).unwrap();

    let with = |arguments: &[&str]| htex(&[arguments, &["--plugin", &plugin]].concat());
    text(&with(&["fit", &recording, "-o", &asset, "--model", "resonance"]));
    let spectrum = text(&with(&["spectrum", &asset]));
    assert_eq!(spectrum.lines().count(), 198);
    text(&with(&["synth", &asset, "-o", &wav, "--seconds", "0.5"]));
    text(&with(&["compare", &recording, &asset]));
    assert!(text(&with(&["plugin", "list"])).contains("org.example.resonance"));
    assert!(text(&with(&["plugin", "info", "resonance"])).contains("bandwidth_hz"));

    // Without the plugin the model is unknown.
    assert!(!htex(&["synth", &asset, "-o", &wav]).status.success());
    let dir = Path::new(&plugin).parent().unwrap().to_str().unwrap();
    // A list loads no library in a folder, so it needs the descriptor beside the library.
    text(&htex(&["plugin", "export", &plugin]));
    let found = htex(&["plugin", "list", "--json", "--plugin-dir", dir]);
    let found: serde_json::Value = serde_json::from_slice(&found.stdout).unwrap();
    let builtin = htex_host::Registry::builtin_names().len();
    assert_eq!(found["models"].as_array().unwrap().len(), builtin + 1);
}

/// A bare name is a file of the current folder; the system's loader does not search for it.
#[test]
fn a_plugin_is_found_by_its_bare_name() {
    let folder = tempfile::tempdir().unwrap();
    let plugin = resonance(folder.path());
    let file = Path::new(&plugin);
    let name = file.file_name().unwrap().to_str().unwrap();
    let here = |arguments: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_htex"));
        command.args(arguments).current_dir(file.parent().unwrap()).output().unwrap()
    };
    assert!(text(&here(&["plugin", "check", name])).contains("passed"));
    assert!(text(&here(&["plugin", "info", name])).contains("bandwidth_hz"));
    assert!(text(&here(&["plugin", "list", "--plugin", name])).contains("org.example.resonance"));

    std::fs::write(file, "no library").unwrap();
    let wrong = here(&["plugin", "info", name]);
    let error = String::from_utf8_lossy(&wrong.stderr);
    assert_eq!(wrong.status.code(), Some(1));
    // The loader's own reason, with the file that it tried.
    assert!(error.contains(&format!("{plugin}: ")), "{error}");
}

#[test]
fn a_plugin_that_is_none_is_an_error_with_its_file() {
    let wrong = htex(&["plugin", "list", "--plugin", "no-such-model.so"]);
    assert_eq!(wrong.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&wrong.stderr).contains("no-such-model.so"));
}
