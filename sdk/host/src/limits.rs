//! What a WASM model may use of this machine.

use std::path::PathBuf;
use std::time::Duration;

/// What one WASM model may use. A model that goes over a limit fails in that call; the message names
/// the limit.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct WasmLimits {
    /// Largest module, bytes. Default 16 MiB (the models of this project have 0.2 to 0.5 MiB).
    pub module_bytes: usize,
    /// Largest memory of one instance, bytes. Default 64 MiB.
    pub memory_bytes: usize,
    /// Most elements of one table. Default 10,000.
    pub table_elements: usize,
    /// Stack of WASM code, bytes, taken of the calling thread's own. Default 256 KiB.
    pub stack_bytes: usize,
    /// Most voices of one model at a time; each is an instance of its own. Default 256.
    pub voices: usize,
    /// Longest time of one call that does not render, and of the module's start. Default 5 s.
    pub call: Duration,
    /// Longest time of rendering 8,192 samples, or of one retune. Default 0.5 s: far over what any
    /// device waits for, and short enough to get an application back from an endless loop.
    pub render: Duration,
    /// Most WASM instructions of one call, if given: unlike time, the same on every machine.
    /// Default none: the deadlines hold already, and counting costs up to a tenth more.
    pub fuel: Option<u64>,
    /// Where compiled modules are kept. Default [`WasmCache::User`].
    pub cache: WasmCache,
}

impl Default for WasmLimits {
    fn default() -> Self {
        Self {
            module_bytes: 16 << 20,
            memory_bytes: 64 << 20,
            table_elements: 10_000,
            stack_bytes: 256 << 10,
            voices: 256,
            call: Duration::from_secs(5),
            render: Duration::from_millis(500),
            fuel: None,
            cache: WasmCache::User,
        }
    }
}

/// Where compiled modules are kept, so that a module is compiled once a machine.
///
/// What lies there is machine code that this program runs: whoever can write to the folder can run
/// code as this user. So it is made for this user alone (mode 0700), and a folder that others may
/// write to is not used. A file that was damaged, or made by another version, is compiled again.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum WasmCache {
    /// `$HTEX_CACHE_DIR/wasm`, else `htex/wasm` in the user's cache folder.
    User,
    /// A folder, which this user alone may write to.
    Dir(PathBuf),
    /// Compiled modules are not kept.
    Off,
}
