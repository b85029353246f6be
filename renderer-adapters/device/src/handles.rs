//! The open devices of an adapter, addressed by handles. The number of a closed handle is never
//! used again.
//!
//! A lock protects each open device, because opening and writing may block. The voices of a model
//! must not block, so they use slots and generations instead (`sdk/core/model/src/voices.rs`).

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

type Shared<T> = Arc<Mutex<T>>;

/// The open devices of one adapter.
pub(crate) struct Handles<T>(Mutex<Open<T>>);

struct Open<T> {
    last: i64,
    shared: BTreeMap<i64, Shared<T>>,
}

impl<T> Handles<T> {
    /// Creates an empty table.
    pub(crate) const fn new() -> Self {
        Self(Mutex::new(Open { last: 0, shared: BTreeMap::new() }))
    }

    /// Adds an open device and returns its handle.
    pub(crate) fn insert(&self, one: T) -> i64 {
        let mut open = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        open.last += 1;
        let handle = open.last;
        open.shared.insert(handle, Arc::new(Mutex::new(one)));
        handle
    }

    /// Calls a function with the device behind a handle. Returns `None` if the handle was
    /// closed or never existed.
    pub(crate) fn with<R>(&self, handle: i64, call: impl FnOnce(&mut T) -> R) -> Option<R> {
        // The table's lock is released before the call, so that a call that blocks does not block
        // the other handles.
        let shared = {
            let open = self.0.lock().unwrap_or_else(PoisonError::into_inner);
            open.shared.get(&handle).cloned()?
        };
        let mut one = shared.lock().unwrap_or_else(PoisonError::into_inner);
        Some(call(&mut one))
    }

    pub(crate) fn remove(&self, handle: i64) -> Option<Shared<T>> {
        let mut open = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        // The device is not dropped here, because a drop may block while the table is locked.
        open.shared.remove(&handle)
    }
}
