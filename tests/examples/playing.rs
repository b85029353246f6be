//! Writes what players are tested against: `spec/models` and `spec/playing-conformance`.
//!
//! `cargo run -p htex-tests --example playing`
#![allow(clippy::unwrap_used, clippy::panic)] // A program for developers: a failure may end it.

#[path = "../tests/common/playing/mod.rs"]
mod playing;

use std::fs;

fn main() -> std::io::Result<()> {
    for folder in [playing::models_folder(), playing::cases_folder()] {
        if folder.exists() {
            fs::remove_dir_all(&folder)?;
        }
        fs::create_dir_all(&folder)?;
    }
    for (path, bytes) in playing::files() {
        fs::write(path, bytes)?;
    }
    Ok(())
}
