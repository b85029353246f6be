//! The texture formats of others.
#![forbid(unsafe_code)]

pub mod hatt;
