//! The assemblies of the Unity package, compiled with mono as their `.asmdef` files specify,
//! against stubs of Unity.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

/// Symbols that Unity defines for all targets.
const ALWAYS: [&str; 4] =
    ["UNITY_5_3_OR_NEWER", "UNITY_2021_2_OR_NEWER", "UNITY_2021_3_OR_NEWER", "UNITY_INCLUDE_TESTS"];

/// A platform for which Unity compiles.
pub struct Target {
    pub name: &'static str,
    pub defines: &'static [&'static str],
    pub is_editor: bool,
}

pub const EDITOR: Target = Target {
    name: "editor",
    defines: &["UNITY_EDITOR", "UNITY_EDITOR_64", "UNITY_STANDALONE_LINUX"],
    is_editor: true,
};

pub const PLAYERS: [Target; 4] = [
    Target { name: "ios", defines: &["UNITY_IOS", "ENABLE_IL2CPP"], is_editor: false },
    Target {
        name: "android",
        defines: &["UNITY_ANDROID", "ENABLE_IL2CPP", "HTEX_BURST"],
        is_editor: false,
    },
    Target { name: "web", defines: &["UNITY_WEBGL", "ENABLE_IL2CPP"], is_editor: false },
    Target { name: "linux", defines: &["UNITY_STANDALONE_LINUX", "HTEX_BURST"], is_editor: false },
];

/// The assemblies, each after the assemblies to which it refers.
const ASMDEFS: [&str; 4] = [
    "Runtime/Htex.asmdef",
    "Editor/Htex.Editor.asmdef",
    "Tests/Runtime/Htex.Tests.asmdef",
    "Tests/Editor/Htex.Editor.Tests.asmdef",
];

/// Third-party assemblies that may be referred to. The stubs of Unity stand in for them.
const OTHERS: [&str; 3] = ["Unity.Burst", "UnityEngine.TestRunner", "UnityEditor.TestRunner"];

/// Compiles C# sources to a file in a folder. A warning is an error.
pub fn compile(folder: &Path, out: &str, sources: &[PathBuf], arguments: &[String]) {
    let mut compiler = Command::new("mcs");
    compiler
        .args(["-warnaserror", "-langversion:7", "-r:System.Core"])
        .arg(format!("-out:{out}"))
        .args(arguments)
        .args(sources);
    if out.ends_with(".dll") {
        compiler.arg("-target:library");
    }
    let built = compiler.current_dir(folder).output().unwrap();
    let errors = String::from_utf8_lossy(&built.stderr);
    assert!(built.status.success(), "{compiler:?}: {errors}");
}

fn words(words: &[&str]) -> Vec<String> {
    words.iter().map(|&word| word.to_owned()).collect()
}

/// Compiles the stubs: Unity, its editor, and the program that runs tests.
pub fn compile_stubs(folder: &Path, hosts: &Path) {
    let engine = [hosts.join("unity/UnityEngine.cs"), hosts.join("NativeArray.cs")];
    compile(folder, "UnityEngine.dll", &engine, &words(&["-unsafe"]));
    let engine = "-r:UnityEngine.dll";
    let editor = [hosts.join("unity/UnityEditor.cs")];
    compile(folder, "UnityEditor.dll", &editor, &words(&[engine]));
    let tests = [hosts.join("unity/NUnit.cs")];
    compile(folder, "nunit.exe", &tests, &words(&[engine]));
}

/// The C# files directly in a folder, without its subfolders.
pub fn sources(folder: &Path) -> Vec<PathBuf> {
    let files = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut files: Vec<_> =
        files.filter(|path| path.extension().is_some_and(|extension| extension == "cs")).collect();
    files.sort();
    assert!(!files.is_empty(), "{}", folder.display());
    files
}

fn texts<'a>(asmdef: &'a Value, key: &str) -> Vec<&'a str> {
    let list = asmdef[key].as_array().unwrap().iter();
    list.map(|text| text.as_str().unwrap()).collect()
}

/// Compiles a target's assemblies and the sample's scripts, and returns the names of the
/// assemblies.
pub fn compile_package(package: &Path, folder: &Path, target: &Target) -> Vec<String> {
    let defines = ALWAYS.iter().chain(target.defines);
    let mut always: Vec<String> = defines.map(|name| format!("-d:{name}")).collect();
    always.push("-r:UnityEngine.dll".to_owned());
    let mut built: Vec<String> = Vec::new();
    for path in ASMDEFS {
        let path = package.join(path);
        let asmdef: Value = serde_json::from_str(&fs::read_to_string(&path).unwrap()).unwrap();
        let is_for_editor = texts(&asmdef, "includePlatforms") == ["Editor"];
        if is_for_editor && !target.is_editor {
            continue;
        }
        let mut arguments = always.clone();
        for reference in texts(&asmdef, "references") {
            if built.iter().any(|name| name == reference) {
                arguments.push(format!("-r:{reference}.dll"));
            } else {
                assert!(OTHERS.contains(&reference), "{path:?}: {reference}");
            }
        }
        if is_for_editor {
            arguments.push("-r:UnityEditor.dll".to_owned());
        }
        if texts(&asmdef, "precompiledReferences") == ["nunit.framework.dll"] {
            assert_eq!(texts(&asmdef, "defineConstraints"), ["UNITY_INCLUDE_TESTS"]);
            arguments.push("-r:nunit.exe".to_owned());
        }
        if asmdef["allowUnsafeCode"] == true {
            arguments.push("-unsafe".to_owned());
        }
        let name = asmdef["name"].as_str().unwrap().to_owned();
        let files = sources(path.parent().unwrap());
        compile(folder, &format!("{name}.dll"), &files, &arguments);
        built.push(name);
    }
    always.push("-r:Htex.dll".to_owned());
    let sample = sources(&package.join("Samples~/Touch"));
    compile(folder, "Sample.dll", &sample, &always);
    built
}
