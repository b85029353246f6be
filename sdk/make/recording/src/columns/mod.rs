//! Columns of a file: their names, units and roles, and expressions over them.

pub(crate) mod assemble;
mod by_order;
pub(crate) mod channel_table;
pub(crate) mod clock;
pub(crate) mod expression;
pub(crate) mod find;
pub(crate) mod map;
pub(crate) mod motion;
pub(crate) mod names;
pub(crate) mod row_map;
pub(crate) mod select;
pub(crate) mod token;
