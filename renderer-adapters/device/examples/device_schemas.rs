//! Writes `spec/schemas/device-*-1.json` from the Rust types.
//!
//! `cargo run -p htex-device --features schemars --example device_schemas`

use std::path::Path;
use std::{fs, io};

fn main() -> io::Result<()> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../spec/schemas");
    for (name, schema) in htex_device::schemas() {
        fs::write(folder.join(name), format!("{schema:#}\n"))?;
    }
    Ok(())
}
