//! The memory of fenced arrays on systems other than 64-bit Linux: an ordinary vector without
//! protected pages.

use crate::harness::Finding;

/// Values in a vector.
pub(crate) struct Pages<T>(Vec<T>);

impl<T: Copy + Default> Pages<T> {
    pub(crate) fn new(len: usize, _: Finding) -> Self {
        Self(vec![T::default(); len])
    }

    pub(crate) fn get(&mut self) -> &mut [T] {
        &mut self.0
    }
}
