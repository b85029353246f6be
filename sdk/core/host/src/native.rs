//! Models in native libraries (`.so`, `.dylib`, `.dll`).
//!
//! A native library runs with all the rights of this program. Therefore, the host loads only
//! libraries that the user named or put into a plugin folder. The host never unloads such a
//! library, because voices and tables contain pointers into it.

use std::path::Path;

use htex_base::native::{Library, Symbols, table_of_symbols};
use htex_model::abi::{AbiVersion, ModelTable};
use htex_model::motion_1::MotionTable;
use htex_model::voices_1::VoicesTable;

use crate::HostError;
use crate::raw::check_marker;
use crate::table::TableModel;

/// Loads a library and fills a table from its symbols.
///
/// # Errors
/// If the file is not a library for this machine, or lacks a symbol of the model ABI.
pub(crate) fn load(path: &Path) -> Result<TableModel, HostError> {
    let origin = path.display().to_string();
    let error = |what: String| HostError::Load { path: origin.clone(), what };
    // SAFETY: the user allowed the library's initialisers to run by naming the file or its folder.
    let library = unsafe { Library::from_file(path) }.map_err(|e| error(e.to_string()))?;
    let symbols = Symbols {
        library,
        missing: &|name| HostError::NoFunction { path: origin.clone(), name: name.to_owned() },
    };
    // SAFETY: every version of the ABI has this function with this type.
    let abi_version: AbiVersion = unsafe { symbols.get("htex_model_abi_version")? };
    // The marker is checked before the other names are looked up, because in another major version
    // these names may be missing or have other types.
    check_marker(&origin, abi_version())?;
    // SAFETY: a library with this marker exports these names with these types.
    let table: &'static ModelTable = Box::leak(Box::new(unsafe {
        table_of_symbols!(
            symbols, ModelTable, "htex_model_",
            abi_version descriptor last_error fit magnitude interpolate
            voice_rate voice_new voice_render voice_retune voice_free extension
        )
    }));
    // SAFETY: a live slice.
    let has = |id: &str| unsafe { (table.extension)(id.as_ptr(), id.len()) } == 1;
    let mut voices = None;
    if has(VoicesTable::ID) {
        // SAFETY: a library with this extension exports this name with this type.
        let table = unsafe { table_of_symbols!(symbols, VoicesTable, "htex_voices_1_", render) };
        voices = Some(&*Box::leak(Box::new(table)));
    }
    let mut motion = None;
    if has(MotionTable::ID) {
        // SAFETY: a library with this extension exports these names with these types.
        let table = unsafe { table_of_symbols!(symbols, MotionTable, "htex_motion_1_", set fit) };
        motion = Some(&*Box::leak(Box::new(table)));
    }
    Ok(TableModel::new(table, voices, motion))
}
