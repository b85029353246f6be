//! Programs in C, C++ and C# render the samples of the Rust crate, bit for bit.
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

#[path = "common/programs.rs"]
mod programs;

use std::fs;
use std::path::Path;
use std::process::Command;

use htex::{Asset, Motion, VoiceOptions};
use programs::{Language, Project, asset};
use xtask::needs;

/// The samples of the examples' stroke.
fn stroke(asset: &Path) -> Vec<u8> {
    let asset = Asset::open(asset).unwrap();
    let mut voice = asset.voice(&VoiceOptions::default().with_seed(7)).unwrap();
    let mut bytes = Vec::new();
    for block in 0..625 {
        let mut samples = [0.0f32; 64];
        let motion = Motion::new(40.0 + 0.2 * f64::from(block), 0.4);
        voice.set_motion(motion).unwrap();
        voice.render(&mut samples).unwrap();
        bytes.extend(samples.iter().flat_map(|x| x.to_le_bytes()));
    }
    bytes
}

#[test]
fn examples_play_the_same_samples() {
    let expected = stroke(&asset());
    for language in Language::ALL {
        let Some(project) = Project::new(language, "example") else {
            continue;
        };
        let program = project.build(&fs::read_to_string(language.example()).unwrap());
        let out = project.folder().join("stroke.f32");
        let run = project.run(&program, &[asset().as_os_str(), out.as_os_str()]);
        assert!(run.status.success(), "{language:?}: {run:?}");
        assert!(fs::read(&out).unwrap() == expected, "{language:?}");
        // A file that is not there, and one that is no asset.
        for bad in ["missing.htex", "bad.htex"] {
            fs::write(project.folder().join("bad.htex"), b"PK\x03\x04 no asset").unwrap();
            let path = project.folder().join(bad);
            let run = project.run(&program, &[path.as_os_str(), out.as_os_str()]);
            let text = String::from_utf8_lossy(&run.stderr);
            assert_eq!(run.status.code(), Some(1), "{language:?}: {text}");
            assert!(text.contains(bad) || text.contains("asset"), "{text}");
        }
    }
}

#[test]
fn examples_of_the_readme_run() {
    let readme = fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/README.md")).unwrap();
    let mut voice = Asset::open(asset())
        .unwrap()
        .voice(&VoiceOptions::default())
        .unwrap();
    let mut block = [0.0f32; 64];
    voice.set_motion(Motion::new(80.0, 0.4)).unwrap();
    voice.render(&mut block).unwrap();
    for language in Language::ALL {
        let Some(project) = Project::new(language, "readme") else {
            continue;
        };
        let program = project.build(&language.in_readme(&readme));
        fs::copy(asset(), project.folder().join("sandpaper.htex")).unwrap();
        let run = project.run(&program, &[]);
        assert!(run.status.success(), "{language:?}: {run:?}");
        let printed = String::from_utf8(run.stdout).unwrap();
        assert_eq!(language.number(printed.trim()), block[63], "{language:?}");
    }
}

/// C# passes modules to the library: a model in C is loaded, and other bytes are an error that names their place.
#[test]
fn modules_reach_the_library_from_csharp() {
    let Some(project) = Project::new(Language::Csharp, "modules") else {
        return;
    };
    let module = project.folder().join("bursts.wasm");
    let source = "examples/model-c-bursts/bursts.c";
    if !needs::WASM_CLANG.met(xtask::c_module::build(source, &module).is_ok()) {
        return;
    }
    let program = project.build(
        r#"
        using System; using System.IO; using Htex;
        static class Program
        {
            static void Main(string[] paths)
            {
                var module = File.ReadAllBytes(paths[1]);
                using (Asset.Open(paths[0], new OpenOptions { Modules = new[] { module } }))
                    Console.WriteLine("opened");
                Array.Resize(ref module, module.Length / 2);
                try { Asset.Open(paths[0], new OpenOptions { Modules = new[] { File.ReadAllBytes(paths[1]), module } }); }
                catch (HtexException error) { Console.WriteLine(error.Message); }
                try { Asset.Open(paths[0], new OpenOptions { Modules = new[] { module, null } }); }
                catch (HtexException error) { Console.WriteLine(error.Message); }
            }
        }
        "#,
    );
    let run = project.run(&program, &[asset().as_os_str(), module.as_os_str()]);
    let printed = String::from_utf8_lossy(&run.stdout);
    let lines: Vec<&str> = printed.lines().collect();
    assert_eq!(lines.len(), 3, "{run:?}");
    assert_eq!(lines[0], "opened");
    assert!(lines[1].contains("module 1"), "{printed}");
    assert!(lines[2].contains("module 0"), "{printed}");
}

/// The example in C under valgrind, and with the sanitizers of gcc and clang: neither invalid accesses nor leaks.
#[test]
fn the_example_has_no_memory_errors() {
    let source = fs::read_to_string(Language::C.example()).unwrap();
    let run = |project: &Project, under: &[&str], more: &[&str]| {
        let program = project.build_with(&source, more);
        let out = project.folder().join("stroke.f32");
        let run = project.run_under(under, &program, &[asset().as_os_str(), out.as_os_str()]);
        assert!(run.status.success(), "{under:?} {more:?}: {run:?}");
        assert!(
            fs::read(&out).unwrap() == stroke(&asset()),
            "{under:?} {more:?}"
        );
    };
    let valgrind = Command::new("valgrind").arg("--version").output().is_ok();
    if needs::VALGRIND.met(valgrind) {
        let under = [
            "valgrind",
            "--quiet",
            "--error-exitcode=9",
            "--leak-check=full",
            "--errors-for-leak-kinds=definite",
        ];
        run(&Project::new(Language::C, "valgrind").unwrap(), &under, &[]);
    }
    let flags = ["-fsanitize=address,undefined", "-fno-sanitize-recover=all"];
    for language in [Language::C, Language::Clang] {
        let project = Project::new(language, "sanitized");
        if let Some(project) =
            project.filter(|project| needs::SANITIZERS.met(project.builds(&flags)))
        {
            run(&project, &[], &flags);
        }
    }
}
