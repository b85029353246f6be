//! Limits of WASM models.
//!
//! They limit memory, tables, stack, voices, time, the cost of compilation, the total of all
//! modules, and optionally the number of instructions. For each limit, a test in
//! `sdk/core/host/tests/it/limits.rs` exceeds it.

use std::path::PathBuf;
use std::time::Duration;

/// Limits of one WASM model. A call that exceeds a limit fails with an error that names the limit.
///
/// ```
/// use htex_host::{WasmCache, WasmLimits};
/// use std::time::Duration;
/// let limits = WasmLimits::default()
///     .with_memory_bytes(16 << 20)
///     .with_call(Duration::from_secs(1))
///     .with_cache(WasmCache::Off);
/// assert_eq!(limits.memory_bytes, 16 << 20);
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct WasmLimits {
    /// Largest module, bytes. Default 16 MiB (this project's models have 0.2 to 0.5 MiB).
    pub module_bytes: usize,
    /// Largest memory of one instance, bytes. Default 64 MiB.
    pub memory_bytes: usize,
    /// Maximum number of elements of one table. Default 10,000.
    pub table_elements: usize,
    /// Stack of WASM code, bytes. It is part of the calling thread's stack. Default 256 KiB.
    pub stack_bytes: usize,
    /// Maximum number of voices of one model at a time. Each has a separate instance. Default 256.
    pub voices: usize,
    /// Longest time of the module's start, and of one call that does not render. Default 5 s.
    pub call: Duration,
    /// Longest time of rendering 8,192 samples, or of one retune. Default 0.5 s: much longer than
    /// any device waits, and short enough to end an endless loop.
    pub render: Duration,
    /// Maximum number of WASM instructions of one call, or `None` for no limit. Unlike time, it is
    /// the same on every machine. Default `None`: the time limits suffice, and counting takes up to
    /// a tenth more time.
    pub fuel: Option<u64>,
    /// Longest time of compiling the module. Default 5 s. The time is estimated before compilation.
    /// A module that might exceed the limit is compiled without optimisation. If even that might
    /// exceed the limit, the module is refused.
    pub compile: Duration,
    /// Maximum memory for compiling a module, bytes, if [`WasmCompiler::Program`] compiles. Default
    /// 512 MiB. Modules within the estimated `compile` time need less.
    pub compile_bytes: usize,
    /// The compiler of modules. Default [`WasmCompiler::Here`].
    pub compiler: WasmCompiler,
    /// Total of all modules of one asset. Default 10 s, 512 MiB, 512 instances.
    pub asset: WasmTotal,
    /// Total of all modules of one registry and its clones, including the modules of assets.
    /// Default 30 s, 1 GiB, 2,048 instances.
    pub all: WasmTotal,
    /// Cache of compiled modules. Default [`WasmCache::User`].
    pub cache: WasmCache,
    /// The engine that runs modules. Default [`WasmEngine::Signals`].
    pub engine: WasmEngine,
    /// For checkers of models: makes a call fail that writes beyond its arrays within the module's
    /// own memory. Default no, because such a call harms only the module.
    pub guards: bool,
}

/// The engine that runs modules. The variants differ in the process resources that the engine uses.
/// While a module is loaded, every engine except `Off` has one thread that stops calls at their
/// time limit. Browsers have their own engine, which can only be on or off.
///
/// ```
/// use htex_host::{Registry, Search, WasmEngine, WasmLimits};
/// let limits = WasmLimits::default().with_engine(WasmEngine::Off);
/// let mut registry = Registry::search(&Search::builtin().with_limits(limits))?;
/// assert!(registry.add_wasm_bytes("a model", b"\0asm").is_err());
/// # Ok::<(), htex_host::HostError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum WasmEngine {
    /// Loading a module is an error. No thread, file or handler is created.
    Off,
    /// Modules run without signal handlers: each memory access is compared with its bound. The
    /// measures against speculative execution that rely on such handlers are off.
    Checked,
    /// Modules run with process-wide handlers for SIGSEGV, SIGILL, SIGFPE and SIGBUS. The handlers
    /// pass signals that no module caused to the previous handlers.
    Signals,
}

