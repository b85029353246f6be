//! Shutting down the library.

use crate::asset::ASSETS;
use crate::log::forget_log;
use crate::status::{Failure, guarded, htex_status};
use crate::voice::VOICES;

/// [no other call may run in any thread] Prepares the library for being unloaded. It frees all
/// assets, voices, libraries, scenes and devices (which go to rest), and all memory allocated for
/// them. It ends the engines' threads and removes the function of htex_set_log. Existing handles
/// become invalid; new objects may be made afterwards. Constants of the models that were used
/// remain: 0.2 MB for all six, and no more with later use. HTEX_STATUS_BUSY if an object is in use;
/// then no object of its kind is freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_shutdown() -> htex_status {
    guarded(|| {
        // SAFETY: the caller makes no other call.
        unsafe {
            #[cfg(feature = "scene")]
            {
                // First, so that the devices go to rest even if another object is in use.
                crate::device::clear()?;
                crate::scene::clear()?;
            }
            VOICES.clear()?;
            ASSETS.clear()?;
            #[cfg(all(feature = "library", not(target_family = "wasm")))]
            crate::library::clear()?;
        }
        forget_log();
        // Last, because the clocks stop calls of modules that take too long.
        #[cfg(feature = "wasm")]
        htex::model::end_wasm_clocks();
        Ok::<_, Failure>(())
    })
}
