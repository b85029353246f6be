//! What the exported functions need of the machine: locks, the last error, and an end to panics.

pub use here::Lock;
pub(crate) use here::{Once, caught, with_last_error};

/// Several threads, and panics that unwind.
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

    /// What voices and calls of a model share: a mutex, whatever panicked while it was held.
    pub struct Lock<T>(Mutex<T>);

    impl<T> Lock<T> {
        /// Around a value.
        pub const fn new(value: T) -> Self {
            Self(Mutex::new(value))
        }

        /// The value, for as long as the guard lives; `None` where this thread has it already and
        /// that is known.
        pub fn lock(&self) -> Option<MutexGuard<'_, T>> {
            Some(self.0.lock().unwrap_or_else(PoisonError::into_inner))
        }

        /// The value; `None` where another has it now. Does not wait.
        pub fn try_lock(&self) -> Option<MutexGuard<'_, T>> {
            match self.0.try_lock() {
                Ok(value) => Some(value),
                Err(TryLockError::Poisoned(poisoned)) => Some(poisoned.into_inner()),
                Err(TryLockError::WouldBlock) => None,
            }
        }
    }

    /// Runs a call; a panic becomes an error.
    pub(crate) fn caught<T>(call: impl FnOnce() -> Result<T, Error>) -> Result<T, Error> {
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

    /// The last error's text of this thread; `None` while it is in use.
    pub(crate) fn with_last_error<T>(with: impl FnOnce(&mut String) -> T) -> Option<T> {
        LAST_ERROR.with(|last| last.try_borrow_mut().ok().map(|mut text| with(&mut text)))
    }
}

/// A module: one thread, and panics that trap.
#[cfg(not(feature = "std"))]
mod here {
    use alloc::string::String;
    use core::cell::{OnceCell, RefCell, RefMut};

    use crate::Error;

    static LAST_ERROR: Lock<String> = Lock::new(String::new());

    /// What voices and calls of a model share.
    pub struct Lock<T>(RefCell<T>);

    // SAFETY: a module has one thread. It imports nothing, so no memory that others share either.
    unsafe impl<T> Sync for Lock<T> {}

    impl<T> Lock<T> {
        /// Around a value.
        pub const fn new(value: T) -> Self {
            Self(RefCell::new(value))
        }

        /// The value, for as long as the guard lives; `None` where this thread has it already and
        /// that is known.
        pub fn lock(&self) -> Option<RefMut<'_, T>> {
            self.0.try_borrow_mut().ok()
        }

        /// The value; `None` where another has it now. Does not wait.
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

    /// Runs a call; a panic ends the instance.
    pub(crate) fn caught<T>(call: impl FnOnce() -> Result<T, Error>) -> Result<T, Error> {
        call()
    }

    /// The last error's text; `None` while it is in use.
    pub(crate) fn with_last_error<T>(with: impl FnOnce(&mut String) -> T) -> Option<T> {
        LAST_ERROR.lock().map(|mut text| with(&mut text))
    }
}
