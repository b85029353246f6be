//! Assets for tests.

mod archive_cases;
pub mod cases;
mod edge_cases;
mod manifest_cases;
pub mod parts;
mod plugin_cases;
pub mod raw_zip;
mod text_cases;
mod triangle_cases;
mod valid_cases;

use htex_format::*;

/// A representation, with one flat array per condition.
pub type Fitted = (Representation, Vec<Vec<f64>>);

/// An asset with the given representations at `conditions` conditions.
pub fn asset(conditions: usize, fitted: Vec<Fitted>) -> Asset {
    let (representations, parameters) = fitted.into_iter().unzip();
    Asset {
        manifest: Manifest {
            htex: "1.0".to_owned(),
            name: "Cotton, coarse weave".to_owned(),
            license: Some("CC-BY-4.0".to_owned()),
            author: Some("Haptics Laboratory, Example University".to_owned()),
            tags: ["cotton", "textile", "rough"].map(str::to_owned).to_vec(),
            description: None,
            source: None,
            doi: None,
            sensor: None,
            finger: None,
            contact: Contact::Unknown,
            quantity: Quantity::LateralForce,
            unit: Quantity::LateralForce.unit().to_owned(),
            band: Band { low_hz: 20.0, high_hz: 1000.0 },
            provenance: Provenance {
                made: None,
                tool: "htex 0.1.0".to_owned(),
                recordings: vec![Source {
                    file: "cotton_take_1.csv".to_owned(),
                    rate_hz: 20_000.0,
                    segments: 48,
                    blake3: None,
                }],
                ..Provenance::default()
            },
            conditions: (0..conditions).map(condition).collect(),
            law: None,
            fluctuation: None,
            representations,
            reference: None,
            plugins: Vec::new(),
            extensions: Default::default(),
            extensions_required: Vec::new(),
            other: Default::default(),
        },
        parameters,
        reference: None,
        plugins: Vec::new(),
        notes: Vec::new(),
    }
}

fn condition(i: usize) -> Condition {
    Condition {
        speed_mm_s: Some(40.0 + 20.0 * i as f64),
        force_n: Some(0.5),
        repeatability_rms_db: Some(0.8137),
        ..Condition::default()
    }
}

/// Creates a representation whose fields are (name, unit, list length, store); length 0 is a
/// scalar.
pub fn fitted(model: &str, conditions: usize, fields: &[(&str, &str, usize, StoredAs)]) -> Fitted {
    let stored: Vec<StoredField> = fields.iter().map(field).collect();
    let representation = Representation {
        model: format!("org.htex.{model}"),
        model_version: "1.0.0".to_owned(),
        fields: stored.clone(),
        at: (0..conditions).map(at).collect(),
        triangles: Vec::new(),
        parameters: format!("parameters/{model}.bin"),
    };
    let parameters = (0..conditions).map(|c| flat(c, fields, &stored)).collect();
    (representation, parameters)
}

fn field(&(name, unit, length, store): &(&str, &str, usize, StoredAs)) -> StoredField {
    StoredField { name: name.to_owned(), unit: unit.to_owned(), list: length > 0, store }
}

fn flat(
    condition: usize,
    fields: &[(&str, &str, usize, StoredAs)],
    stored: &[StoredField],
) -> Vec<f64> {
    let mut flat = Vec::new();
    for &(name, _, length, _) in fields {
        if length > 0 {
            flat.push(length as f64);
        }
        flat.extend((0..length.max(1)).map(|i| value(name, i as f64, condition as f64)));
    }
    round_parameters(stored, &flat).expect("the values fit their stores")
}

/// Returns a value that the model of the field accepts.
fn value(field: &str, i: f64, condition: f64) -> f64 {
    match field {
        "coefficients" => 0.2 / (i + 1.0) - 0.1 * condition / (i + 2.0),
        "model_rate_hz" => 2_000.0,
        "cepstrum" => -3.0 / (i + 1.0) + 0.2 * condition,
        "bands" => 26.0,
        "inverse" | "random_phase" => 0.0,
        "frequency_hz" => 37.0 * (i + 1.0) + condition,
        "peak_hz" => 120.0 + 10.0 * condition,
        _ => 0.5 + 0.37 * (i + 1.0).sqrt() + 0.1 * condition,
    }
}

fn at(i: usize) -> AtCondition {
    let errors = [-0.8123, 1.2456, -0.1034, 0.5678, -2.3091, 0.0412, 1.0897, -0.6543, 0.3216];
    AtCondition {
        condition: i,
        level_rms: 0.0731529846 + 0.01 * i as f64,
        quality: Some(Quality {
            by_magnitude: Measures::from([
                (Measure::SpectralCorrelation, 0.9412),
                (Measure::NineBand, 1.0538),
                (Measure::NineBandMatched, 1.0421),
                (Measure::ThirdOctave, 1.8127),
                (Measure::LogSpectral, 2.7643),
            ]),
            by_samples: Measures::from([
                (Measure::SpectralCorrelation, 0.9376),
                (Measure::NineBand, 1.1243),
                (Measure::ThirdOctave, 1.8519),
                (Measure::LogSpectral, 2.8011),
            ]),
            band_error_db: errors.to_vec(),
            rounding_error_db: Some(0.0003),
        }),
        left_out: None,
    }
}

/// Steps without a logarithm.
pub fn steps(scale: f64) -> Steps {
    Steps { scale, offset: 0.0, log: false }
}

/// Two 32-bit floats.
pub fn sbeta(conditions: usize) -> Fitted {
    let fields = [("alpha", "", 0, StoredAs::F32), ("beta", "", 0, StoredAs::F32)];
    fitted("sbeta", conditions, &fields)
}

/// A packed list of 30 steps that rise slowly.
pub fn bands(conditions: usize) -> Fitted {
    let fields = [
        ("below_highest", "", 30, StoredAs::Packed(steps(0.25))),
        ("step_db", "dB", 0, StoredAs::U8(steps(0.05))),
        ("layout", "", 0, StoredAs::U8(steps(1.0))),
    ];
    fitted("bands", conditions, &fields)
}

/// The paper's five models, with the stores of their descriptors.
pub fn five(conditions: usize) -> Vec<Fitted> {
    let hertz = StoredAs::U16(steps(0.03125));
    let order = StoredAs::U16(steps(0.001));
    let amplitude = StoredAs::U16(Steps { scale: 0.0002, offset: -10.0, log: true });
    let whole = StoredAs::U8(steps(1.0));
    vec![
        fitted(
            "ar",
            conditions,
            &[("coefficients", "", 6, StoredAs::F64), ("model_rate_hz", "Hz", 0, StoredAs::F32)],
        ),
        fitted(
            "mfcc",
            conditions,
            &[
                ("cepstrum", "", 10, StoredAs::F32),
                ("bands", "", 0, whole),
                ("inverse", "", 0, whole),
            ],
        ),
        fitted(
            "speak",
            conditions,
            &[
                ("frequency_hz", "Hz", 10, hertz),
                ("amplitude", "", 10, amplitude),
                ("random_phase", "", 0, whole),
            ],
        ),
        sbeta(conditions),
        fitted(
            "sslope",
            conditions,
            &[
                ("peak_hz", "Hz", 0, hertz),
                ("order_high_pass", "", 0, order),
                ("order_low_pass", "", 0, order),
            ],
        ),
    ]
}

/// A reference for the given number of conditions, newtons.
pub fn reference(conditions: usize) -> Vec<Vec<f32>> {
    let spectrum = |c: usize| (0..197).map(move |i| 0.01 / (1.0 + (i + c) as f32)).collect();
    (0..conditions).map(spectrum).collect()
}
