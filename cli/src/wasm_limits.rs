//! Limits of WASM models, by name on the command line.

use std::path::PathBuf;
use std::time::Duration;

use htex_host::{WasmCompiler, WasmLimits};

use crate::failure::Result;
use crate::invocation;

/// One limit with its value.
#[derive(Debug, Clone, Copy)]
pub(crate) struct WasmLimit {
    set: Set,
    value: u64,
}

/// The subcommand that compiles modules.
const COMPILE: &str = "compile-module";

/// Sets a limit to a value.
type Set = fn(&mut WasmLimits, u64);

/// The name, the largest value, and the function that sets the limit.
const LIMITS: [(&str, u64, Set); 16] = [
    ("module-mib", 1024, |l, n| l.module_bytes = (n as usize) << 20),
    ("memory-mib", 4096, |l, n| l.memory_bytes = (n as usize) << 20),
    ("table-elements", 10_000_000, |l, n| l.table_elements = n as usize),
    ("stack-kib", 1024, |l, n| l.stack_bytes = (n as usize) << 10),
    ("voices", 100_000, |l, n| l.voices = n as usize),
    // The largest value of every limit of time is a day.
    ("call-ms", 86_400_000, |l, n| l.call = Duration::from_millis(n)),
    ("render-ms", 86_400_000, |l, n| l.render = Duration::from_millis(n)),
    ("fuel", u64::MAX / 2, |l, n| l.fuel = Some(n)),
    ("compile-ms", 86_400_000, |l, n| l.compile = Duration::from_millis(n)),
    ("compile-mib", 65_536, |l, n| l.compile_bytes = (n as usize) << 20),
    ("asset-ms", 86_400_000, |l, n| l.asset.time = Duration::from_millis(n)),
    ("asset-mib", 65_536, |l, n| l.asset.memory_bytes = (n as usize) << 20),
    ("asset-instances", 100_000, |l, n| l.asset.instances = n as usize),
    ("all-ms", 86_400_000, |l, n| l.all.time = Duration::from_millis(n)),
    ("all-mib", 65_536, |l, n| l.all.memory_bytes = (n as usize) << 20),
    ("all-instances", 100_000, |l, n| l.all.instances = n as usize),
];

impl WasmLimit {
    /// Parses `NAME=VALUE`. A build without the WASM engine refuses every limit.
    pub(crate) fn parse(text: &str) -> Result<Self, String> {
        if cfg!(not(feature = "wasm")) {
            return Err(
                "this program was built without the engine of WASM modules, so there is nothing to limit; \
                 leave the flag out, or build with the Cargo feature `wasm`"
                    .to_owned(),
            );
        }
        let (name, value) = text.split_once('=').unwrap_or((text, ""));
        let Some((_, most, set)) = LIMITS.iter().find(|(known, ..)| *known == name) else {
            let known: Vec<&str> = LIMITS.iter().map(|(name, ..)| *name).collect();
            return Err(format!("unknown limit `{name}`; known are {}", known.join(", ")));
        };
        match value.parse() {
            Ok(value) if (1..=*most).contains(&value) => Ok(Self { set: *set, value }),
            _ => Err(format!("`{name}` takes a whole number from 1 to {most}")),
        }
    }

    /// Returns the default limits with these changes. Another process of this program compiles the
    /// modules, unless the program is unknown.
    pub(crate) fn all(given: &[Self]) -> WasmLimits {
        let mut limits = WasmLimits::default();
        if let Some((program, arguments)) = compiler() {
            limits.compiler = WasmCompiler::Program(program, arguments);
        }
        given.iter().for_each(|limit| (limit.set)(&mut limits, limit.value));
        limits
    }
}

/// Returns the program that compiles modules, and its arguments. `None` if the program is unknown
/// or has arguments that are not Unicode.
fn compiler() -> Option<(PathBuf, Vec<String>)> {
    let program = invocation::program().ok()?;
    let words = program.arguments.into_iter().map(|word| word.into_string().ok());
    let arguments: Option<Vec<String>> = words.chain([Some(COMPILE.to_owned())]).collect();
    Some((program.file.into(), arguments?))
}
