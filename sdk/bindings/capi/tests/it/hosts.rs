//! What libhtex costs the program that contains it: allocations in real-time calls, memory,
//! threads, files and signal handlers.

#[allow(dead_code)] // Of programs in other languages.
use crate::common::programs;

use std::collections::BTreeMap;
use std::ffi::OsStr;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use htex::author::simulate::{SimulationOptions, Surface, simulate};
use htex::author::{AssetRequest, Exploration, ModelRequest, Take, embed_plugins, fit_asset};
use htex::model::Search;
use htex::{Motion, Registry, Texture, VoiceOptions};
use programs::{Language, Project, asset, clean};
use xtask::needs;

fn hosts(file: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/hosts").join(file)
}

/// Builds a program in this folder.
fn build(project: &Project, file: &str, more: &[&str]) -> PathBuf {
    let include = format!("-I{}", hosts("").display());
    let source = fs::read_to_string(hosts(file)).unwrap();
    project.build_with(&source, &[&[&include, "-pthread"], more].concat())
}

fn passed(what: &str, run: &Output) -> String {
    assert!(run.status.success(), "{what}: {run:?}");
    String::from_utf8(run.stdout.clone()).unwrap()
}

/// 64 voices on four threads, 20,000 renders each, with motions and errors.
#[test]
fn real_time_calls_do_not_allocate() {
    let Some(project) = Project::new(Language::C, "real_time") else {
        return;
    };
    let program = build(&project, "real_time.c", &["-DCOUNTED"]);
    let asset = all_models(&project);
    let run = project.run(&program, &[asset.as_os_str(), "20000".as_ref()]);
    println!("{}", passed("counted", &run));
}

#[test]
fn the_library_is_clean_under_valgrind_and_sanitizers() {
    clean("real_time", "definite,indirect,possible", |project, under, flags| {
        let program = build(project, "real_time.c", flags);
        let asset = all_models(project);
        let arguments = [asset.as_os_str(), "1500".as_ref()];
        passed("clean", &project.run_under(under, &program, &arguments));
    });
}

/// The first voice of a model takes at most 64 kB more than the next ones, and shutting down the
/// library leaves only constants.
#[test]
fn voices_are_small_and_the_end_gives_everything_back() {
    let Some(project) = Project::new(Language::C, "memory") else {
        return;
    };
    let program = build(&project, "memory.c", &["-DCOUNTED"]);
    let asset = all_models(&project);
    let run = project.run(&program, &[asset.as_os_str()]);
    println!("{}", passed("memory", &run));
}

/// A texture recorded at two speeds, with these models.
fn fitted(registry: &Registry, models: &[&str]) -> htex::format::Asset {
    let take = |speed_mm_s| {
        let options =
            SimulationOptions::new(Surface::Vinyl).with_speed_mm_s(speed_mm_s).with_duration_s(3.0);
        Take {
            recording: simulate(&options).unwrap().to_recording("vinyl").unwrap(),
            given: Exploration { speed_mm_s: Some(speed_mm_s), force_n: Some(0.4) },
        }
    };
    let models = models.iter().map(|name| ModelRequest::new(registry.find(name).unwrap()));
    let request = AssetRequest::new("vinyl").with_models(models);
    fit_asset(&[take(60.0), take(120.0)], &request).unwrap().asset
}

/// A texture with all models, in a program's folder.
fn all_models(project: &Project) -> PathBuf {
    let asset = fitted(&Registry::builtin(), &Registry::builtin_names());
    let path = project.folder().join("all.htex");
    fs::write(&path, asset.to_bytes().unwrap()).unwrap();
    path
}

/// An asset with sBeta and an embedded model.
fn asset_with_module(module: &Path) -> Vec<u8> {
    let search = Search::builtin().with_files(vec![module.to_owned()]);
    let registry = Registry::search(&search).unwrap();
    let mut asset = fitted(&registry, &["bursts", "sbeta"]);
    embed_plugins(&mut asset, &registry, &[module.to_owned()], None).unwrap();
    asset.to_bytes().unwrap()
}

/// If a program opens an asset with an embedded module without turning on an engine, it gets no new
/// thread, file or signal handler.
#[test]
fn modules_run_only_in_a_program_that_asks_for_them() {
    let Some(project) = Project::new(Language::C, "host_of_modules") else {
        return;
    };
    let module = project.folder().join("bursts.wasm");
    let built = xtask::c_module::build("examples/model-c-bursts/bursts.c", &module);
    if !needs::WASM_CLANG.met(built.is_ok()) {
        return;
    }
    let path = project.folder().join("bursts.htex");
    fs::write(&path, asset_with_module(&module)).unwrap();
    let program = build(&project, "modules.c", &[]);
    let home = tempfile::tempdir().unwrap();
    let run = Command::new(&program)
        .arg(&path)
        .current_dir(project.folder())
        .env("LD_LIBRARY_PATH", project.folder())
        .env("HOME", home.path())
        .env_remove("XDG_CACHE_HOME")
        .env_remove("XDG_CONFIG_HOME")
        .env_remove("HTEX_CACHE_DIR")
        .output()
        .unwrap();
    passed("modules", &run);
    assert_eq!(fs::read_dir(home.path()).unwrap().count(), 0);
}

