//! Integration tests, in one program.
#![allow(unreachable_pub, clippy::panic, clippy::unwrap_used, reason = "a failed test may panic")]

mod binary_readers;
mod common;
mod formats;
mod lab;
mod long_files;
mod maps;
mod readers;
mod tdms;
mod value_limit;
