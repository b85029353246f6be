//! The numbers of a block, read in place.

/// Little-endian single-precision numbers at any alignment.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Words<'a>(&'a [[u8; 4]]);

impl<'a> Words<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        Self(bytes.as_chunks::<4>().0)
    }

    pub(crate) fn len(self) -> usize {
        self.0.len()
    }

    /// Returns the number at an index, or zero beyond the end.
    pub(crate) fn get(self, index: usize) -> f32 {
        self.0.get(index).map_or(0.0, |word| f32::from_le_bytes(*word))
    }

    /// Returns the last number, or zero if there is none.
    pub(crate) fn last(self) -> f32 {
        self.get(self.len().saturating_sub(1))
    }

    /// Returns `count` numbers from an index on, or none if they extend beyond the end.
    pub(crate) fn part(self, from: usize, count: usize) -> Self {
        let end = from.saturating_add(count);
        Self(self.0.get(from..end).unwrap_or(&[]))
    }

    pub(crate) fn iter(self) -> impl DoubleEndedIterator<Item = f32> + ExactSizeIterator + 'a {
        self.0.iter().map(|word| f32::from_le_bytes(*word))
    }

    /// Returns the numbers in groups of four.
    pub(crate) fn fours(self) -> impl Iterator<Item = [f32; 4]> + 'a {
        let fours = self.0.as_chunks::<4>().0.iter();
        fours.map(|four| four.map(f32::from_le_bytes))
    }
}

/// Little-endian 16-bit integers at any alignment, read as single-precision numbers.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Integers<'a>(&'a [[u8; 2]]);

impl<'a> Integers<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        Self(bytes.as_chunks::<2>().0)
    }

    /// Returns the number at an index, or zero beyond the end.
    pub(crate) fn get(self, index: usize) -> f32 {
        self.0.get(index).map_or(0.0, |integer| f32::from(i16::from_le_bytes(*integer)))
    }

    /// Returns `count` numbers from an index on, or none if they extend beyond the end.
    pub(crate) fn part(self, from: usize, count: usize) -> Self {
        let end = from.saturating_add(count);
        Self(self.0.get(from..end).unwrap_or(&[]))
    }

    pub(crate) fn iter(self) -> impl ExactSizeIterator<Item = f32> + 'a {
        let integers = self.0.iter();
        integers.map(|integer| f32::from(i16::from_le_bytes(*integer)))
    }
}
