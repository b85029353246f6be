//! Gates: the requirements that an asset must meet to be in the library.
//!
//! The gates are applied when the results are assembled, so a change of the gates needs no new fit.

use crate::recipe::{Gates, ModelGate};
use crate::report::{AssetReport, MissedGate};

/// Returns the gates that an asset misses.
pub(crate) fn missed(gates: &Gates, asset: &AssetReport) -> Vec<MissedGate> {
    let mut missed = Vec::new();
    if let Some(gate) = &gates.max_band_error_db {
        missed.extend(band_errors(gate, asset));
    }
    if let Some(gate) = &gates.max_felt_error_db {
        missed.extend(felt_errors(gate, asset));
    }
    missed.extend(gates.max_repeatability_db.and_then(|most| repeatability(most, asset)));
    missed.extend(denied(gates, asset));
    if let Some(least) = gates.min_segments
        && asset.segments < least
    {
        let found = asset.segments;
        let reason = format!(
            "a condition has {found} segments of 0.2 s and the gate asks for {least}; record longer, or lower the gate"
        );
        missed.push(MissedGate::new("min_segments", reason));
    }
    if gates.license == Some(true) && asset.license.is_none() {
        let reason = "it states no licence; set `license` to an SPDX expression such as CC0-1.0, or `gates.license` to false";
        missed.push(MissedGate::new("license", reason));
    }
    if let Some(most) = gates.max_bytes
        && asset.bytes > most
    {
        let found = asset.bytes;
        let reason = format!(
            "it has {found} bytes and the gate allows {most}; fit fewer models, embed no module, or raise the gate"
        );
        missed.push(MissedGate::new("max_bytes", reason));
    }
    missed
}

/// Returns the findings of the recordings that the gate forbids.
fn denied(gates: &Gates, asset: &AssetReport) -> Vec<MissedGate> {
    let codes = gates.deny.as_deref().unwrap_or_default();
    let found = asset.findings.iter().filter(|f| codes.contains(&f.code));
    let reason = |finding: &crate::FindingReport| {
        format!(
            "{} ({}): {}; record again, leave the recording out, or take the code from the gate",
            finding.code,
            finding.recordings.join(", "),
            finding.message
        )
    };
    found.map(|f| MissedGate::new("deny", reason(f))).collect()
}

/// Returns the missed gate if the repeatability value is above the gate or not known.
fn repeatability(most: f64, asset: &AssetReport) -> Option<MissedGate> {
    let reason = match asset.repeatability_rms_db {
        None => {
            "its repeatability is not known, since no condition has four blocks of 0.2 s that share no sample; record longer"
                .to_owned()
        }
        Some(found) if found <= most => return None,
        Some(found) => format!(
            "two recordings of a condition like this one differ by {found:.2} dB (nine bands, RMS, between blocks of time) and the gate allows {most}; record longer \
             or more evenly, or raise the gate"
        ),
    };
    Some(MissedGate::new("max_repeatability_db", reason))
}

/// Returns the models whose nine-band error is above the gate.
fn band_errors(gate: &ModelGate, asset: &AssetReport) -> Vec<MissedGate> {
    let errors = asset.band_error_rms_db.iter();
    let errors: Vec<(&str, f64)> = errors.map(|(id, error)| (&id[..], *error)).collect();
    let above = |model: &str, error: f64, most: f64| {
        format!(
            "{model} is {error:.2} dB (nine bands, RMS) from the recording at its worst condition and the gate allows \
             {most}; fit another model, or raise the gate"
        )
    };
    by_model(gate, &errors, "max_band_error_db", &above)
}

/// Returns the models whose felt difference from the recording is above the gate.
fn felt_errors(gate: &ModelGate, asset: &AssetReport) -> Vec<MissedGate> {
    let felt = asset.felt.iter();
    let errors = felt.map(|(id, felt)| {
        let largest = felt.largest_error_db.max(felt.total_error_db.abs());
        (&id[..], largest)
    });
    let errors: Vec<(&str, f64)> = errors.collect();
    let above = |model: &str, error: f64, most: f64| {
        format!(
            "of {model}, a difference of {error:.2} dB above the detection threshold is felt at its worst condition (a third-octave \
             band, or all together) and the gate allows {most}; fit another model, or raise the gate"
        )
    };
    by_model(gate, &errors, "max_felt_error_db", &above)
}

/// Returns the models whose error is above the gate, and the models that the gate names but the
/// asset lacks. `above` returns a text about a model whose error is above the largest allowed
/// error.
fn by_model(
    gate: &ModelGate,
    errors: &[(&str, f64)],
    key: &str,
    above: &dyn Fn(&str, f64, f64) -> String,
) -> Vec<MissedGate> {
    let compare = |model: &str, error: f64, most: f64| {
        // An error that is not a number must not pass a gate.
        let is_above = error.is_nan() || error > most;
        is_above.then(|| MissedGate::new(key, above(model, error, most)))
    };
    match gate {
        ModelGate::All(most) => {
            let all = errors.iter();
            all.filter_map(|(model, error)| compare(model, *error, *most)).collect()
        }
        ModelGate::ByModel(by_model) => {
            let gates = by_model.iter().filter_map(|(name, most)| {
                match errors.iter().find(|(id, _)| is_named(id, name)) {
                    Some((model, error)) => compare(model, *error, *most),
                    None => {
                        Some(MissedGate::new(key, format!("{name} has a gate and was not fitted")))
                    }
                }
            });
            gates.collect()
        }
    }
}

/// Returns whether a name refers to a model's id: the whole id, or its last part.
fn is_named(id: &str, name: &str) -> bool {
    let short = id.rsplit('.').next().unwrap_or(id);
    id == name || short.eq_ignore_ascii_case(name)
}

/// Checks that gates name models that are fitted, and that their numbers can be met.
pub(crate) fn check_gates(gates: &Gates, models: &[&str]) -> Result<(), String> {
    for (key, gate) in [
        ("max_band_error_db", &gates.max_band_error_db),
        ("max_felt_error_db", &gates.max_felt_error_db),
    ] {
        let Some(gate) = gate else { continue };
        for (name, most) in by_name(gate) {
            if let Some(name) = name
                && !models.iter().any(|id| is_named(id, name))
            {
                let models = models.join(", ");
                return Err(format!("gates.{key}: {name} is not fitted; there are {models}"));
            }
            check_number(key, most)?;
        }
    }
    gates.max_repeatability_db.map_or(Ok(()), |most| check_number("max_repeatability_db", most))
}

/// Returns the numbers of a gate, each with the model to which it is limited, if any.
fn by_name(gate: &ModelGate) -> Vec<(Option<&str>, f64)> {
    match gate {
        ModelGate::All(most) => vec![(None, *most)],
        ModelGate::ByModel(by_model) => {
            let named = by_model.iter();
            named.map(|(name, most)| (Some(&name[..]), *most)).collect()
        }
    }
}

fn check_number(key: &str, most: f64) -> Result<(), String> {
    if most >= 0.0 {
        Ok(())
    } else {
        Err(format!(
            "gates.{key} is {most}, which no texture meets; give a number of decibels from 0"
        ))
    }
}
