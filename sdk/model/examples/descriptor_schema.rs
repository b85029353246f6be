//! Writes `spec/schemas/descriptor-1.json` from the Rust types.
//!
//! `cargo run -p htex-model --features schemars --example descriptor_schema`

use std::path::Path;
use std::{fs, io};

fn main() -> io::Result<()> {
    let schemas = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../spec/schemas");
    let text = format!("{:#}\n", htex_model::descriptor_schema());
    fs::write(schemas.join("descriptor-1.json"), text)
}
