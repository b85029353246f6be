//! Programs in C, C++ and C# render the same samples as the Rust crate, bit for bit.

use crate::common::programs;

use std::fs;
use std::path::Path;

use htex::{Motion, Texture, VoiceOptions};
use programs::{Language, Project, asset, clean};
use xtask::needs;

/// The samples of the examples' stroke.
fn stroke(asset: &Path) -> Vec<u8> {
    let asset = Texture::open(asset).unwrap();
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
        // A missing file, and one that is not an asset.
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
    let mut voice = Texture::open(asset()).unwrap().voice(&VoiceOptions::default()).unwrap();
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

/// A program that prints the number of textures in a library, its first page, and the model of one
/// texture.
fn look_into_a_library(language: Language) -> &'static str {
    match language {
        Language::C | Language::Clang => {
            r#"
            #include <stdio.h>
            #include <htex.h>
            int main(int argc, char **argv)
            {
                htex_library library;
                htex_asset asset;
                uint64_t count;
                char text[4096];
                if (htex_library_open(argv[argc - 1], &library) || htex_library_count(library, &count)
                    || htex_library_page_json(library, 0, text, sizeof text, NULL))
                    return 1;
                printf("%d\n%s\n", (int)count, text);
                if (htex_library_asset(library, "floor/vinyl", NULL, &asset)
                    || htex_asset_representation_model(asset, 0, text, sizeof text, NULL))
                    return 1;
                printf("%s\n", text);
                if (htex_library_asset(library, "none", NULL, &asset) != HTEX_STATUS_ABSENT)
                    return 1;
                printf("%s\n", htex_last_error());
                return htex_asset_free(asset) || htex_library_free(library);
            }"#
        }
        Language::Cxx => {
            r#"
            #include <iostream>
            #include <htex.hpp>
            int main(int argc, char **argv)
            {
                auto library = htex::Library::open(argv[argc - 1]);
                if (!library)
                    return 1;
                std::cout << *library->count() << "\n" << *library->page_json(0) << "\n";
                std::cout << library->texture("floor/vinyl")->models()->at(0) << "\n";
                std::cout << library->texture("none").status().text << "\n";
            }"#
        }
        Language::Csharp => {
            r#"
            using System; using Htex;
            static class Program
            {
                static void Main(string[] paths)
                {
                    using (var library = Library.Open(paths[0]))
                    {
                        Console.WriteLine(library.Count);
                        Console.WriteLine(library.PageJson(0));
                        using (var asset = library.Asset("floor/vinyl")) Console.WriteLine(asset.Models[0]);
                        try { library.Asset("none"); }
                        catch (HtexException error) { Console.WriteLine(error.Message); }
                    }
                }
            }"#
        }
    }
}

#[test]
fn libraries_open_in_each_language() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.htexlib");
    let mut writer = htex::library::Writer::create(&path, "A").unwrap();
    writer.add("floor/vinyl", &fs::read(asset()).unwrap()).unwrap();
    writer.finish().unwrap();
    let library = htex::library::Library::open(&path).unwrap();
    let entry = library.entry("floor/vinyl").unwrap().unwrap();
    let absent = library.get("none").unwrap_err().to_string();
    let json = serde_json::to_string(&[&entry]).unwrap();
    let expected = format!("1\n{json}\n{}\n{absent}\n", entry.models[0]);
    for language in Language::ALL {
        let Some(project) = Project::new(language, "library") else {
            continue;
        };
        let program = project.build(&format!("{}\n", look_into_a_library(language)));
        let run = project.run(&program, &[path.as_os_str()]);
        assert!(run.status.success(), "{language:?}: {run:?}");
        let printed = String::from_utf8(run.stdout).unwrap();
        assert_eq!(printed, expected, "{language:?}");
    }
}

/// C# passes modules to the library: a model in C is loaded, and other bytes are an error that
/// names which module is invalid.
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
                using (Asset.Open(paths[0], new OpenOptions { Engine = Engine.Checked, Modules = new[] { module } }))
                    Console.WriteLine("opened");
                Array.Resize(ref module, module.Length / 2);
                try { Asset.Open(paths[0], new OpenOptions { Engine = Engine.Checked, Modules = new[] { File.ReadAllBytes(paths[1]), module } }); }
                catch (HtexException error) { Console.WriteLine(error.Message); }
                try { Asset.Open(paths[0], new OpenOptions { Engine = Engine.Checked, Modules = new[] { module, null } }); }
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

/// The C example makes no invalid accesses and has no leaks, under valgrind and with the sanitizers
/// of gcc and clang.
#[test]
fn the_example_has_no_memory_errors() {
    let source = fs::read_to_string(Language::C.example()).unwrap();
    clean("example", "definite", |project, under, more| {
        let program = project.build_with(&source, more);
        let out = project.folder().join("stroke.f32");
        let run = project.run_under(under, &program, &[asset().as_os_str(), out.as_os_str()]);
        assert!(run.status.success(), "{under:?} {more:?}: {run:?}");
        assert!(fs::read(&out).unwrap() == stroke(&asset()), "{under:?} {more:?}");
    });
}
