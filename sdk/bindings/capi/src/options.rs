//! Options for opening an asset and for making a voice.

use std::ffi::c_char;
use std::path::PathBuf;

use htex::model::{Search, WasmCache, WasmEngine, WasmLimits};
use htex::play::{Effects, Synthesis};
use htex::{Registry, VoiceOptions};

use crate::log::{htex_log_level, log};
use crate::motion::{htex_motion, motion};
use crate::pointers::{needed_text, slice, text};
use crate::signed::{Signed, signed};
use crate::status::{Failure, htex_status};

/// A block of bytes in memory.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct htex_bytes {
    /// The first byte.
    pub data: *const u8,
    /// Number of bytes.
    pub len: usize,
}

/// WASM modules are not loaded. A call that needs the model in such a module returns
/// HTEX_STATUS_NO_MODEL.
pub const HTEX_ENGINE_OFF: u32 = 0;
/// WASM modules run without signal handlers. Instead, the code of the modules checks the bounds of
/// each memory access.
pub const HTEX_ENGINE_CHECKED: u32 = 1;
/// WASM modules run with process-wide handlers for SIGSEGV, SIGBUS, SIGILL and SIGFPE. The handlers
/// stay installed after htex_shutdown, and pass on all signals that do not come from a module.
/// Modules run faster than with HTEX_ENGINE_CHECKED: for example, the model of
/// `examples/model-c-bursts` takes 34 ns per sample instead of 42 ns.
pub const HTEX_ENGINE_SIGNALS: u32 = 2;

/// Options for opening an asset or a scene. Set `size` to sizeof(htex_open_options), and all other
/// fields to zero for the defaults. The defaults use only the built-in models, which create no
/// threads, files or signal handlers.
///
/// Assets may embed models as WASM modules. To run them, turn on a WASM engine with `engine`. Only
/// the library in `lib/whole` contains an engine. Other builds return HTEX_STATUS_UNSUPPORTED if
/// `engine` turns on an engine. The engine compiles a module when it is first used, unless the
/// compiled module is in `cache`. Compiling takes 0.07 to 0.4 s for `examples/model-c-bursts`.
/// While a module is loaded, one thread wakes every 50 ms to stop calls that exceed their time
/// limit. Modules have limits: 64 MiB of memory per voice, 0.5 s per block of samples and 5 s to
/// compile.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct htex_open_options {
    /// sizeof(htex_open_options).
    pub size: u32,
    /// HTEX_ENGINE_OFF, HTEX_ENGINE_CHECKED or HTEX_ENGINE_SIGNALS.
    pub engine: u32,
    /// Paths of model files to load: native libraries or WASM modules. A native library runs with
    /// all rights of the program.
    pub plugins: *const *const c_char,
    /// Number of `plugins`.
    pub plugins_len: usize,
    /// Models as WASM modules in memory. The modules run in a sandbox. The library uses the bytes
    /// only during the call.
    pub modules: *const htex_bytes,
    /// Number of `modules`.
    pub modules_len: usize,
    /// Folder that keeps compiled WASM modules; NULL to keep none. The library creates the folder
    /// with access for this user only. It also creates a key that authenticates the files in the
    /// folder, and stores the key as `wasm.key` in the user's settings folder, such as
    /// `~/.config/htex`.
    pub cache: *const c_char,
    /// If not 0, WASM modules that are embedded in assets do not run, even if an engine is turned
    /// on.
    pub no_embedded: u32,
    /// If not 0, the library also loads installed models: from the folders in the environment
    /// variable HTEX_PLUGIN_PATH, and from the user's plugin folder.
    pub installed: u32,
    /// Public keys, each in 64 hexadecimal digits. If there are any, each texture must be signed by
    /// one of them: an asset that is opened, the library of a texture, and each texture of a scene.
    /// The signature of a file is in PATH.sig beside it, and in a scene in memory the file NAME.sig.
    /// Otherwise the call returns HTEX_STATUS_NOT_SIGNED.
    pub only_signed_by: *const *const c_char,
    /// Number of `only_signed_by`. 0 accepts textures without a signature.
    pub only_signed_by_len: usize,
    /// The contents of the file with the signature, for what has no PATH: an asset or a library in
    /// memory or behind a reader. The library uses the bytes only during the call.
    pub signature: htex_bytes,
}

