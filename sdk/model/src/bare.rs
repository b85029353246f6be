//! Targets without the standard library that are not WASM, such as microcontrollers: models are
//! used through their traits.

use core::cell::RefMut;
use core::marker::PhantomData;

/// A lock that is never acquired: this crate has no lock for such targets. Callers then compute the
/// value that they would share.
pub struct Lock<T>(PhantomData<fn() -> T>);

impl<T> Lock<T> {
    /// A lock without a value.
    pub const fn new(value: T) -> Self {
        core::mem::forget(value);
        Self(PhantomData)
    }

    /// Always `None`.
    pub fn lock(&self) -> Option<RefMut<'_, T>> {
        None
    }

    /// Always `None`.
    pub fn try_lock(&self) -> Option<RefMut<'_, T>> {
        None
    }
}

/// Expands to nothing: without an operating system there is no host that calls a model by its C
/// functions.
#[macro_export]
macro_rules! export_model {
    ($model:ty, symbols: $feature:literal $(, extensions: [motion])?) => {};
}
