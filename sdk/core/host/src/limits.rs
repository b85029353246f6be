//! Limits of WASM models.
//!
//! Each module has limits for its memory, tables, stack, number of voices, running time and
//! compilation, and optionally for its number of instructions. All modules together have limits for
//! their total time, memory and number of instances. The tests in
//! `sdk/core/host/tests/it/limits.rs` contain one case for each limit, in which the limit is
//! exceeded.

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
    /// Largest module, bytes. Default 16 MiB (this project's models are 0.2 to 0.5 MiB in size).
    pub module_bytes: usize,
    /// Largest memory of one instance, bytes. Default 64 MiB.
    pub memory_bytes: usize,
    /// Maximum number of elements of one table. Default 10,000.
    pub table_elements: usize,
    /// Largest stack of WASM code, bytes. This stack is part of the calling thread's stack. Default
    /// 256 KiB.
    pub stack_bytes: usize,
    /// Maximum number of voices of one model at a time. Each voice has a separate instance of the
    /// module. Default 256.
    pub voices: usize,
    /// Longest time of the module's start function, and of one call that does not render. Default 5
    /// s.
    pub call: Duration,
    /// Longest time of rendering 8,192 samples, or of one retune. Default 0.5 s. No device waits
    /// that long for samples, so the limit does not stop any useful call. But it soon ends an
    /// endless loop.
    pub render: Duration,
    /// Maximum number of WASM instructions of one call, or `None` for no limit. Unlike a time
    /// limit, this limit stops the same calls on every machine. Default `None`: the time limits
    /// suffice, and counting makes calls up to a tenth slower.
    pub fuel: Option<u64>,
    /// Longest time of compiling the module. Default 5 s. The host estimates the time before
    /// compilation. If the estimate exceeds this limit, the host compiles the module without
    /// optimisation. If the estimate for compilation without optimisation also exceeds the limit,
    /// the host refuses the module.
    pub compile: Duration,
    /// Maximum memory for compiling a module, bytes. The limit applies only to
    /// [`WasmCompiler::Program`]. Default 512 MiB. This suffices for every module whose estimated
    /// compilation time is within the default of `compile`.
    pub compile_bytes: usize,
    /// The compiler of modules. Default [`WasmCompiler::Here`].
    pub compiler: WasmCompiler,
    /// Limits that all modules of one asset share. Default 10 s, 512 MiB, 512 instances.
    pub asset: WasmTotal,
    /// Limits that all modules of one registry and its clones share, including the modules of
    /// assets. Default 30 s, 1 GiB, 2,048 instances.
    pub all: WasmTotal,
    /// Cache of compiled modules. Default [`WasmCache::User`].
    pub cache: WasmCache,
    /// The engine that runs modules. Default [`WasmEngine::Signals`].
    pub engine: WasmEngine,
    /// For checkers of models: whether the host returns an error when a call writes beyond its
    /// arrays but still within the module's own memory. Default false, because such a call harms
    /// only the module itself.
    pub guards: bool,
}

/// The engine that runs modules. The engines of the variants use different resources of the
/// process: threads and signal handlers. While a module is loaded, every engine except `Off` has
/// one thread, which stops calls at their time limit. A browser runs modules with its own engine;
/// `Off` turns that engine off, and the other variants turn it on.
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
    /// Every attempt to load a module returns an error. No thread, file or handler is created.
    Off,
    /// Modules run without signal handlers. Instead, the engine compares each memory access with
    /// the memory's bound. Without signal handlers, the engine also lacks some protections against
    /// attacks by speculative execution.
    Checked,
    /// Modules run with process-wide handlers for SIGSEGV, SIGILL, SIGFPE and SIGBUS. If a module
    /// did not cause the signal, these handlers pass the signal to the handlers that the process
    /// had before.
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
    /// Time for compilation and for all calls except calls to voices. While the program runs, the
    /// remaining time grows by a tenth of the elapsed time, but never above this total. Each voice
    /// has a separate allowance. The allowance starts at one second. Each rendered sample adds ten
    /// times the sample's duration, but the allowance never exceeds one second.
    pub time: Duration,
    /// Memory of all live instances, bytes.
    pub memory_bytes: usize,
    /// Number of live instances: one for each model, and one for each voice.
    pub instances: usize,
}

impl WasmTotal {
    /// Creates limits of time, memory (bytes) and live instances.
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
    /// This process compiles the module. Before compilation, the process compares an estimate of
    /// the time with the limit `compile`. It does not check the limit `compile_bytes`.
    #[default]
    Here,
    /// Another process compiles the module: the host starts this program with these arguments. The
    /// program must then call `htex_host::serve_compiler`. The host stops the process if
    /// compilation exceeds the limit of time or memory.
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
        /// Sets the largest stack of WASM code, bytes.
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
        /// Sets the limits that all modules of one asset share.
        with_asset(asset: WasmTotal);
        /// Sets the limits that all modules of one registry and its clones share.
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
/// A cached file is machine code that this program runs, so three measures protect the cache.
/// First, the program creates the folder with permissions for this user only (mode 0700). Second,
/// the program uses the folder only if it belongs to this user and no other user may write to it.
/// Third, the program authenticates each file with a key that only this user can read (`wasm.key`
/// in the user's configuration folder). If a cached file is damaged, or another version wrote it,
/// the program compiles the module again.
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
    /// The folder `$HTEX_CACHE_DIR/wasm`. If the variable is not set, the cache is `htex/wasm` in
    /// the user's cache folder.
    User,
    /// The given folder. No other user may have permission to write to the folder.
    Dir(PathBuf),
    /// The program does not store compiled modules.
    Off,
}
