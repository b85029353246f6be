//! Tests each limit of a WASM model with a model that exceeds it and one that does not.

use crate::common;

use std::time::Duration;

use common::{limits, load_within, text};
use htex_host::{Band, HostError, LoadedModel, Registry, Search, WasmLimits, WasmTotal};

fn magnitude(model: &LoadedModel) -> Result<(), HostError> {
    model.magnitude(&[0.5], Band::TACTILE, &[50.0]).map(drop)
}

/// Loads a model with this body for its magnitude function, and calls it.
fn run(body: &str, more: &str, limits: &WasmLimits) -> Result<(), String> {
    let wat = text("1.0.0", &[("magnitude", body)], more);
    let model = load_within(&wat, limits).map_err(|e| e.to_string())?;
    magnitude(&model).map_err(|e| e.to_string())
}

/// Checks that a body runs within the usual limits, and that a smaller limit refuses it for this
/// reason.
fn bites(body: &str, more: &str, smaller: &WasmLimits, reason: &str) {
    run(body, more, &limits()).unwrap();
    let error = run(body, more, smaller).unwrap_err();
    assert!(error.contains(reason), "{error}");
}

const NOTHING: &str = "(i64.const 0)";

#[test]
fn size_of_the_module() {
    let smaller = limits().with_module_bytes(500);
    bites(NOTHING, "", &smaller, "500 bytes");
}

#[test]
fn memory_at_the_start_and_grown() {
    let smaller = limits().with_memory_bytes(1 << 20);
    bites("(drop (memory.grow (i32.const 9))) (i64.const 0)", "", &smaller, "1048576 bytes");
    let tiny = limits().with_memory_bytes(100_000);
    bites(NOTHING, "", &tiny, "100000 bytes");
    // Arguments that the host passes count as well.
    let model = load_within(&text("1.0.0", &[], ""), &smaller).unwrap();
    let many = vec![50.0; 200_000];
    let error = model.magnitude(&[0.5], Band::TACTILE, &many).unwrap_err().to_string();
    assert!(error.contains("limited to 1048576"), "{error}");
    magnitude(&model).unwrap();
}

#[test]
fn tables() {
    let smaller = limits().with_table_elements(50);
    bites(NOTHING, "(table 100 funcref)", &smaller, "50 elements");
}

#[test]
fn stack() {
    let smaller = limits().with_stack_bytes(16 << 10);
    let body = "(drop (call $deep (i32.const 1000))) (i64.const 0)";
    bites(body, "", &smaller, "16384 bytes of stack");
}

#[test]
fn instructions() {
    let smaller = limits().with_fuel(10_000);
    bites("(call $count (i32.const 100000)) (i64.const 0)", "", &smaller, "10000 instructions");
    // Instructions are counted per call, not per model.
    let counting = limits().with_fuel(1_000_000);
    let body = "(call $count (i32.const 100000)) (i64.const 0)";
    let model = load_within(&text("1.0.0", &[("magnitude", body)], ""), &counting).unwrap();
    (0..10).for_each(|_| magnitude(&model).unwrap());
}

#[test]
fn time() {
    let shorter = limits().with_call(Duration::from_millis(20));
    let longer = limits().with_call(Duration::from_secs(60));
    // Counting takes a few seconds at most, and never less than 20 ms.
    let body = "(call $count (i32.const 400000000)) (i64.const 0)";
    run(body, "", &longer).unwrap();
    let error = run(body, "", &shorter).unwrap_err();
    assert!(error.contains("longer than 20 ms"), "{error}");
}

#[test]
fn voices() {
    let two = limits().with_voices(2);
    let model = load_within(&text("1.0.0", &[], ""), &two).unwrap();
    let voice = || model.voice(&[0.5], Band::TACTILE, 2000.0, 1);
    let (first, second) = (voice().unwrap(), voice().unwrap());
    let error = voice().unwrap_err().to_string();
    assert!(error.contains("2 voices"), "{error}");
    drop(first);
    let third = voice().unwrap();
    assert!(voice().is_err());
    drop((second, third));
    (0..5).for_each(|_| drop(voice().unwrap()));
}

/// A voice is stopped if it is slow in total, even if each call is within its limit.
#[test]
fn time_of_a_voice() {
    let body = "(call $count (i32.const 200000000)) (i64.const 0)";
    let wat = text("1.0.0", &[("voice_render", body)], "");
    let model = load_within(&wat, &limits().with_render(Duration::from_secs(60))).unwrap();
    let mut voice = model.voice(&[0.5], Band::TACTILE, 48_000.0, 1).unwrap();
    let mut block = [0.0; 16];
    let error = (0..1_000).find_map(|_| voice.render(&mut block).err()).unwrap().to_string();
    assert!(error.contains("10 times the duration of its samples"), "{error}");
}

/// The shared limits of a registry apply to models that are within their own limits.
#[test]
fn time_memory_and_instances_of_all() {
    let with = |all: WasmTotal| limits().with_call(Duration::from_secs(60)).with_all(all);
    let enough = limits().all;
    let registry = |limits: WasmLimits, body: &str| {
        let search = Search::builtin().with_limits(limits).with_builtin(false);
        let mut registry = Registry::search(&search).unwrap();
        let mut errors = Vec::new();
        for i in 0..4 {
            let wat = text(&format!("1.0.{i}"), &[("abi_version", body)], "");
            let bytes = wat::parse_str(&wat).unwrap();
            errors.extend(registry.add_wasm_bytes("test.htex", &bytes).err());
        }
        errors.iter().map(ToString::to_string).collect::<Vec<_>>().join("; ")
    };
    let sound = "(i32.const 0x48540100)";
    let grows = format!("(drop (memory.grow (i32.const 160))) {sound}");
    let counts = format!("(call $count (i32.const 2000000000)) {sound}");
    assert_eq!(registry(with(enough), sound), "");
    assert_eq!(registry(with(enough), &grows), "");
    for (body, all, said) in [
        (sound, enough.with_instances(3), "3 instances at a time"),
        (&grows, enough.with_memory_bytes(20 << 20), "20971520 bytes of memory together"),
        (&counts, enough.with_time(Duration::from_millis(100)), "used up the 100 ms"),
    ] {
        let errors = registry(with(all), body);
        assert!(errors.contains(said), "{errors}");
    }
}
