//! The end of the use of the library.

use crate::asset::ASSETS;
use crate::log::forget_log;
use crate::status::{Failure, guarded, htex_status};
use crate::voice::VOICES;

/// [no other call may run in any thread] Frees all assets, voices, libraries, scenes and devices
/// (which go to rest), and all memory that was allocated for them, ends the threads of engines and
/// forgets the function of htex_set_log, so that the library can be unloaded. Handles from before
/// are bad afterwards, and new objects may be made. Constants of the models that were used stay:
/// 0.2 MB for all six, and no more with later use. HTEX_STATUS_BUSY, and nothing is freed of that
/// kind, if an object is in use.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_shutdown() -> htex_status {
    guarded(|| {
        // SAFETY: the caller makes no other call.
        unsafe {
            #[cfg(feature = "scene")]
            {
                crate::device::clear()?;
                crate::scene::clear()?;
            }
            VOICES.clear()?;
            ASSETS.clear()?;
            #[cfg(all(feature = "library", not(target_family = "wasm")))]
            crate::library::clear()?;
        }
        forget_log();
        #[cfg(feature = "wasm")]
        htex::host::end_wasm_clocks();
        Ok::<_, Failure>(())
    })
}
