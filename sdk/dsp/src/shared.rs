//! Tables that depend on a few numbers alone, made once and shared while they are in use.

use alloc::sync::Arc;

/// Tables by their keys. Without `std` each user has its own.
#[cfg(feature = "std")]
pub struct Shared<K, V: ?Sized>(std::sync::Mutex<alloc::vec::Vec<(K, std::sync::Weak<V>)>>);

#[cfg(feature = "std")]
impl<K: PartialEq, V: ?Sized> Shared<K, V> {
    /// None yet.
    #[allow(clippy::new_without_default)] // It is a static.
    pub const fn new() -> Self {
        Self(std::sync::Mutex::new(alloc::vec::Vec::new()))
    }

    /// The table of a key, made if nobody uses it.
    pub fn get(&self, key: K, make: impl FnOnce() -> Arc<V>) -> Arc<V> {
        // The list is whole whatever a panicking thread was doing.
        let mut in_use = self
            .0
            .lock()
            .unwrap_or_else(std::sync::PoisonError::into_inner);
        let found = in_use.iter().find(|(known, _)| *known == key);
        if let Some(table) = found.and_then(|(_, table)| table.upgrade()) {
            return table;
        }
        let table = make();
        in_use.retain(|(_, table)| table.strong_count() > 0);
        in_use.push((key, Arc::downgrade(&table)));
        table
    }
}

/// No tables.
#[cfg(not(feature = "std"))]
pub struct Shared<K, V: ?Sized>(core::marker::PhantomData<(fn(K), fn() -> Arc<V>)>);

#[cfg(not(feature = "std"))]
impl<K, V: ?Sized> Shared<K, V> {
    /// None.
    #[allow(clippy::new_without_default)] // It is a static.
    pub const fn new() -> Self {
        Self(core::marker::PhantomData)
    }

    /// Makes the table.
    pub fn get(&self, _: K, make: impl FnOnce() -> Arc<V>) -> Arc<V> {
        make()
    }
}

#[cfg(all(test, feature = "std"))]
mod tests {
    use super::*;

    #[test]
    fn a_table_in_use_is_shared_and_another_is_another() {
        let tables = Shared::new();
        let one = tables.get(1, || Arc::new(10));
        assert!(Arc::ptr_eq(&one, &tables.get(1, || Arc::new(11))));
        assert_eq!(*tables.get(2, || Arc::new(20)), 20);
        drop(one);
        assert_eq!(*tables.get(1, || Arc::new(12)), 12);
    }
}
