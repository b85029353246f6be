//! Open devices behind handles, which are never used twice.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use crate::Device;

type Shared = Arc<Mutex<Box<dyn Device>>>;

/// The open devices of one adapter.
pub(crate) struct Handles(Mutex<Open>);

struct Open {
    last: i64,
    devices: BTreeMap<i64, Shared>,
}

impl Handles {
    /// Without open devices.
    pub(crate) const fn new() -> Self {
        Self(Mutex::new(Open {
            last: 0,
            devices: BTreeMap::new(),
        }))
    }

    /// Adds a device; returns its handle.
    pub(crate) fn insert(&self, device: Box<dyn Device>) -> i64 {
        let mut open = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        open.last += 1;
        let handle = open.last;
        open.devices.insert(handle, Arc::new(Mutex::new(device)));
        handle
    }

    /// Calls the device behind a handle; `None` if it was closed or never was.
    pub(crate) fn with<R>(
        &self,
        handle: i64,
        call: impl FnOnce(&mut dyn Device) -> R,
    ) -> Option<R> {
        let shared = {
            let open = self.0.lock().unwrap_or_else(PoisonError::into_inner);
            open.devices.get(&handle).cloned()?
        };
        let mut device = shared.lock().unwrap_or_else(PoisonError::into_inner);
        Some(call(&mut **device))
    }

    /// Removes a device.
    pub(crate) fn remove(&self, handle: i64) -> Option<Shared> {
        let mut open = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        open.devices.remove(&handle)
    }
}