/// Options for making a voice. Set `size` to sizeof(htex_voice_options), and all other fields to
/// zero for the defaults.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct htex_voice_options {
    /// sizeof(htex_voice_options).
    pub size: u32,
    /// Id or short name of the model whose representation plays; NULL selects the representation
    /// with the smallest error.
    pub model: *const c_char,
    /// Sample rate, Hz, at least twice the asset's highest frequency; 0 for 20000.
    pub rate_hz: f64,
    /// Seed of the noise. Voices with equal seeds, options and motions give equal samples.
    pub seed: u64,
    /// Motion at the start; NULL selects the first recorded condition, or the strongest one if the
    /// first is silent.
    pub motion: *const htex_motion,
    /// How samples are made. "streamed" (or NULL): the model computes each sample. "loop:SECONDS":
    /// a sound of this length is computed once and repeated. "filter:TAPS": noise goes through a
    /// filter with this number of taps.
    pub synthesis: *const c_char,
    /// Gain of the samples; 0 selects a gain of 1. htex_voice_set_gain changes the gain later.
    pub gain: f64,
    /// Largest absolute value of a sample after the gain, in the asset's unit; 0 for no limit. The
    /// gain drops at once when a sample would exceed the limit, and recovers with a time constant
    /// of 50 ms.
    pub limit: f64,
    /// Number of bands that htex_voice_envelope returns, 1 to 32. 0 switches the envelope off,
    /// which saves its computing time.
    pub envelope_bands: u32,
    /// If not 0, frequencies do not follow the asset's law at speeds outside the recorded range.
    pub no_frequency_scaling: u32,
    /// If not 0, the level does not follow the asset's law at speeds and forces outside the
    /// recorded ranges.
    pub no_level_scaling: u32,
    /// If not 0, the voice also plays while the finger is at rest.
    pub no_contact: u32,
    /// Highest level that the voice reaches at motions outside the recorded conditions, as a
    /// multiple of the strongest recorded level. Must be positive and finite; 0 selects 4.
    pub ceiling: f64,
    /// If not 0, the strength of the texture fluctuates over time as in its recording, if the asset
    /// contains this fluctuation. The fluctuation does not change the mean square of the samples.
    pub fluctuation: u32,
}

/// Reads the first `size` bytes of a struct of options, with zeros for the rest.
///
/// # Safety
/// The pointer is NULL, or points to a struct `T` that begins with its size, as a `u32`, and has
/// this many bytes.
pub(crate) unsafe fn options<T: Copy>(pointer: *const T, zeros: T) -> Result<T, Failure> {
    if pointer.is_null() {
        return Ok(zeros);
    }
    if !pointer.is_aligned() {
        return Err(Failure::argument("the options are misaligned"));
    }
    // Nothing else may be read yet, because the struct of an older program is shorter.
    // SAFETY: the struct begins with its size.
    let size = unsafe { pointer.cast::<u32>().read() } as usize;
    // 4096 is far more than any version of a struct has. The `size` of a larger one was never set.
    if !(size_of::<u32>()..=4096).contains(&size) {
        return Err(Failure::argument(
            "the options' `size` is wrong; set it to the sizeof of their struct",
        ));
    }
    let mut options = zeros;
    // SAFETY: both structs have at least this number of bytes; all fields are numbers and pointers,
    // for which zero is a valid value.
    unsafe {
        let to = (&raw mut options).cast::<u8>();
        to.copy_from_nonoverlapping(pointer.cast(), size.min(size_of::<T>()));
    }
    // A newer header may have more fields than this struct. They must have their default, zero.
    // SAFETY: `size` bytes are there.
    let rest = unsafe {
        let known = size_of::<T>().min(size);
        slice(pointer.cast::<u8>().add(known), size - known)
    }?;
    if rest.iter().any(|byte| *byte != 0) {
        return Err(Failure::plain(
            htex_status::HTEX_STATUS_UNSUPPORTED,
            "an option is set that this version of the library does not know; install a newer one",
        ));
    }
    Ok(options)
}

/// The models of a call, whether embedded models may run, and who must have signed what is opened.
pub(crate) struct Models {
    pub(crate) registry: Registry,
    pub(crate) embedded: bool,
    pub(crate) signed: Signed,
}

/// # Safety
/// As [`options`].
pub(crate) unsafe fn models(pointer: *const htex_open_options) -> Result<Models, Failure> {
    const ZEROS: htex_open_options = htex_open_options {
        size: 0,
        engine: HTEX_ENGINE_OFF,
        plugins: std::ptr::null(),
        plugins_len: 0,
        modules: std::ptr::null(),
        modules_len: 0,
        cache: std::ptr::null(),
        no_embedded: 0,
        installed: 0,
        only_signed_by: std::ptr::null(),
        only_signed_by_len: 0,
        signature: htex_bytes { data: std::ptr::null(), len: 0 },
    };
    // SAFETY: as here.
    let options = unsafe { options(pointer, ZEROS) }?;
    // SAFETY: the caller passed this array and its texts.
    let files: Result<_, _> = unsafe { slice(options.plugins, options.plugins_len) }?
        .iter()
        .map(|file| unsafe { needed_text(*file) }.map(PathBuf::from))
        .collect();
    // SAFETY: the caller passed this text.
    let cache = match unsafe { text(options.cache) }? {
        Some(folder) => WasmCache::Dir(folder.into()),
        None => WasmCache::Off,
    };
    // SAFETY: as here.
    let signed = unsafe { signed(&options) }?;
    let engine = engine(options.engine, htex::model::RUNS_WASM)?;
    let installed = options.installed != 0;
    let limits = WasmLimits::default().with_engine(engine).with_cache(cache);
    let search = Search::builtin()
        .with_limits(limits)
        .with_files(files?)
        .with_env(installed)
        .with_user_dir(installed);
    let mut registry = Registry::search(&search).map_err(htex::Error::from)?;
    // SAFETY: the caller passed this array.
    let modules = unsafe { slice(options.modules, options.modules_len) }?;
    for (index, module) in modules.iter().enumerate() {
        // SAFETY: the caller passed these bytes.
        let bytes = unsafe { slice(module.data, module.len) }?;
        let added = registry.add_wasm_bytes(&format!("module {index}"), bytes);
        added.map_err(htex::Error::from)?;
    }
    for note in registry.notes() {
        log(htex_log_level::HTEX_LOG_WARNING, &note.to_string());
    }
    let embedded = options.no_embedded == 0 && engine != WasmEngine::Off;
    Ok(Models { registry, embedded, signed })
}

