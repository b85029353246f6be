//! Parameter blocks of built-in models, each alone in an asset.

use std::sync::OnceLock;

use htex_author::stored_fields;
use htex_format::{Asset, AtCondition, Band, Condition, Manifest, Representation};
use htex_host::{LoadedModel, Registry};

use crate::asset::open;
use crate::container::container;

/// Opens an asset whose only block is the input. The input's first byte chooses the model, the
/// second the number of conditions and, by its highest bit, whether the asset is coded.
pub fn parameter_block(input: &[u8]) -> bool {
    let Some((&[model, conditions], block)) = input.split_first_chunk::<2>() else {
        return false;
    };
    static REGISTRY: OnceLock<Registry> = OnceLock::new();
    let models = REGISTRY.get_or_init(Registry::builtin).models();
    let mut manifest =
        manifest(&models[usize::from(model) % models.len()], 1 + usize::from(conditions % 4));
    if conditions & CODED != 0 {
        manifest = coded(manifest);
    }
    let json = serde_json::to_vec(&manifest).expect("a manifest is JSON");
    open(&container(&json, [("parameters.bin", block)]))
}

/// Bit of the second byte that chooses a coded asset.
pub(crate) const CODED: u8 = 0x80;

/// The manifest of the same asset, coded.
pub(crate) fn coded(manifest: Manifest) -> Manifest {
    let asset = Asset {
        manifest,
        parameters: Vec::new(),
        reference: None,
        plugins: Vec::new(),
        notes: Vec::new(),
    };
    asset.coded().manifest
}

/// The manifest of an asset with one model at some conditions.
pub(crate) fn manifest(model: &LoadedModel, conditions: usize) -> Manifest {
    let band = htex_host::Band::TACTILE;
    let condition = |i: usize| Condition {
        speed_mm_s: Some(40.0 + 40.0 * (i % 2) as f64),
        force_n: Some(0.3 + 0.3 * (i / 2) as f64),
        ..Condition::default()
    };
    let at =
        |condition: usize| AtCondition { condition, level_rms: 0.1, quality: None, left_out: None };
    Manifest {
        htex: htex_format::VERSION.to_owned(),
        name: "fuzzed".to_owned(),
        license: Some("CC0-1.0".to_owned()),
        author: None,
        tags: Vec::new(),
        description: None,
        source: None,
        doi: None,
        sensor: None,
        finger: None,
        contact: Default::default(),
        law: None,
        fluctuation: None,
        quantity: htex_format::Quantity::LateralForce,
        unit: htex_format::Quantity::LateralForce.unit().to_owned(),
        band: Band { low_hz: band.low_hz, high_hz: band.high_hz },
        provenance: Default::default(),
        conditions: (0..conditions).map(condition).collect(),
        representations: vec![Representation {
            model: model.id().to_owned(),
            model_version: model.descriptor().version.clone(),
            fields: stored_fields(model.descriptor()),
            at: (0..conditions).map(at).collect(),
            triangles: Vec::new(),
            parameters: "parameters.bin".to_owned(),
        }],
        reference: None,
        plugins: Vec::new(),
        extensions: Default::default(),
        extensions_required: Vec::new(),
        other: Default::default(),
    }
}
