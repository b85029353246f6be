//! Gates: what an asset must hold to be in the library.
//!
//! They are judged when the results are put together, so that changing one fits nothing again.

use crate::recipe::{BandErrorGate, Gates};
use crate::report::{AssetReport, Missed};

/// Returns the gates that an asset misses.
pub(crate) fn missed(gates: &Gates, asset: &AssetReport) -> Vec<Missed> {
    let mut missed = Vec::new();
    if let Some(gate) = &gates.max_band_error_db {
        missed.extend(band_errors(gate, asset));
    }
    if let Some(least) = gates.min_segments
        && asset.segments < least
    {
        let found = asset.segments;
        let reason = format!(
            "a condition has {found} segments of 0.2 s and the gate asks for {least}; record longer, or lower the gate"
        );
        missed.push(Missed::new("min_segments", reason));
    }
    if gates.license == Some(true) && asset.license.is_none() {
        let reason = "it states no licence; set `license` to an SPDX expression such as CC0-1.0";
        missed.push(Missed::new("license", reason));
    }
    if let Some(most) = gates.max_bytes
        && asset.bytes > most
    {
        let found = asset.bytes;
        let reason = format!(
            "it has {found} bytes and the gate allows {most}; fit fewer models, embed no module, or raise the gate"
        );
        missed.push(Missed::new("max_bytes", reason));
    }
    missed
}

/// The models whose error is above the gate, or that the gate names and the asset lacks.
fn band_errors(gate: &BandErrorGate, asset: &AssetReport) -> Vec<Missed> {
    let errors = &asset.band_error_rms_db;
    let miss = |reason: String| Missed::new("max_band_error_db", reason);
    let compare = |model: &str, error: f64, most: f64| {
        let above = error.is_nan() || error > most;
        above.then(|| {
            miss(format!(
                "{model} is {error:.2} dB (nine bands, RMS) from the recording at its worst condition and the gate allows \
                 {most}; fit another model, or raise the gate"
            ))
        })
    };
    match gate {
        BandErrorGate::All(most) => {
            let all = errors.iter();
            all.filter_map(|(model, error)| compare(model, *error, *most))
                .collect()
        }
        BandErrorGate::ByModel(by_model) => {
            let gates = by_model.iter().filter_map(|(name, most)| {
                let found = errors.iter().find(|(id, _)| is_named(id, name));
                match found {
                    Some((model, error)) => compare(model, *error, *most),
                    None => Some(miss(format!("{name} has a gate and was not fitted"))),
                }
            });
            gates.collect()
        }
    }
}

/// Whether a model's id has this name: the whole id, or its last part.
fn is_named(id: &str, name: &str) -> bool {
    let short = id.rsplit('.').next().unwrap_or(id);
    id == name || short.eq_ignore_ascii_case(name)
}
