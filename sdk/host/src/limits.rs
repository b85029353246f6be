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
    /// Longest time of compiling the module. Default 5 s. A module that might take longer, as estimated before it is
    /// compiled, is compiled quickly and runs slower; one that might then still take longer is refused.
    pub compile: Duration,
    /// Most memory of compiling a module, bytes, where [`WasmCompiler::Program`] compiles. Default 512 MiB, which the
    /// estimate of `compile` keeps as well.
    pub compile_bytes: usize,
    /// What compiles. Default [`WasmCompiler::Here`].
    pub compiler: WasmCompiler,
    /// What all modules of one asset may use together. Default 10 s, 512 MiB, 512 instances.
    pub asset: WasmTotal,
    /// What all modules of one registry and its clones may use together, those of assets included. Default 30 s,
    /// 1 GiB, 2,048 instances.
    pub all: WasmTotal,
    /// Where compiled modules are kept. Default [`WasmCache::User`].
    pub cache: WasmCache,
}

/// What several modules may use together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct WasmTotal {
    /// Time of compiling and of all calls that are no voice's. It comes back at a tenth of the time that passes. A
    /// voice has ten times as long as what it renders lasts, and a second more.
    pub time: Duration,
    /// Memory of all instances that live at a time, bytes.
    pub memory_bytes: usize,
    /// Instances that live at a time: one a model, and one a voice.
    pub instances: usize,
}

/// What compiles modules.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub enum WasmCompiler {
    /// This process, which holds `compile` and `compile_bytes` by an estimate alone.
    #[default]
    Here,
    /// Another process, which is stopped where it takes more time or memory than it may: a program that calls
    /// `htex_host::serve_compiler` when it is started with these arguments.
    Program(PathBuf, Vec<String>),
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
            compile: Duration::from_secs(5),
            compile_bytes: 512 << 20,
            compiler: WasmCompiler::Here,
            asset: WasmTotal {
                time: Duration::from_secs(10),
                memory_bytes: 512 << 20,
                instances: 512,
            },
            all: WasmTotal {
                time: Duration::from_secs(30),
                memory_bytes: 1 << 30,
                instances: 2048,
            },
            cache: WasmCache::User,
        }
    }
}

/// Where compiled modules are kept, so that a module is compiled once a machine.
///
/// What lies there is machine code that this program runs. So the folder is made for this user alone (mode 0700); one
/// of another user, or that others may write to, is not used; and each file is authenticated with a key that this user
/// alone can read (`wasm.key` in the user's configuration folder). A file that was damaged, or made by another
/// version, is compiled again.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum WasmCache {
    /// `$HTEX_CACHE_DIR/wasm`, else `htex/wasm` in the user's cache folder.
    User,
    /// A folder, which this user alone may write to.
    Dir(PathBuf),
    /// Compiled modules are not kept.
    Off,
}
