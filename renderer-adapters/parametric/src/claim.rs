//! What an open device has to itself.

use std::collections::BTreeSet;
use std::sync::{Mutex, PoisonError};

use htex_device::DeviceError;

/// What each open device has.
static CLAIMED: Mutex<BTreeSet<(String, String)>> = Mutex::new(BTreeSet::new());

/// Released when dropped.
pub(crate) struct Claim((String, String));

impl Claim {
    /// Takes a thing of a library.
    ///
    /// # Errors
    /// When another device has it.
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
