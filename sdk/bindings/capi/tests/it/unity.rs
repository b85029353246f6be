//! The Unity package is complete: its `.meta` files, its assemblies for each target, its tests with
//! libhtex, its allocations, and the layout of the matching NuGet package.

mod assemblies;
mod metas;
#[allow(dead_code)] // Of programs in other languages.
use crate::common::programs;

use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};

use assemblies::{EDITOR, PLAYERS, compile, compile_package, compile_stubs};
use programs::{Language, Project, asset};
use serde_json::Value;

fn capi(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

fn package() -> PathBuf {
    capi("unity")
}

fn hosts() -> PathBuf {
    capi("tests/hosts")
}

/// Runs a mono program in a project's folder and returns what it prints.
fn run(project: &Project, program: &str, arguments: &[&str]) -> String {
    let arguments: Vec<&OsStr> = arguments.iter().map(OsStr::new).collect();
    let run = project.run(Path::new(program), &arguments);
    assert!(run.status.success(), "{program}: {run:?}");
    String::from_utf8(run.stdout).unwrap()
}

/// Each file and folder has its `.meta` file with the GUID of its path, and there are no other
/// `.meta` files.
#[test]
fn generated_metas_are_those_of_the_files() {
    let metas = metas::all(&package());
    for (path, text) in &metas {
        xtask::generated::file(format!("sdk/bindings/capi/unity/{path}"), text.as_bytes());
    }
    let expected: Vec<_> = metas.keys().cloned().collect();
    let there: BTreeSet<_> = metas::there(&package()).into_iter().collect();
    assert!(there.iter().eq(&expected), "{there:?} instead of {expected:?}");
    let line = |text: &str| text.lines().nth(1).unwrap().to_owned();
    let guids: BTreeSet<_> = metas.values().map(|text| line(text)).collect();
    assert_eq!(guids.len(), metas.len());
    assert!(guids.iter().all(|guid| guid.len() == "guid: ".len() + 32));
}

/// Files to which users of earlier versions may refer keep their GUIDs.
#[test]
fn a_guid_stays_the_same() {
    assert_eq!(metas::guid("Runtime/HtexSource.cs"), "d730aa622899ec37c515d7e2433d9e1f");
}

#[test]
fn the_manifest_names_what_is_there() {
    let text = fs::read_to_string(package().join("package.json")).unwrap();
    let manifest: Value = serde_json::from_str(&text).unwrap();
    let version = env!("CARGO_PKG_VERSION");
    assert_eq!(manifest["version"], version);
    for sample in manifest["samples"].as_array().unwrap() {
        let path = package().join(sample["path"].as_str().unwrap());
        assert!(path.is_dir(), "{path:?}");
    }
    let changes = fs::read_to_string(package().join("CHANGELOG.md")).unwrap();
    assert!(changes.contains(&format!("## {version}\n")));
    let page = fs::read_to_string(package().join("Documentation~/htex.md")).unwrap();
    for plugin in &metas::PLUGINS {
        assert!(page.contains(plugin.path), "{}", plugin.path);
    }
}

/// The sample's scene refers to scripts of the package, and its texture is the one of the examples.
#[test]
fn the_sample_has_its_scripts_and_its_texture() {
    let sample = package().join("Samples~/Touch");
    let scene = fs::read_to_string(sample.join("Touch.unity")).unwrap();
    let scripts = ["Runtime/HtexSource.cs", "Samples~/Touch/TouchPad.cs"];
    let expected = scripts.map(|path| {
        let guid = metas::guid(path);
        format!("  m_Script: {{fileID: 11500000, guid: {guid}, type: 3}}")
    });
    let there: Vec<_> = scene.lines().filter(|line| line.contains("guid:")).collect();
    assert_eq!(there, expected);
    let texture = fs::read(sample.join("Resources/Vinyl.htex")).unwrap();
    assert!(texture == fs::read(asset()).unwrap());
}

/// In the editor, the package's tests import a texture, play it and render it in a job, with the
/// real library.
#[test]
fn the_tests_of_the_package_pass_in_the_editor() {
    let Some(project) = Project::new(Language::Csharp, "unity") else {
        return;
    };
    let folder = project.folder();
    compile_stubs(folder, &hosts());
    let built = compile_package(&package(), folder, &EDITOR);
    assert_eq!(built.len(), 4);
    fs::create_dir(folder.join("Assets")).unwrap();
    let resources = "Samples~/Touch/Resources/Vinyl.htex";
    let there = folder.join("Packages/org.htex.htex").join(resources);
    fs::create_dir_all(there.parent().unwrap()).unwrap();
    fs::copy(package().join(resources), there).unwrap();
    let names: Vec<_> = built.iter().map(|name| format!("{name}.dll")).collect();
    let names: Vec<_> = names.iter().map(String::as_str).collect();
    let printed = run(&project, "nunit.exe", &names);
    let tests = ["Tests/Runtime", "Tests/Editor"].map(|tests| {
        let files = assemblies::sources(&package().join(tests)).into_iter();
        let texts = files.map(|file| fs::read_to_string(file).unwrap());
        texts.map(|text| text.matches("[Test]").count()).sum::<usize>()
    });
    let passed = printed.lines().filter(|line| line.starts_with("passed "));
    assert_eq!(passed.count(), tests[0] + tests[1], "{printed}");
    assert_eq!(import_library(&project), "Floors: 1, vinyl (simulated)\n");
    assert_eq!(touch_the_sample(&project), "speed 80 force 0.4\n");
}

/// Imports a library with one texture in a project with the editor's assemblies, and returns what
/// it prints.
fn import_library(project: &Project) -> String {
    let library = project.folder().join("Assets/floors.htexlib");
    let mut writer = htex::library::Writer::create(&library, "Floors").unwrap();
    let texture = fs::read(asset()).unwrap();
    writer.add("floor/vinyl", &texture).unwrap();
    writer.finish().unwrap();
    let source = [hosts().join("unity/Libraries.cs")];
    let references =
        ["UnityEngine", "UnityEditor", "Htex", "Htex.Editor"].map(|name| format!("-r:{name}.dll"));
    compile(project.folder(), "libraries.exe", &source, &references);
    run(project, "libraries.exe", &["Assets/floors.htexlib"])
}

/// Moves the mouse over the sample in a project with its assemblies, and returns what its source
/// prints.
fn touch_the_sample(project: &Project) -> String {
    let source = [hosts().join("unity/Sample.cs")];
    let references = ["UnityEngine", "Htex", "Sample"].map(|name| format!("-r:{name}.dll"));
    compile(project.folder(), "touch.exe", &source, &references);
    run(project, "touch.exe", &[&asset().display().to_string()])
}

/// For players, the package compiles, native code calls only marked static methods, and iOS links
/// the library into the program.
#[test]
fn the_package_compiles_for_players() {
    let Some(project) = Project::new(Language::Csharp, "unity_players") else {
        return;
    };
    let folder = project.folder();
    compile_stubs(folder, &hosts());
    let callbacks = [hosts().join("unity/Callbacks.cs")];
    compile(folder, "callbacks.exe", &callbacks, &[]);
    for target in &PLAYERS {
        let built = compile_package(&package(), folder, target);
        assert_eq!(built, ["Htex", "Htex.Tests"], "{}", target.name);
        let printed = run(&project, "callbacks.exe", &["Htex.dll"]);
        assert_eq!(printed, "Close Open Pass Read\n", "{}", target.name);
        let bytes = fs::read(folder.join("Htex.dll")).unwrap();
        let name = b"\0__Internal\0";
        let is_linked = bytes.windows(name.len()).any(|part| part == name);
        assert_eq!(is_linked, target.name == "ios", "{}", target.name);
    }
}

/// When scripts change, the editor unloads the C# code that the library calls, but keeps the
/// library loaded.
#[test]
fn messages_do_not_reach_code_that_the_editor_unloaded() {
    let Some(project) = Project::new(Language::Csharp, "unity_reload") else {
        return;
    };
    let files = [hosts().join("unity/Reload.cs"), package().join("Runtime/Htex.cs")];
    compile(project.folder(), "reload.exe", &files, &[]);
    let scene = asset().with_file_name("electrovibration.scene.json");
    let printed = run(&project, "reload.exe", &[&scene.display().to_string()]);
    assert_eq!(printed, "notes 1\n");
}

/// 10,000 blocks of `HtexSource`, of a voice and of a job allocate nothing on the C# heap.
#[test]
fn the_audio_thread_allocates_nothing_in_csharp() {
    let Some(project) = Project::new(Language::Csharp, "allocations") else {
        return;
    };
    let mut files = assemblies::sources(&package().join("Runtime"));
    let stubs = ["Allocations.cs", "NativeArray.cs", "unity/UnityEngine.cs"];
    files.extend(stubs.map(|file| hosts().join(file)));
    let arguments =
        ["-unsafe", "-d:UNITY_5_3_OR_NEWER", "-d:UNITY_2021_2_OR_NEWER"].map(str::to_owned);
    compile(project.folder(), "allocations.exe", &files, &arguments);
    let asset = asset().display().to_string();
    let printed = run(&project, "allocations.exe", &[&asset]);
    assert_eq!(printed, "source 0\nvoice 0\njob 0\n");
}

/// The NuGet package has the file of the Unity package and every library of a release. The test
/// does not run `dotnet`, which packs it.
#[test]
fn the_nuget_package_has_its_files() {
    let folder = capi("nuget");
    let text = fs::read_to_string(folder.join("Htex.csproj")).unwrap();
    let project = roxmltree::Document::parse(&text).unwrap();
    let texts = |name| {
        let nodes = project.descendants().filter(move |node| node.has_tag_name(name));
        nodes.map(|node| node.text().unwrap_or_default()).collect::<Vec<_>>()
    };
    assert_eq!(texts("Version"), [env!("CARGO_PKG_VERSION")]);
    assert_eq!(texts("TargetFramework"), ["netstandard2.0"]);
    let nuspec = texts("NuspecFile");
    let sources = project.descendants().filter_map(|node| node.attribute("Include"));
    let sources: Vec<_> = sources.collect();
    assert_eq!(sources, ["../unity/Runtime/Htex.cs"]);
    assert!(folder.join(sources[0]).is_file());

    let text = fs::read_to_string(folder.join(nuspec[0])).unwrap();
    let nuspec = roxmltree::Document::parse(&text).unwrap();
    let nodes = nuspec.descendants().filter(|node| node.tag_name().name() == "file");
    let files: Vec<_> = nodes
        .map(|node| (node.attribute("src").unwrap(), node.attribute("target").unwrap()))
        .collect();
    let expected = [
        ("README.md", ""),
        ("$output$/Htex.dll", "lib/netstandard2.0/"),
        ("natives/linux-x64/libhtex.so", "runtimes/linux-x64/native/"),
        ("natives/linux-arm64/libhtex.so", "runtimes/linux-arm64/native/"),
        ("natives/win-x64/htex.dll", "runtimes/win-x64/native/"),
        ("natives/osx-arm64/libhtex.dylib", "runtimes/osx-arm64/native/"),
    ];
    assert_eq!(files, expected);
}
