//! Experiments with textures: guided recordings, responses of a setup, studies and their analysis.
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
#![forbid(unsafe_code)]

pub mod analyse;
pub mod page;
pub mod record;
pub mod response;
pub mod study;
