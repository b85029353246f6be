//! An asset in memory.

use crate::Manifest;
use htex_base::finding::Finding;

/// One texture: its manifest, parameters, reference spectra and embedded modules.
///
/// ```
/// use htex_format::{Asset, Manifest};
///
/// let manifest: Manifest = serde_json::from_str(r#"{
///     "htex": "1.0",
///     "name": "Cotton",
///     "license": "CC0-1.0",
///     "quantity": "lateral_force",
///     "unit": "N",
///     "band": { "low_hz": 20, "high_hz": 1000 },
///     "conditions": [{ "speed_mm_s": 80, "force_n": 0.4 }],
///     "representations": [{
///         "model": "org.htex.sbeta",
///         "model_version": "1.0.0",
///         "fields": [{ "name": "alpha", "store": "f32" }, { "name": "beta", "store": "f32" }],
///         "at": [{ "condition": 0, "level_rms": 0.02 }],
///         "parameters": "parameters/sbeta.bin"
///     }]
/// }"#)?;
/// let asset = Asset {
///     manifest,
///     parameters: vec![vec![vec![1.5, 4.0]]],
///     reference: None,
///     plugins: Vec::new(),
///     notes: Vec::new(),
/// };
/// let bytes = asset.to_bytes()?;
/// assert_eq!(Asset::from_bytes(&bytes)?, asset);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Asset {
    /// The contents of `manifest.json`.
    pub manifest: Manifest,
    /// The parameter sets of each representation: one for each condition, in the order of
    /// [`crate::Representation::at`]. A parameter set is a flat array with the values of all
    /// fields, in the order of the fields. The length of a list precedes the values of the list.
    pub parameters: Vec<Vec<Vec<f64>>>,
    /// The recorded spectrum of each condition: magnitudes on the band's 5 Hz grid, in the asset's
    /// unit.
    pub reference: Option<Vec<Vec<f32>>>,
    /// WASM modules, in the order of [`crate::Manifest::plugins`].
    pub plugins: Vec<Vec<u8>>,
    /// Findings of the reader that are not errors, e.g. that the file has a newer minor version.
    pub notes: Vec<Finding>,
}
