//! Reservation of outputs: each output belongs to one open device. The driver itself reserves an
//! output only while a task runs, but a device is already open before that.

use std::collections::BTreeSet;
use std::sync::{Mutex, PoisonError};

use htex_device::DeviceError;

use crate::daq::rig::Rig;

/// The driver and the output of each open device.
static CLAIMED: Mutex<BTreeSet<(String, String)>> = Mutex::new(BTreeSet::new());

/// A reserved output. Dropping it releases the output.
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
