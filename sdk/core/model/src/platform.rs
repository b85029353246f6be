//! Platform services that the exported functions need: locks, the last error, and catching panics.

pub use here::Lock;
pub(crate) use here::{Once, caught, with_last_error};

/// Targets with the standard library. They have several threads, and panics unwind.
#[cfg(feature = "std")]
mod here {
    use alloc::string::{String, ToString};
    use core::cell::RefCell;
    use std::panic::{AssertUnwindSafe, catch_unwind};
    use std::sync::{Mutex, MutexGuard, PoisonError, TryLockError};

    pub(crate) use std::sync::OnceLock as Once;

    use crate::{Error, Status, text};

    std::thread_local! {
        static LAST_ERROR: RefCell<String> = const { RefCell::new(String::new()) };
    }

    /// A mutex that ignores poisoning, for data that several voices or calls of a model share.
    pub struct Lock<T>(Mutex<T>);

    impl<T> Lock<T> {
        /// Makes a lock that contains a value.
        pub const fn new(value: T) -> Self {
            Self(Mutex::new(value))
        }

        /// Locks the value. Never returns `None` on this platform. (In a WASM module, this function
        /// returns `None` if the lock is already held.)
        pub fn lock(&self) -> Option<MutexGuard<'_, T>> {
            Some(self.0.lock().unwrap_or_else(PoisonError::into_inner))
        }

        /// Locks the value without waiting. Returns `None` if another holder has the lock.
        pub fn try_lock(&self) -> Option<MutexGuard<'_, T>> {
            match self.0.try_lock() {
                Ok(value) => Some(value),
                Err(TryLockError::Poisoned(poisoned)) => Some(poisoned.into_inner()),
                Err(TryLockError::WouldBlock) => None,
            }
        }
    }

    /// Runs a call and turns a panic into an error.
    pub(crate) fn caught<T>(call: impl FnOnce() -> Result<T, Error>) -> Result<T, Error> {
        // In the ABI, the effect of a call that panics is undefined. Therefore, a panic may leave
        // the state only partly changed.
        catch_unwind(AssertUnwindSafe(call)).unwrap_or_else(|panic| {
            let message = panic
                .downcast_ref::<&str>()
                .map(ToString::to_string)
                .or_else(|| panic.downcast_ref::<String>().cloned())
                .unwrap_or_default();
            let message = text!["the model panicked: ", message.as_str()];
            Err(Error::new(Status::Panicked, message))
        })
    }

    /// Passes the text of this thread's last error to `with`. Returns `None` if the text is already
    /// in use.
    pub(crate) fn with_last_error<T>(with: impl FnOnce(&mut String) -> T) -> Option<T> {
        LAST_ERROR.with(|last| last.try_borrow_mut().ok().map(|mut text| with(&mut text)))
    }
}

/// WASM modules. They have one thread, and a panic ends the instance.
#[cfg(not(feature = "std"))]
mod here {
    use alloc::string::String;
    use core::cell::{OnceCell, RefCell, RefMut};

    use crate::Error;

    static LAST_ERROR: Lock<String> = Lock::new(String::new());

    /// A lock for data that several voices or calls of a model share.
    pub struct Lock<T>(RefCell<T>);

    // SAFETY: a module has one thread. It imports nothing, so its memory is not shared.
    unsafe impl<T> Sync for Lock<T> {}

    impl<T> Lock<T> {
        /// Makes a lock that contains a value.
        pub const fn new(value: T) -> Self {
            Self(RefCell::new(value))
        }

        /// Locks the value. Returns `None` if the lock is already held.
        pub fn lock(&self) -> Option<RefMut<'_, T>> {
            self.0.try_borrow_mut().ok()
        }

        /// Locks the value without waiting. Returns `None` if the lock is already held.
        pub fn try_lock(&self) -> Option<RefMut<'_, T>> {
            self.lock()
        }
    }

    pub(crate) struct Once<T>(OnceCell<T>);

    // SAFETY: as above.
    unsafe impl<T> Sync for Once<T> {}

    impl<T> Once<T> {
        pub(crate) const fn new() -> Self {
            Self(OnceCell::new())
        }

        pub(crate) fn get(&self) -> Option<&T> {
            self.0.get()
        }

        pub(crate) fn get_or_init(&self, make: impl FnOnce() -> T) -> &T {
            self.0.get_or_init(make)
        }
    }

    /// Runs a call. A panic ends the instance.
    pub(crate) fn caught<T>(call: impl FnOnce() -> Result<T, Error>) -> Result<T, Error> {
        call()
    }

    /// Passes the text of the last error to `with`. Returns `None` if the text is already in use.
    pub(crate) fn with_last_error<T>(with: impl FnOnce(&mut String) -> T) -> Option<T> {
        LAST_ERROR.lock().map(|mut text| with(&mut text))
    }
}