/// The lines that programs print, as names and values.
fn lines(printed: &str) -> BTreeMap<&str, &str> {
    let lines = printed.lines().filter_map(|line| line.split_once(' '));
    lines.collect()
}

fn numbers(text: &str) -> Vec<f64> {
    text.split(' ').map(|word| word.parse().unwrap()).collect()
}

/// C++ and C# return the same names, levels, bands, envelopes, mixes and other results as Rust.
#[test]
fn calls_of_each_language_tell_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let fluctuating = folder.path().join("fluctuating.htex");
    let mut data = htex::format::Asset::open(&asset()).unwrap();
    data.manifest.fluctuation = htex::format::Fluctuation::from_db([4.0, 2.0]);
    fs::write(&fluctuating, data.to_bytes().unwrap()).unwrap();
    let library = folder.path().join("a.htexlib");
    let mut writer = htex::library::Writer::create(&library, "A").unwrap();
    writer.add("a", &data.to_bytes().unwrap()).unwrap();
    writer.finish().unwrap();
    let scene = asset().with_file_name("constant.scene.json");

    let opened = Texture::open(&fluctuating).unwrap();
    let options = VoiceOptions::default()
        .with_seed(7)
        .with_gain(0.5)
        .with_limit(0.01)
        .with_envelope_bands(3)
        .with_fluctuation(true);
    let mut voice = opened.voice(&options).unwrap();
    let (mut samples, mut bands) = ([0.0f32; 4_000], [0.0; 3]);
    voice.render(&mut samples).unwrap();
    let envelope = voice.envelope(&mut bands).unwrap();
    let expected = [
        ("library", vec![1.0]),
        ("level", vec![opened.level_rms(None).unwrap()]),
        ("band", vec![20.0, 1_000.0]),
        ("edges", voice.envelope_edges_hz()[1..3].to_vec()),
        ("envelope", [&[envelope.level_rms, envelope.centroid_hz], &bands[..]].concat()),
        ("again", vec![1.0]),
        ("silent", vec![1.0]),
        ("device", vec![2_000.0, 2_000.0, 48_000.0]),
    ];
    voice.set_motion(Motion::new(0.0, 0.0)).unwrap();

    let mut played = Vec::new();
    for (language, file) in [(Language::Cxx, "calls.cpp"), (Language::Csharp, "Calls.cs")] {
        let Some(project) = Project::new(language, "calls") else {
            continue;
        };
        let source = fs::read_to_string(hosts(file)).unwrap();
        // Compiled as a recent Unity does, apart from Unity's own types.
        let unity = hosts("../../unity/Runtime/HtexNativeArray.cs");
        let files = [unity, hosts("NativeArray.cs")].map(|file| file.display().to_string());
        let [unity, types] = &files;
        let more: &[&str] = match language {
            Language::Csharp => {
                &["-r:System.Core", "-unsafe", "-d:UNITY_2021_2_OR_NEWER", unity, types]
            }
            _ => &[],
        };
        let program = project.build_with(&source, more);
        let channels = folder.path().join(format!("{file}.wav"));
        let mut paths: Vec<&OsStr> = vec![fluctuating.as_os_str(), library.as_os_str()];
        if language == Language::Csharp {
            paths.push(scene.as_os_str());
        }
        paths.push(channels.as_os_str());
        let printed = passed(file, &project.run(&program, &paths));
        let lines = lines(&printed);
        for (name, values) in &expected {
            for (there, wanted) in numbers(lines[name]).iter().zip(values) {
                let near = (there - wanted).abs() <= 1e-9 * wanted.abs();
                assert!(near, "{file}: {name}: {there} and {wanted}");
            }
            assert_eq!(numbers(lines[name]).len(), values.len());
        }
        assert_eq!(lines["name"], opened.manifest().name);
        assert_eq!(lines["model"], opened.representation(None).unwrap().id());
        assert_eq!(lines["status"], "another thread uses the object");
        played.push(fs::read(channels).unwrap());
    }
    // Four channels of 2,000 samples, identical from every language.
    assert!(played.iter().all(|file| *file == played[0] && file.len() > 2_000 * 4 * 4));
}

/// 2,000 toggles of `HtexSource` while an audio thread renders without a pause.
#[test]
fn toggles_of_a_source_leave_nothing() {
    let Some(project) = Project::new(Language::Csharp, "toggles") else {
        return;
    };
    let source = fs::read_to_string(hosts("Toggles.cs")).unwrap();
    let files = [
        "../../unity/Runtime/HtexSource.cs",
        "../../unity/Runtime/HtexTexture.cs",
        "unity/UnityEngine.cs",
    ]
    .map(|file| hosts(file).display().to_string());
    let [source_file, texture, engine] = &files;
    let more = ["-d:UNITY_5_3_OR_NEWER", source_file, texture, engine];
    let program = project.build_with(&source, &more);
    let asset = asset();
    let (folder, name) = (asset.parent().unwrap(), asset.file_name().unwrap());
    let run = project.run(&program, &[folder.as_os_str(), name]);
    println!("{}", passed("toggles", &run));
}
