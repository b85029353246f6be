//! The texture formats of others.

use htex_exchange::hatt::{Imported, asset, read};

use crate::promise::sentence;

/// A model file of the Penn Haptic Texture Toolkit: what is read becomes an asset that opens, and has finite magnitudes at each node.
pub fn hatt(input: &[u8]) -> bool {
    let imported = Imported {
        name: "fuzzed",
        tool: "fuzz",
    };
    let texture = match read(input) {
        Ok(texture) => texture,
        Err(fault) => return refused(&fault),
    };
    let made = match asset(&texture, &imported) {
        Ok(made) => made,
        Err(fault) => return refused(&fault),
    };
    let bytes = match made.to_bytes() {
        Ok(bytes) => bytes,
        Err(error) => return refused(&error),
    };
    let asset = htex::Asset::from_bytes(&bytes).expect("what was written opens");
    let grid = asset.band().grid_hz();
    for node in &texture.nodes {
        let motion = htex::Motion::new(node.speed_mm_s, node.force_n);
        let magnitude = asset.recorded_magnitude(None, Some(motion), &grid);
        if let Ok(magnitude) = magnitude {
            assert!(magnitude.iter().all(|m| m.is_finite() && *m >= 0.0));
        }
    }
    true
}

fn refused(error: &impl std::fmt::Display) -> bool {
    sentence(error);
    false
}
