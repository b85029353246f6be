//! Replacements for the parts of the standard library that this crate needs. They are for targets
//! without a standard library other than WASM, such as microcontrollers. On these targets, programs
//! call models only through the Rust traits.

use core::cell::RefMut;
use core::marker::PhantomData;

/// A lock that can never be acquired, because this crate has no lock for targets without the
/// standard library. Callers therefore compute a value each time instead of sharing it.
pub struct Lock<T>(PhantomData<fn() -> T>);

impl<T> Lock<T> {
    /// Makes a lock; the value is discarded.
    pub const fn new(value: T) -> Self {
        // A `const fn` cannot drop a value of any type.
        core::mem::forget(value);
        Self(PhantomData)
    }

    /// Always returns `None`.
    pub fn lock(&self) -> Option<RefMut<'_, T>> {
        None
    }

    /// Always returns `None`.
    pub fn try_lock(&self) -> Option<RefMut<'_, T>> {
        None
    }
}

/// This macro generates nothing, because without an operating system no host calls a model through
/// C functions.
#[macro_export]
macro_rules! export_model {
    ($model:ty, symbols: $feature:literal $(, extensions: [motion])?) => {};
}
