//! Targets without the standard library that are not WASM, such as microcontrollers. There, models
//! are used through their traits only.

use core::cell::RefMut;
use core::marker::PhantomData;

/// A lock that can never be acquired, because this crate has no lock for such targets. Callers then
/// compute the value again instead of sharing it.
pub struct Lock<T>(PhantomData<fn() -> T>);

impl<T> Lock<T> {
    /// Makes a lock; the value is discarded.
    pub const fn new(value: T) -> Self {
        // A `const fn` cannot drop a value of any type.
        core::mem::forget(value);
        Self(PhantomData)
    }

    /// Returns `None`.
    pub fn lock(&self) -> Option<RefMut<'_, T>> {
        None
    }

    /// Returns `None`.
    pub fn try_lock(&self) -> Option<RefMut<'_, T>> {
        None
    }
}

/// Expands to nothing: without an operating system, no host calls a model through C functions.
#[macro_export]
macro_rules! export_model {
    ($model:ty, symbols: $feature:literal $(, extensions: [motion])?) => {};
}
