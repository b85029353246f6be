//! The checks, grouped by subject.

pub(crate) mod describe;
pub(crate) mod end;
pub(crate) mod limit;
pub(crate) mod open;
pub(crate) mod read;
pub(crate) mod write;
