//! An asset in memory.

use crate::{Finding, Manifest};

/// One texture: its manifest, and the numbers that stand beside it.
#[derive(Debug, Clone, PartialEq)]
pub struct Asset {
    /// What it says of itself.
    pub manifest: Manifest,
    /// Parameters by representation and then by condition, in the order of
    /// [`crate::Representation::at`]: flat arrays in field order, a list preceded by its length.
    pub parameters: Vec<Vec<Vec<f64>>>,
    /// Recorded spectra by condition: magnitudes on the band's 5 Hz grid, in the
    /// asset's unit.
    pub reference: Option<Vec<Vec<f32>>>,
    /// WASM modules, in the order of [`crate::Manifest::plugins`].
    pub plugins: Vec<Vec<u8>>,
    /// What a reader should tell, such as a newer minor version.
    pub notes: Vec<Finding>,
}
