//! Valid assets.

use htex_format::{Asset, Measure, Quantity, Reference};
use serde_json::json;

use super::cases::Named;
use super::parts::{block, manifest, parts, with_manifest};
use super::plugin_cases::with_plugin;
use super::raw_zip::archive;
use super::triangle_cases::{FLIPPED, RECTANGLE, dented, narrow, with_triangles, without};
use super::{asset, bands, five, reference, sbeta};

pub(super) fn valid() -> Vec<Named> {
    let mut with_reference = asset(2, vec![sbeta(2)]);
    with_reference.manifest.reference = Some(Reference { file: "reference.bin".to_owned() });
    with_reference.reference = Some(reference(2));
    let mut extended = asset(1, vec![sbeta(1)]);
    let colour = json!({ "colour": "#a08060" });
    extended.manifest.extensions.insert("com.example.LOOK/1".to_owned(), colour);
    vec![
        ("valid_minimal", asset(1, vec![sbeta(1)]).to_bytes().unwrap()),
        ("valid_five_models", asset(1, five(1)).to_bytes().unwrap()),
        ("valid_conditions", asset(3, five(3)).to_bytes().unwrap()),
        ("valid_packed", asset(2, vec![bands(2)]).to_bytes().unwrap()),
        ("valid_coded", coded().to_bytes().unwrap()),
        ("valid_reference", with_reference.to_bytes().unwrap()),
        ("valid_plugin", with_plugin(|_| ())),
        ("valid_extension", extended.to_bytes().unwrap()),
        ("valid_acceleration", of(Quantity::Acceleration)),
        ("valid_velocity", of(Quantity::Velocity)),
        ("valid_displacement", of(Quantity::Displacement)),
        ("valid_normal_force", of(Quantity::NormalForce)),
        (
            "valid_license_ref",
            with_manifest(|m| m["license"] = json!("LicenseRef-Example OR CC0-1.0")),
        ),
        (
            "valid_metadata",
            with_manifest(|m| {
                m["description"] = json!("Coarse cotton, plain weave, 12 threads per cm");
                m["source"] = json!("Example University, touch laboratory");
                m["doi"] = json!("10.5281/zenodo.1234567");
                m["sensor"] = json!("six-axis force and torque sensor");
                m["finger"] = json!("bare index finger");
            }),
        ),
        (
            "valid_law",
            with_manifest(|m| {
                m["contact"] = json!("finger");
                m["law"] = json!({
                    "frequency_speed": { "exponent": 1, "source": "assumed" },
                    "level_speed": {
                        "exponent": 0.41, "source": "measured", "estimate": 0.62, "standard_error": 0.11
                    },
                    "level_force": { "exponent": 0.9, "source": "given" },
                });
            }),
        ),
        (
            "valid_grid",
            with_manifest(|m| {
                m["conditions"][0]["segments"] = json!(23);
                m["representations"][0]["at"][0]["left_out"] = json!({
                    "band_error_rms_db": 0.8123,
                    "third_octave_error_rms_db": 1.0412,
                });
            }),
        ),
        (
            "valid_version_1_1",
            with_manifest(|m| {
                m["htex"] = json!("1.1");
                m["conditions"][0]["repeatability_third_octave_rms_db"] = json!(0.9211);
                m["representations"][0]["at"][0]["left_out"] = json!({
                    "band_error_rms_db": 1.1517,
                    "third_octave_error_rms_db": 1.4038,
                });
            }),
        ),
        (
            "valid_fluctuation",
            with_manifest(|m| {
                m["htex"] = json!("1.1");
                m["fluctuation"] = json!({ "slow": 112, "fast": 71 });
            }),
        ),
        (
            "valid_fluctuation_errors",
            with_manifest(|m| {
                m["htex"] = json!("1.1");
                m["fluctuation"] = json!({
                    "slow": 112, "fast": 71, "held_out_error_db": 100, "halves_error_db": 0,
                });
            }),
        ),
        (
            "valid_mixed",
            with_manifest(|m| {
                m["provenance"]["made"] = json!({
                    "how": "mixed",
                    "from": [
                        { "name": "Vinyl", "weight": 0.7, "blake3": "0123456789abcdef".repeat(4) },
                        { "name": "Denim", "weight": 0.3, "blake3": "fedcba9876543210".repeat(4) },
                    ],
                });
            }),
        ),
        (
            "valid_field_order",
            with_manifest(|m| {
                let fields = m["representations"][0]["fields"].as_array_mut();
                fields.unwrap().reverse();
            }),
        ),
        (
            "valid_extensions_required",
            with_manifest(|m| {
                m["extensions_required"] = json!(["org.htex.hatt/1", "org.htex.appearance/1"]);
            }),
        ),
        (
            "valid_empty_unit",
            with_manifest(|m| m["representations"][0]["fields"][0]["unit"] = json!("")),
        ),
        (
            "valid_large_prerelease",
            with_manifest(|m| {
                m["representations"][0]["model_version"] = json!("1.0.0-18446744073709551616");
            }),
        ),
        ("valid_triangles", with_triangles(&RECTANGLE, &FLIPPED)),
        ("valid_triangles_narrow", narrow()),
        ("valid_triangles_dented", dented()),
        ("valid_triangles_empty", without()),
        ("valid_newer_store", with_store_key("1.3")),
        ("valid_field_of_newer_model", with_newer_model()),
        (
            "valid_newer_minor",
            with_manifest(|m| {
                m["htex"] = json!("1.7");
                m["friction"] = json!({ "static": 0.4 });
            }),
        ),
    ]
}

/// A coded asset with several models. One field of a model is coded between others that are not,
/// and the numbers of quality are not the same at all conditions.
fn coded() -> Asset {
    let mut models = five(12);
    models.push(bands(12));
    let mut asset = asset(12, models);
    asset.manifest.representations[5].at[3].quality = None;
    let quality = asset.manifest.representations[5].at[4].quality.as_mut().unwrap();
    *quality.by_magnitude.get_mut(Measure::ThirdOctave) = None;
    asset.manifest.conditions[7].force_n = None;
    asset.coded()
}

/// An asset with another quantity.
fn of(quantity: Quantity) -> Vec<u8> {
    let mut asset = asset(1, vec![sbeta(1)]);
    asset.manifest.quantity = quantity;
    asset.manifest.unit = quantity.unit().to_owned();
    asset.to_bytes().unwrap()
}

/// An asset whose two fields are stored in steps, with a key that this version does not know.
pub(super) fn with_store_key(version: &str) -> Vec<u8> {
    let mut manifest = manifest();
    manifest["htex"] = json!(version);
    let fields = manifest["representations"][0]["fields"].as_array_mut();
    for field in fields.unwrap() {
        field["store"] = json!({ "u8": { "scale": 0.5 }, "entropy": { "order": 2 } });
    }
    archive(&parts(manifest.to_string().as_bytes(), &[3, 5]))
}

/// An asset fitted by a later minor version of its model, which has one more field.
fn with_newer_model() -> Vec<u8> {
    let mut manifest = manifest();
    let representation = &mut manifest["representations"][0];
    representation["model_version"] = json!("1.9.0");
    let fields = representation["fields"].as_array_mut().unwrap();
    fields.push(json!({ "name": "gamma", "store": "f32" }));
    let block = [&block()[..], &0.25f32.to_le_bytes()].concat();
    archive(&parts(manifest.to_string().as_bytes(), &block))
}
