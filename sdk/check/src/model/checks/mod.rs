//! The checks, grouped by subject.

pub(crate) mod abi;
pub(crate) mod allocation;
pub(crate) mod arrays;
pub(crate) mod change;
pub(crate) mod fit;
pub(crate) mod fuzz;
pub(crate) mod magnitude;
pub(crate) mod motion;
pub(crate) mod often;
pub(crate) mod range;
pub(crate) mod refusal;
pub(crate) mod repeat;
pub(crate) mod resources;
pub(crate) mod sound;
pub(crate) mod successor;
pub(crate) mod together;
pub(crate) mod twin;
pub(crate) mod waiting;
