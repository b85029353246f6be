//! Writes the seeds of all fuzz targets into `fuzz/seeds`.
//!
//! `cargo run -p htex-fuzzing --example seeds`

use std::path::Path;

fn main() -> std::io::Result<()> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/seeds");
    for (target, name, bytes) in htex_fuzzing::seeds::seeds() {
        let place = folder.join(target);
        std::fs::create_dir_all(&place)?;
        std::fs::write(place.join(name), bytes)?;
    }
    Ok(())
}
