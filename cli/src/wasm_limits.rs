//! Limits of WASM models by name, as a person gives them.

use std::time::Duration;

use htex_host::WasmLimits;

/// One limit and its value.
#[derive(Debug, Clone, Copy)]
pub(crate) struct WasmLimit {
    set: Set,
    value: u64,
}

/// Sets a limit to a value.
type Set = fn(&mut WasmLimits, u64);

/// Name, largest value, and what it sets.
const LIMITS: [(&str, u64, Set); 8] = [
    ("module-mib", 1024, |l, n| {
        l.module_bytes = (n as usize) << 20
    }),
    ("memory-mib", 4096, |l, n| {
        l.memory_bytes = (n as usize) << 20
    }),
    ("table-elements", 10_000_000, |l, n| {
        l.table_elements = n as usize
    }),
    ("stack-kib", 1024, |l, n| l.stack_bytes = (n as usize) << 10),
    ("voices", 100_000, |l, n| l.voices = n as usize),
    ("call-ms", 86_400_000, |l, n| {
        l.call = Duration::from_millis(n)
    }),
    ("render-ms", 86_400_000, |l, n| {
        l.render = Duration::from_millis(n)
    }),
    ("fuel", u64::MAX / 2, |l, n| l.fuel = Some(n)),
];

impl WasmLimit {
    /// Reads `NAME=VALUE`.
    pub(crate) fn parse(text: &str) -> Result<Self, String> {
        let (name, value) = text.split_once('=').unwrap_or((text, ""));
        let Some((_, most, set)) = LIMITS.iter().find(|(known, ..)| *known == name) else {
            let known: Vec<&str> = LIMITS.iter().map(|(name, ..)| *name).collect();
            return Err(format!(
                "there is no limit `{name}`; there are {}",
                known.join(", ")
            ));
        };
        match value.parse() {
            Ok(value) if (1..=*most).contains(&value) => Ok(Self { set: *set, value }),
            _ => Err(format!("`{name}` takes a whole number from 1 to {most}")),
        }
    }

    /// The default limits with these changed.
    pub(crate) fn all(given: &[Self]) -> WasmLimits {
        let mut limits = WasmLimits::default();
        given
            .iter()
            .for_each(|limit| (limit.set)(&mut limits, limit.value));
        limits
    }
}
