//! Upper bounds of the time and memory of untrusted modules.

#[path = "../../../tests/fuzzing/src/heavy.rs"]
#[allow(dead_code)]
mod heavy;

use std::time::Duration;

use crate::common::Place;
use crate::common::measured::{End, run};
use crate::model;
use heavy::Heavy;
use htex_format::{Asset, Plugin};

/// Allowed beside the limits: reading, checking, and writing the module.
const BESIDE: (Duration, i64) = (Duration::from_secs(2), 128 << 10);

/// An asset of so many representations, each of an embedded model, which was valid when it was
/// fitted.
fn asset(place: &Place, models: usize, hostile: &str) {
    let csv = place.recording("sandpaper");
    let ids: Vec<String> = (0..models).map(|i| format!("org.example.hosti{i:02}")).collect();
    let mut fit = vec!["fit".to_owned(), csv, "-o".to_owned(), "sound.htex".to_owned()];
    let mut names = Vec::new();
    for id in &ids {
        let wat = model::text("1.0.0", &[], "").replace(model::ID, id);
        let file = format!("{id}.wasm");
        place.write(&file, wat::parse_str(wat).unwrap());
        fit.push(format!("--embed-plugin={file}"));
        names.push(id.rsplit('.').next().unwrap());
    }
    fit.push(format!("--model={}", names.join(",")));
    let fit: Vec<&str> = fit.iter().map(String::as_str).collect();
    let run = place.run(&fit);
    assert_eq!(run.code(), 0, "{}", run.error());
    let mut asset = Asset::open(&place.path("sound.htex")).unwrap();
    let plugins = asset.manifest.plugins.iter_mut().zip(&mut asset.plugins);
    for (plugin, module) in plugins {
        *module = wat::parse_str(hostile.replace(model::ID, &plugin.model)).unwrap();
        *plugin = Plugin::new(&plugin.model, "1.0.0", module);
    }
    place.write("hostile.htex", asset.to_bytes().unwrap());
    place.scene("scene.json", "hostile.htex", &serde_json::json!({ "duration_s": 1 }));
}

fn measured(place: &Place, arguments: &[&str]) -> End {
    let mut command = place.command(arguments);
    command.env("HTEX_CACHE_DIR", place.path("cache"));
    run(&mut command, &place.path("errors"))
}

#[test]
fn any_module_is_compiled_or_refused_within_its_limits() {
    let of = |locals, (depth, nests), blocks: &[u8], head: &[u8], end: &[u8]| Heavy {
        locals,
        depth,
        nests,
        copies: 1,
        blocks: blocks.to_vec(),
        head: head.to_vec(),
        end: end.to_vec(),
    };
    // These took 40 s, 15 s and 50 s, or some GB, with a processor and a compiler of 2026.
    let cases = [
        ("nested conditions", of(100, (2000, 1), &[2], &[0], &[])),
        ("nested loops", of(1000, (1000, 1), &[1], &[0], &[4])),
        ("jumps to the head of a loop", of(1000, (1, 1), &[1], &[0, 3].repeat(2000), &[])),
        ("nested blocks", of(1000, (2000, 4), &[0], &[], &[2, 0])),
        ("calls through a table", of(10, (1, 50_000), &[0], &[7], &[])),
        ("copies of tables", of(10, (1, 50_000), &[0], &[13], &[])),
        ("wide jumps", of(200, (1000, 1), &[0], &[5], &[])),
        ("functions", Heavy { copies: 150_000, ..of(1, (1, 1), &[0], &[], &[]) }),
    ];
    let place = Place::new();
    for (name, heavy) in cases {
        let wat = model::text("1.0.0", &[], &heavy.text());
        place.write("heavy.wasm", wat::parse_str(wat).unwrap());
        let arguments = ["plugin", "info", "heavy.wasm", "--wasm-limit", "module-mib=16"];
        let end = measured(&place, &arguments);
        println!("{name}: status {}, {:?}, {} KiB", end.code, end.cpu, end.memory_kib);
        let (time, memory_kib) = (Duration::from_secs(5) + BESIDE.0, (512 << 10) + BESIDE.1);
        assert!([0, 1, 2].contains(&end.code), "{name}: {}", end.error);
        assert!(end.cpu < time && end.memory_kib < memory_kib, "{name}: {:?}", end.cpu);
        assert!(end.code == 0 || end.error.contains("compile"), "{name}: {}", end.error);
    }
}