/// Limits that several modules share.
///
/// ```
/// use htex_host::{WasmLimits, WasmTotal};
/// use std::time::Duration;
/// let total = WasmTotal::new(Duration::from_secs(2), 64 << 20, 16);
/// assert_eq!(WasmLimits::default().with_asset(total).asset.instances, 16);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct WasmTotal {
    /// Time of compilation and of all calls except calls of voices. A tenth of the elapsed time is
    /// added to it. A voice has a separate time: one second, and ten times the duration of its
    /// samples.
    pub time: Duration,
    /// Memory of all live instances, bytes.
    pub memory_bytes: usize,
    /// Live instances: one per model, and one per voice.
    pub instances: usize,
}

impl WasmTotal {
    /// Limits of time, memory in bytes, and instances.
    pub const fn new(time: Duration, memory_bytes: usize, instances: usize) -> Self {
        Self { time, memory_bytes, instances }
    }

    htex_base::setters! {
        with_time(time: Duration);
        /// Sets the memory of all live instances, bytes.
        with_memory_bytes(memory_bytes: usize);
        /// Sets the number of live instances.
        with_instances(instances: usize);
    }
}

/// The compiler of modules.
///
/// ```no_run
/// use htex_host::{WasmCompiler, WasmLimits};
/// // This program calls `htex_host::serve_compiler` when its first argument is `compile`.
/// let program = std::env::current_exe()?;
/// let compiler = WasmCompiler::Program(program, vec!["compile".to_owned()]);
/// let limits = WasmLimits::default().with_compiler(compiler);
/// # Ok::<(), std::io::Error>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum WasmCompiler {
    /// This process. The limits `compile` and `compile_bytes` then apply only to an estimate.
    #[default]
    Here,
    /// Another process, which is stopped if it exceeds the limits of time or memory. The program
    /// must call `htex_host::serve_compiler` when it is started with these arguments.
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
            asset: WasmTotal::new(Duration::from_secs(10), 512 << 20, 512),
            all: WasmTotal::new(Duration::from_secs(30), 1 << 30, 2048),
            cache: WasmCache::User,
            engine: WasmEngine::Signals,
            guards: false,
        }
    }
}

impl WasmLimits {
    htex_base::setters! {
        /// Sets the largest module, bytes.
        with_module_bytes(module_bytes: usize);
        /// Sets the largest memory of one instance, bytes.
        with_memory_bytes(memory_bytes: usize);
        /// Sets the maximum number of elements of one table.
        with_table_elements(table_elements: usize);
        /// Sets the stack of WASM code, bytes.
        with_stack_bytes(stack_bytes: usize);
        /// Sets the maximum number of voices of one model at a time.
        with_voices(voices: usize);
        /// Sets the longest time of one call that does not render.
        with_call(call: Duration);
        /// Sets the longest time of rendering 8,192 samples, or of one retune.
        with_render(render: Duration);
    }

    /// Sets the maximum number of WASM instructions of one call, or `None` for no limit.
    #[must_use]
    pub fn with_fuel(mut self, fuel: impl Into<Option<u64>>) -> Self {
        self.fuel = fuel.into();
        self
    }

    htex_base::setters! {
        /// Sets the longest time of compiling a module.
        with_compile(compile: Duration);
        /// Sets the maximum memory for compiling a module, bytes.
        with_compile_bytes(compile_bytes: usize);
        with_compiler(compiler: WasmCompiler);
        /// Sets the total of all modules of one asset.
        with_asset(asset: WasmTotal);
        /// Sets the total of all modules of one registry and its clones.
        with_all(all: WasmTotal);
        with_cache(cache: WasmCache);
        /// Sets whether a call that writes beyond its arrays fails.
        with_guards(guards: bool);
        /// Sets the engine that runs modules.
        with_engine(engine: WasmEngine);
    }
}

/// Cache of compiled modules on disk.
///
/// A cached file is machine code that this program runs, so three measures protect it. The folder
/// is created with permissions for this user only (mode 0700). A folder that belongs to another
/// user, or that others may write to, is not used. Each file is authenticated with a key that only
/// this user can read (`wasm.key` in the user's configuration folder). A file that is damaged, or
/// was written by another version, is compiled again.
///
/// ```
/// use htex_host::{Search, WasmCache, WasmLimits};
/// let limits = WasmLimits::default().with_cache(WasmCache::Dir("/var/cache/player".into()));
/// let search = Search::default().with_limits(limits);
/// # assert_ne!(search.limits.cache, WasmCache::User);
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum WasmCache {
    /// `$HTEX_CACHE_DIR/wasm`, else `htex/wasm` in the user's cache folder.
    User,
    /// A folder that only this user may write to.
    Dir(PathBuf),
    /// Compiled modules are not stored.
    Off,
}
