//! Reservation of what an open device uses exclusively.

use std::collections::BTreeSet;
use std::sync::{Mutex, PoisonError};

use htex_device::DeviceError;

/// What each open device has reserved.
static CLAIMED: Mutex<BTreeSet<(String, String)>> = Mutex::new(BTreeSet::new());

/// A reservation. Dropping it releases it.
pub(crate) struct Claim((String, String));

impl Claim {
    /// Reserves a thing of a library, such as a vibrator.
    ///
    /// # Errors
    /// When another device has reserved it.
    pub(crate) fn take(library: &str, thing: &str) -> Result<Self, DeviceError> {
        let key = (library.to_owned(), thing.to_owned());
        let mut claimed = CLAIMED.lock().unwrap_or_else(PoisonError::into_inner);
        if claimed.insert(key.clone()) {
            Ok(Self(key))
        } else {
            Err(DeviceError::Busy(format!(
                "the {thing} is open already; finish or drop that device first"
            )))
        }
    }
}

impl Drop for Claim {
    fn drop(&mut self) {
        let mut claimed = CLAIMED.lock().unwrap_or_else(PoisonError::into_inner);
        claimed.remove(&self.0);
    }
}
