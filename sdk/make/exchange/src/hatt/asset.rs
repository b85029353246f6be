//! Converts a texture of the Penn Haptic Texture Toolkit to an asset.

use htex_author::{new_asset, representation};
use htex_dsp::grid::{Band, GRID_HZ, curve_level_rms};
use htex_dsp::line_spectrum::{coefficients_of_lines, line_spectral_frequencies, zeros_of_lines};
use htex_dsp::linear_prediction::{ar_magnitude, is_stable};
use htex_format::{
    Asset, AtCondition, Condition, Contact, Provenance, Quantity, Steps, StoredAs, round_within,
};
use htex_host::Registry;

use super::extension::{EXTENSION, Hatt};
use super::node::Node;
use super::texture::{Texture, read};
use crate::error::Fault;
use crate::format::Naming;
use crate::import::ImportedAsset;

const MODEL: &str = "org.htex.arma";

/// Reads a model file of the toolkit as an asset.
pub(crate) fn import(bytes: &[u8], naming: &Naming<'_>) -> Result<ImportedAsset, Fault> {
    let texture = read(bytes)?;
    Ok(ImportedAsset::new(asset(&texture, naming)?, None, texture.notes))
}

/// Converts a texture of the toolkit to an asset. The asset has no licence, because the toolkit's
/// files contain none.
///
/// # Errors
/// Returns an error if a filter cannot be stored because its poles or zeros are too close to each
/// other.
pub fn asset(texture: &Texture, naming: &Naming<'_>) -> Result<Asset, Fault> {
    let registry = Registry::builtin();
    let model = registry.find(MODEL).map_err(|error| Fault::whole(error.to_string()))?;
    let mut representation = representation(model, Vec::new());
    if let Some(rate) = representation.fields.last_mut() {
        // The sample rate is the same at all nodes, so one byte for each node is enough.
        rate.store = StoredAs::U8(Steps { scale: texture.rate_hz, offset: 0.0, log: false });
    }
    let band = band(texture.rate_hz);
    let mut parameters = Vec::new();
    for (condition, node) in texture.nodes.iter().enumerate() {
        let flat = flat(node, texture.rate_hz)?;
        let stored = round_within(&representation.fields, model.descriptor(), &flat)
            .map_err(|error| fault(node, error.to_string()))?;
        let level_rms = level_rms(node, &stored, texture.rate_hz, band)?;
        let at = AtCondition { condition, level_rms, quality: None, left_out: None };
        representation.at.push(at);
        parameters.push(stored);
    }
    representation.triangles.clone_from(&texture.triangles);
    let condition = |node: &Node| Condition {
        speed_mm_s: Some(node.speed_mm_s),
        force_n: Some(node.force_n),
        ..Condition::default()
    };
    let conditions = texture.nodes.iter().map(condition).collect();
    let provenance = Provenance {
        tool: naming.tool.to_owned(),
        warnings: texture.notes.clone(),
        ..Provenance::default()
    };
    let name = if texture.material.is_empty() { naming.name } else { &texture.material };
    let models = vec![(representation, parameters)];
    let quantity = Quantity::Acceleration;
    let mut asset = new_asset(name, quantity, band, provenance, conditions, models);
    let manifest = &mut asset.manifest;
    manifest.source = Some("Penn Haptic Texture Toolkit".to_owned());
    manifest.finger = Some("a rigid tool".to_owned());
    manifest.contact = Contact::Tool;
    let numbers = serde_json::to_value(Hatt::new(texture))
        .map_err(|error| Fault::whole(error.to_string()))?;
    manifest.extensions.insert(EXTENSION.to_owned(), numbers);
    Ok(asset)
}

/// Returns the tactile band, limited to the frequencies that the sample rate of the filters can
/// represent.
fn band(rate_hz: f64) -> Band {
    Band { high_hz: (0.5 * rate_hz).min(Band::TACTILE.high_hz), ..Band::TACTILE }
}

/// Returns the model parameters of a node.
fn flat(node: &Node, rate_hz: f64) -> Result<Vec<f64>, Fault> {
    let lines = |coefficients: &[f64], what: &str| {
        let negated: Vec<f64> = coefficients.iter().map(|a| -a).collect();
        line_spectral_frequencies(&negated)
            .ok_or_else(|| fault(node, format!("the {what} lie outside the unit circle")))
    };
    let (poles, zeros) = (lines(&node.ar, "poles")?, lines(&node.ma, "zeros")?);
    Ok([&[poles.len() as f64], &poles[..], &[zeros.len() as f64], &zeros, &[rate_hz]].concat())
}

/// Returns the level at which the stored spectral shape has the magnitude of the filter. Noise of
/// variance s² has the one-sided power density P = 2 s² / rate. A spectrum shows it as magnitude² =
/// 2 P ENBW, where ENBW is the equivalent noise bandwidth of the window.
fn level_rms(node: &Node, stored: &[f64], rate_hz: f64, band: Band) -> Result<f64, Fault> {
    let poles = stored.get(1..=node.ar.len()).unwrap_or_default();
    let zeros = stored.get(node.ar.len() + 2..).and_then(|rest| rest.get(..node.ma.len()));
    let (mut a, mut b) = (vec![0.0; node.ar.len()], vec![0.0; node.ma.len()]);
    let is_one = coefficients_of_lines(poles, &mut a)
        && zeros_of_lines(zeros.unwrap_or_default(), &mut b)
        && is_stable(&a);
    if !is_one {
        return Err(fault(
            node,
            "the poles are so near each other and the unit circle that 32-bit floats do not hold the filter",
        ));
    }
    let curve = |hz: f64| ar_magnitude(&a, hz, rate_hz) / ar_magnitude(&b, hz, rate_hz);
    let gain = (4.0 * 1.5 * GRID_HZ / rate_hz).sqrt();
    let level_rms = node.deviation() * gain * curve_level_rms(band, curve);
    if level_rms.is_finite() { Ok(level_rms) } else { Err(fault(node, "its level is not finite")) }
}

/// Makes a fault at the place of a node.
fn fault(node: &Node, problem: impl AsRef<str>) -> Fault {
    Fault::new(&node.place, problem)
}