/// Returns the engine for a number. If this build lacks the engine, this fails here rather than
/// when a module is first used.
fn engine(number: u32, is_built: bool) -> Result<WasmEngine, Failure> {
    match number {
        HTEX_ENGINE_CHECKED | HTEX_ENGINE_SIGNALS if !is_built => Err(Failure::plain(
            htex_status::HTEX_STATUS_UNSUPPORTED,
            "this libhtex has no engine of modules: link the whole library of `lib/whole` (pkg-config `htex-whole`, CMake `htex::whole`), \
             or set `engine` to HTEX_ENGINE_OFF",
        )),
        HTEX_ENGINE_OFF => Ok(WasmEngine::Off),
        HTEX_ENGINE_CHECKED => Ok(WasmEngine::Checked),
        HTEX_ENGINE_SIGNALS => Ok(WasmEngine::Signals),
        _ => Err(Failure::argument(
            "no engine of this number; give HTEX_ENGINE_OFF, HTEX_ENGINE_CHECKED or HTEX_ENGINE_SIGNALS",
        )),
    }
}

/// Reads the options of a voice: the model's name, and the rest.
///
/// # Safety
/// As in [`options`]. The text must stay valid as long as the result.
pub(crate) unsafe fn voice_options<'a>(
    pointer: *const htex_voice_options,
) -> Result<(Option<&'a str>, VoiceOptions), Failure> {
    const ZEROS: htex_voice_options = htex_voice_options {
        size: 0,
        model: std::ptr::null(),
        rate_hz: 0.0,
        seed: 0,
        motion: std::ptr::null(),
        synthesis: std::ptr::null(),
        gain: 0.0,
        limit: 0.0,
        envelope_bands: 0,
        no_frequency_scaling: 0,
        no_level_scaling: 0,
        no_contact: 0,
        ceiling: 0.0,
        fluctuation: 0,
    };
    // SAFETY: as here.
    let options = unsafe { options(pointer, ZEROS) }?;
    // SAFETY: as here.
    let (model, synthesis, motion) =
        unsafe { (text(options.model)?, text(options.synthesis)?, motion(options.motion)?) };
    let effects = Effects::default()
        .with_frequency_scaling(options.no_frequency_scaling == 0)
        .with_level_scaling(options.no_level_scaling == 0)
        .with_contact(options.no_contact == 0);
    let synthesis: Synthesis = match synthesis {
        Some(text) => text.parse().map_err(htex::Error::from)?,
        None => Synthesis::Streamed,
    };
    let mut voice = VoiceOptions::default()
        .with_seed(options.seed)
        .with_motion(motion)
        .with_synthesis(synthesis)
        .with_envelope_bands(options.envelope_bands as usize)
        .with_effects(effects)
        .with_fluctuation(options.fluctuation != 0);
    // Only an exact zero selects the default. NaN and negative numbers are passed on, and the
    // library refuses them.
    if options.rate_hz != 0.0 {
        voice = voice.with_rate_hz(options.rate_hz);
    }
    if options.ceiling != 0.0 {
        voice = voice.with_ceiling(options.ceiling);
    }
    if options.gain != 0.0 {
        voice = voice.with_gain(options.gain);
    }
    if options.limit != 0.0 {
        voice = voice.with_limit(options.limit);
    }
    Ok((model, voice))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_engine_that_is_not_built_is_refused_with_the_library_that_has_it() {
        for number in [HTEX_ENGINE_CHECKED, HTEX_ENGINE_SIGNALS] {
            let text = format!("{:?}", engine(number, false).err());
            for words in ["HTEX_STATUS_UNSUPPORTED", "lib/whole", "htex-whole"] {
                assert!(text.contains(words), "{text}");
            }
            assert!(engine(number, true).is_ok());
        }
        assert!(engine(HTEX_ENGINE_OFF, false).is_ok());
    }
}
