//! `include/htex.h` is that of the functions, and its contents are frozen.
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

use std::path::Path;

/// The header as the functions are now.
fn header() -> String {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let config = cbindgen::Config::from_file(folder.join("cbindgen.toml")).unwrap();
    let bindings = cbindgen::generate_with_config(folder, config).unwrap();
    let mut bytes = Vec::new();
    bindings.write(&mut bytes);
    String::from_utf8(bytes).unwrap()
}

#[test]
fn generated_header_is_fresh() {
    xtask::generated::file("sdk/capi/include/htex.h", header().as_bytes());
}