/// A compiler that exceeds its limits is stopped, whatever the estimate.
#[test]
fn a_compiler_that_takes_more_is_stopped() {
    let place = Place::new();
    let heavy = Heavy {
        locals: 100,
        depth: 100,
        nests: 4,
        copies: 2,
        blocks: vec![2],
        head: vec![0],
        ..Heavy::default()
    };
    let wat = model::text("1.0.0", &[], &heavy.text());
    place.write("heavy.wasm", wat::parse_str(wat).unwrap());
    let info = |limits: &[&str]| {
        let limits: Vec<String> = limits.iter().map(|l| format!("--wasm-limit={l}")).collect();
        let limits: Vec<&str> = limits.iter().map(String::as_str).collect();
        measured(&place, &[&["plugin", "info", "heavy.wasm"][..], &limits].concat())
    };
    for (limits, said) in [
        (["compile-ms=600000", "compile-mib=1"], "more than 1048576 bytes to compile"),
        (["compile-ms=600000", "all-ms=20"], "to compile, and compilation was stopped"),
        (["compile-ms=1", "all-ms=30000"], "ms to compile, and 1 ms are allowed"),
    ] {
        let end = info(&limits);
        assert!(end.code != 0 && end.error.contains(said), "{limits:?}: {}", end.error);
    }
    let end = info(&["compile-ms=600000"]);
    assert_eq!(end.code, 0, "{}", end.error);
}

/// Modules that never return, and an asset full of them: nothing runs before it is needed, and then
/// within one budget.
#[test]
fn modules_share_a_budget_of_time() {
    let place = Place::new();
    let endless = [("abi_version", "(loop (br 0)) (i32.const 0)")];
    asset(&place, 12, &model::text("1.0.0", &endless, ""));
    for file in ["hostile.htex", "scene.json"] {
        let end = measured(&place, &["validate", file]);
        assert!(end.code < 2 && end.cpu < BESIDE.0, "{file}: {:?} {}", end.cpu, end.error);
    }
    let all = ["validate", "--embedded-plugins", "hostile.htex", "--wasm-limit"];
    let end = measured(&place, &[&all[..], &["asset-ms=1000"]].concat());
    assert_eq!(end.code, 1, "{}", end.error);
    assert!(end.cpu < Duration::from_secs(1) + BESIDE.0, "{:?}", end.cpu);
    let said = place.run(&[&all[..], &["asset-ms=1000"]].concat()).text();
    let used_up = "used up the 1000 ms that they have together";
    assert!(said.contains(used_up), "{said}");
    let end = measured(&place, &["plan", "scene.json", "--wasm-limit", "all-ms=500"]);
    assert_eq!(end.code, 1, "{}", end.error);
    assert!(end.cpu < Duration::from_millis(500) + BESIDE.0, "{:?}", end.cpu);
}

/// Modules that each take all the memory of an instance.
#[test]
fn modules_share_a_budget_of_memory() {
    let place = Place::new();
    let grows = [(
        "abi_version",
        "(drop (memory.grow (i32.const 960)))
         (memory.fill (i32.const 65536) (i32.const 1) (i32.const 62914560))
         (i32.const 0x48540100)",
    )];
    asset(&place, 20, &model::text("1.0.0", &grows, ""));
    let end = measured(&place, &["plan", "scene.json", "--wasm-limit", "asset-mib=256"]);
    assert_eq!(end.code, 1, "{}", end.error);
    let sentence = "the modules of this asset may have 268435456 bytes of memory together";
    assert!(end.error.contains(sentence), "{}", end.error);
    assert!(end.memory_kib < (256 << 10) + BESIDE.1, "{} KiB", end.memory_kib);
}
