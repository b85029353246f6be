//! Models in native libraries (`.so`, `.dylib`, `.dll`).
//!
//! A native library runs with all rights of this program, so only libraries that the user chose are loaded. They
//! are loaded once and never unloaded, because voices and tables point into them.

use std::path::Path;

use htex_model::abi::{
    AbiVersion, DescriptorJson, ExtensionFn, FitFn, InterpolateFn, LastError, MagnitudeFn,
    ModelTable, VoiceFreeFn, VoiceNewFn, VoiceRateFn, VoiceRenderFn, VoiceRetuneFn,
};
use htex_model::motion_1::{MotionFitFn, MotionSetFn, MotionTable};
use htex_model::voices_1::{VoicesRenderFn, VoicesTable};
use htex_native::Library;

use crate::HostError;
use crate::marker::check_marker;
use crate::table::TableModel;

/// Loads a library and fills a table from its symbols.
///
/// # Errors
/// When the file is not a library for this machine, or lacks a symbol of the model ABI.
pub(crate) fn load(path: &Path) -> Result<TableModel, HostError> {
    let origin = path.display().to_string();
    let error = |what: String| HostError::Load {
        path: origin.clone(),
        what,
    };
    // SAFETY: the user allowed the library's initialisers to run by naming the file or its folder.
    let library = unsafe { Library::from_file(path) }.map_err(|e| error(e.to_string()))?;
    // SAFETY: every version of the ABI has this function with this type.
    let abi_version: AbiVersion = unsafe { symbol(library, "htex_model_abi_version", &error)? };
    check_marker(&origin, abi_version())?;
    // SAFETY: a library with this marker exports these names with these types.
    let table: &'static ModelTable = Box::leak(Box::new(unsafe {
        ModelTable {
            abi_version,
            descriptor: symbol::<DescriptorJson>(library, "htex_model_descriptor", &error)?,
            last_error: symbol::<LastError>(library, "htex_model_last_error", &error)?,
            fit: symbol::<FitFn>(library, "htex_model_fit", &error)?,
            magnitude: symbol::<MagnitudeFn>(library, "htex_model_magnitude", &error)?,
            interpolate: symbol::<InterpolateFn>(library, "htex_model_interpolate", &error)?,
            voice_rate: symbol::<VoiceRateFn>(library, "htex_model_voice_rate", &error)?,
            voice_new: symbol::<VoiceNewFn>(library, "htex_model_voice_new", &error)?,
            voice_render: symbol::<VoiceRenderFn>(library, "htex_model_voice_render", &error)?,
            voice_retune: symbol::<VoiceRetuneFn>(library, "htex_model_voice_retune", &error)?,
            voice_free: symbol::<VoiceFreeFn>(library, "htex_model_voice_free", &error)?,
            extension: symbol::<ExtensionFn>(library, "htex_model_extension", &error)?,
        }
    }));
    // SAFETY: a live slice.
    let has = |id: &str| unsafe { (table.extension)(id.as_ptr(), id.len()) } == 1;
    let mut voices = None;
    if has(VoicesTable::ID) {
        // SAFETY: a library with this extension exports this name with this type.
        let render = unsafe { symbol::<VoicesRenderFn>(library, "htex_voices_1_render", &error)? };
        voices = Some(&*Box::leak(Box::new(VoicesTable { render })));
    }
    let model = TableModel::new(table, voices);
    if !has(MotionTable::ID) {
        return Ok(model);
    }
    // SAFETY: a library with this extension exports these names with these types.
    let motion = Box::leak(Box::new(unsafe {
        MotionTable {
            set: symbol::<MotionSetFn>(library, "htex_motion_1_set", &error)?,
            fit: symbol::<MotionFitFn>(library, "htex_motion_1_fit", &error)?,
        }
    }));
    Ok(model.with_motion(motion))
}

/// The address of a symbol.
///
/// # Safety
/// The symbol has the type `T`.
unsafe fn symbol<T: Copy>(
    library: Library,
    name: &str,
    error: &impl Fn(String) -> HostError,
) -> Result<T, HostError> {
    // SAFETY: guaranteed by the caller.
    let found = unsafe { library.symbol(name) };
    found.ok_or_else(|| {
        error(format!(
            "the library has no `{name}`; it is not an htex model"
        ))
    })
}
