//! Reservation of gamepads: each belongs to one open device. SDL itself lets any number of users
//! change its motors.

use std::collections::BTreeSet;
use std::sync::{Mutex, PoisonError};

use htex_device::DeviceError;

use crate::sdl::driver::Driver;
use crate::sdl::pads::Pad;

/// Library and instance of each open gamepad.
static CLAIMED: Mutex<BTreeSet<(String, i32)>> = Mutex::new(BTreeSet::new());

/// A reserved gamepad. Dropping it releases the gamepad.
pub(crate) struct Claim((String, i32));

impl Claim {
    pub(crate) fn take(driver: &Driver, pad: &Pad) -> Result<Self, DeviceError> {
        let key = (driver.path.clone(), pad.instance);
        let mut claimed = CLAIMED.lock().unwrap_or_else(PoisonError::into_inner);
        if claimed.insert(key.clone()) {
            Ok(Self(key))
        } else {
            Err(DeviceError::Busy(format!(
                "{} is open already; finish or drop that device first",
                pad.name
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
