//! A cache of tables that depend only on a few parameters. All users with the same parameters share
//! one table. The cache also keeps the last few tables when they are not in use.

use alloc::sync::Arc;

/// Number of tables of one kind that stay in memory even if they are not in use. These are the
/// tables that were requested last. Therefore, an app that opens one texture after another computes
/// each table only once.
#[cfg(feature = "std")]
const KEPT: usize = 4;

/// A cache of tables by key. Without the feature `std`, the cache shares nothing, and each user has
/// its own table.
#[cfg(feature = "std")]
pub struct Shared<K, V: ?Sized>(std::sync::Mutex<Tables<K, V>>);

#[cfg(feature = "std")]
struct Tables<K, V: ?Sized> {
    in_use: alloc::vec::Vec<(K, std::sync::Weak<V>)>,
    /// The tables requested last, the most recent at the end.
    kept: alloc::vec::Vec<Arc<V>>,
}

#[cfg(feature = "std")]
impl<K: PartialEq, V: ?Sized> Shared<K, V> {
    #[allow(clippy::new_without_default)] // It is a static.
    pub const fn new() -> Self {
        Self(std::sync::Mutex::new(Tables {
            in_use: alloc::vec::Vec::new(),
            kept: alloc::vec::Vec::new(),
        }))
    }

    /// Returns the table for a key. Calls `make` if the table is neither in use nor cached.
    pub fn get(&self, key: K, make: impl FnOnce() -> Arc<V>) -> Arc<V> {
        // After a panic in another thread the lists are still valid, so a poisoned lock is ignored.
        let mut tables = self.0.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        let Tables { in_use, kept } = &mut *tables;
        let found = in_use.iter().find(|(known, _)| *known == key);
        let table = match found.and_then(|(_, table)| table.upgrade()) {
            Some(table) => table,
            None => {
                // The table is made while the lock is held. If another thread wants the same table,
                // it waits for this one instead of computing its own.
                let table = make();
                in_use.retain(|(_, table)| table.strong_count() > 0);
                in_use.push((key, Arc::downgrade(&table)));
                table
            }
        };
        kept.retain(|other| !Arc::ptr_eq(other, &table));
        if kept.len() == KEPT {
            kept.remove(0);
        }
        kept.push(table.clone());
        table
    }
}

/// A cache that stores nothing.
#[cfg(not(feature = "std"))]
pub struct Shared<K, V: ?Sized>(core::marker::PhantomData<(fn(K), fn() -> Arc<V>)>);

#[cfg(not(feature = "std"))]
impl<K, V: ?Sized> Shared<K, V> {
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
    fn tables_are_shared_while_in_use_and_the_last_ones_are_kept() {
        let tables = Shared::new();
        let get = |key, value| *tables.get(key, || Arc::new(value));
        let used = tables.get(1, || Arc::new(10));
        for key in 2..=5 {
            assert_eq!(get(key, 10 * key), 10 * key);
        }
        assert!(Arc::ptr_eq(&used, &tables.get(1, || Arc::new(11))));
        // The last four requested keys are 3, 4, 5 and 1.
        assert_eq!(get(3, 31), 30);
        assert_eq!(get(2, 21), 21);
        drop(used);
        // Now the last four requested keys are 5, 1, 3 and 2.
        assert_eq!(get(1, 12), 10);
        assert_eq!(get(4, 41), 41);
    }
}
