//! Shutting down the library.

use crate::asset::ASSETS;
use crate::log::forget_log;
use crate::status::{Failure, guarded, htex_status};
use crate::voice::VOICES;

/// [no other call may run in any thread] Frees all objects, so that the library can be unloaded.
/// The call brings all devices to rest and frees them, and then frees all scenes, voices, assets
/// and libraries, in this order. It also ends the threads of the WASM engines and removes the
/// function that was set with htex_set_log. Existing handles become invalid, but new objects may be
/// made afterwards. The constants of the models that the program used stay in memory. For all six
/// built-in models together, these constants take 0.2 MB. If an object is in use, the call returns
/// HTEX_STATUS_BUSY. In this case, objects of the same kind, and of the kinds that come later in
/// the order above, are not freed.
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
        // The threads are ended last, because they stop calls of WASM modules that take too long.
        #[cfg(feature = "wasm")]
        htex::model::end_wasm_clocks();
        Ok::<_, Failure>(())
    })
}
