//! A small model in WebAssembly text, whose functions a test can replace.
#![allow(dead_code)] // Other crates' tests use a part of it.

use std::time::Duration;

use htex_host::{HostError, LoadedModel, WasmCache, WasmLimits};

pub(crate) const ID: &str = "org.example.hostile";

/// The name, signature and valid body of each function.
pub(crate) const FUNCTIONS: &[(&str, &str, &str)] = &[
    ("abi_version", "(result i32)", "(i32.const 0x48540100)"),
    (
        "descriptor",
        "(param i32 i32) (result i64)",
        "(if (i32.ge_u (local.get 1) (i32.const $LEN)) (then
           (memory.copy (local.get 0) (i32.const 16) (i32.const $LEN))))
         (i64.const $LEN)",
    ),
    ("last_error", "(param i32 i32) (result i64)", "(i64.const 0)"),
    (
        "fit",
        "(param f64 f64 i32 i32 i32 i32 i32 f64 i32 i32 i32 i32 i32) (result i64)",
        "(f64.store (local.get 10) (f64.const 0.5))
         (f64.store (local.get 12) (f64.const 1))
         (i64.const 1)",
    ),
    (
        "magnitude",
        "(param i32 i32 f64 f64 i32 i32 i32) (result i64)",
        "(memory.fill (local.get 5) (i32.const 0) (i32.shl (local.get 6) (i32.const 3)))
         (i64.const 0)",
    ),
    (
        "interpolate",
        "(param i32 i32 i32 i32 i32 i32) (result i64)",
        "(f64.store (local.get 4) (f64.load (local.get 0)))
         (i64.const 1)",
    ),
    ("voice_rate", "(param i32 i32 f64 f64 f64) (result f64)", "(local.get 4)"),
    ("voice_new", "(param i32 i32 f64 f64 f64 i64) (result i64)", "(i64.const 1)"),
    (
        "voice_render",
        "(param i64 i32 i32) (result i64)",
        "(memory.fill (local.get 1) (i32.const 0x3e) (i32.shl (local.get 2) (i32.const 2)))
         (i64.const 0)",
    ),
    ("voice_retune", "(param i64 i32 i32) (result i64)", "(i64.const 0)"),
    ("voice_free", "(param i64) (result i64)", "(i64.const 0)"),
    ("extension", "(param i32 i32) (result i64)", "(i64.const 0)"),
    (
        "alloc",
        "(param i32) (result i32)",
        "(global.get $heap)
         (global.set $heap (i32.add (global.get $heap) (local.get 0)))",
    ),
    ("free", "(param i32 i32)", ""),
];

/// Value of the model's samples: the bytes 3e3e3e3e.
pub(crate) const SAMPLE: f32 = f32::from_bits(0x3e3e_3e3e);

/// Returns the text of a model with this version. `changed` replaces the bodies of some functions,
/// and `fields` adds fields to the module.
pub(crate) fn text(version: &str, changed: &[(&str, &str)], fields: &str) -> String {
    let json = format!(
        r#"{{"id":"{ID}","name":"H","version":"{version}","summary":"S.","fields":[{{"name":"x","unit":"1","kind":{{"type":"scalar"}},"min":0,"max":1,"store":{{"type":"f32"}},"description":"X."}}]}}"#
    );
    with_descriptor(&json, changed, fields)
}

/// Returns the text of a model as [`text`] does, but with another descriptor.
pub(crate) fn with_descriptor(json: &str, changed: &[(&str, &str)], fields: &str) -> String {
    let mut functions = String::new();
    for (name, signature, body) in FUNCTIONS {
        let body = changed
            .iter()
            .find(|(n, _)| n == name)
            .map_or(*body, |(_, b)| b)
            .replace("$LEN", &json.len().to_string());
        functions += &format!("(func (export \"htex_model_{name}\") {signature} {body})\n");
    }
    let data = json.replace('"', "\\\"");
    format!(
        "(module (memory (export \"memory\") 8)
         (data (i32.const 16) \"{data}\")
         (global $heap (mut i32) (i32.const 65536))
         (func $deep (param i32) (result i32)
           (if (result i32) (local.get 0)
             (then (i32.add (i32.const 1) (call $deep (i32.sub (local.get 0) (i32.const 1)))))
             (else (i32.const 0))))
         (func $count (param i32)
           (loop $again
             (local.set 0 (i32.sub (local.get 0) (i32.const 1)))
             (br_if $again (local.get 0))))
         {fields} {functions})"
    )
}

/// Short times and no cache.
pub(crate) fn limits() -> WasmLimits {
    WasmLimits::default()
        .with_call(Duration::from_millis(200))
        .with_render(Duration::from_millis(100))
        .with_cache(WasmCache::Off)
}

pub(crate) fn load_within(wat: &str, limits: &WasmLimits) -> Result<LoadedModel, HostError> {
    LoadedModel::from_wasm_bytes("test.htex", &wat::parse_str(wat).unwrap(), limits)
}

/// Loads the model with the bodies of some functions replaced.
pub(crate) fn load(changed: &[(&str, &str)]) -> Result<LoadedModel, HostError> {
    load_within(&text("1.0.0", changed, ""), &limits())
}
