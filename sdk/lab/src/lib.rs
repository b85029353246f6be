//! Runs experiments with textures: guided recordings, measurements of the frequency response of a
//! setup, and rating studies.
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
#![forbid(unsafe_code)]

mod error;
pub mod page;
pub mod record;
pub mod response;
pub mod study;

pub use error::LabError;
