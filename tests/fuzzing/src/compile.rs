//! Modules that take a long time to compile.

use std::time::{Duration, Instant};

use htex_host::{LoadedModel, WasmCache, WasmLimits};

use crate::body::Bytes;
use crate::heavy::Heavy;
use crate::module::model;
use crate::promise::sentence;

/// Allowed compile time by the estimate, which assumes a machine three times as slow.
const ALLOWED: Duration = Duration::from_millis(300);
/// Hard limit. It is generous, because the programs are built with counters and run next to other
/// programs.
const NEVER: Duration = Duration::from_secs(6);

/// Loads a valid model with an extra function. One byte each describes its locals, depth, nests,
/// copies, kinds of blocks and statements. A function within the limits must compile in the allowed
/// time.
pub fn compile_limits(input: &[u8]) -> bool {
    let mut bytes = Bytes(input);
    let squared = |byte: u8| usize::from(byte) * usize::from(byte) / 32;
    let mut heavy = Heavy {
        locals: squared(bytes.next()) / 2,
        depth: 1 + squared(bytes.next()),
        nests: 1 + squared(bytes.next()),
        copies: 1 + usize::from(bytes.next()),
        ..Heavy::default()
    };
    let [blocks, head] = [bytes.next() % 4, bytes.next() % 8].map(usize::from);
    heavy.blocks = (0..=blocks).map(|_| bytes.next()).collect();
    heavy.head = (0..head).map(|_| bytes.next()).collect();
    heavy.end = bytes.0.iter().take(8).copied().collect();
    if !heavy.is_bounded() {
        return false;
    }
    let text = model::text("1.0.0", &[], &heavy.text());
    let module = wat::parse_str(&text)
        .unwrap_or_else(|e| panic!("the maker of functions is wrong: {e}\n{heavy:?}"));
    let limits = WasmLimits::default().with_compile(ALLOWED).with_cache(WasmCache::Off);
    let load = || {
        let start = Instant::now();
        let loaded = LoadedModel::from_wasm_bytes("heavy.wasm", &module, &limits);
        (start.elapsed(), loaded)
    };
    let (mut took, loaded) = load();
    // Other programs may have taken the processors, but hardly three times.
    for _ in 0..2 {
        took = if took < NEVER { took } else { load().0 };
    }
    assert!(took < NEVER, "{took:?} for {} bytes: {heavy:?}", module.len());
    match loaded {
        Ok(_) => true,
        Err(error) => {
            sentence(&error);
            false
        }
    }
}
