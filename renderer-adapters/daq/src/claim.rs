//! Reservation of outputs: each belongs to one open device. The driver reserves an output only
//! while a task runs, and a device is open before that.

use std::collections::BTreeSet;
use std::sync::{Mutex, PoisonError};

use htex_device::DeviceError;

use crate::rig::Rig;

/// Driver and output of each open device.
static CLAIMED: Mutex<BTreeSet<(String, String)>> = Mutex::new(BTreeSet::new());

/// Released when dropped.
pub(crate) struct Claim((String, String));

impl Claim {
    pub(crate) fn take(rig: &Rig) -> Result<Self, DeviceError> {
        let key = (rig.driver.clone(), rig.device.clone());
        let mut claimed = CLAIMED.lock().unwrap_or_else(PoisonError::into_inner);
        if claimed.insert(key.clone()) {
            Ok(Self(key))
        } else {
            Err(DeviceError::Busy(format!(
                "{} is open already; finish or drop that device first",
                rig.device
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
