//! Manifests that each break one rule.

use serde_json::{Value, json};

use super::cases::Named;
use super::parts::{block, manifest, parts, with_manifest};
use super::raw_zip::{Entry, archive};
use super::valid_cases::with_store_key;

/// Assets with these manifests.
pub(super) fn manifests() -> Vec<Named> {
    type Change = fn(&mut Value);
    let changes: Vec<(&'static str, Change)> = vec![
        ("json_type", |m| m["band"]["low_hz"] = json!("20")),
        ("json_type_array", |m| m["band"] = json!([20, 1000])),
        ("json_type_word_as_object", |m| {
            m["representations"][0]["fields"][0]["store"] = json!({ "f32": null })
        }),
        ("json_type_object_as_word", |m| {
            m["representations"][0]["fields"][0]["store"] = json!("u16")
        }),
        ("json_type_two_stores", |m| {
            let steps = json!({ "scale": 1 });
            m["representations"][0]["fields"][0]["store"] = json!({ "u8": steps, "u16": steps })
        }),
        ("json_type_two_stores_and_inside", |m| {
            let (wrong, steps) = (json!({ "scale": "1" }), json!({ "scale": 1 }));
            m["representations"][0]["fields"][0]["store"] = json!({ "u8": wrong, "u16": steps })
        }),
        ("json_type_word_beside_store", |m| {
            let store = json!({ "u8": { "scale": 1 }, "f32": 1 });
            m["representations"][0]["fields"][0]["store"] = store
        }),
        ("json_type_null", |m| m["author"] = json!(null)),
        ("json_type_fraction", |m| m["representations"][0]["at"][0]["condition"] = json!(0.5)),
        ("json_type_missing", |m| drop(m.as_object_mut().unwrap().remove("band"))),
        ("json_unknown_key", |m| m["licence"] = json!("CC0-1.0")),
        ("json_unknown_key_inside", |m| m["band"]["lo_hz"] = json!(20)),
        ("version_missing", |m| drop(m.as_object_mut().unwrap().remove("htex"))),
        ("version_invalid", |m| m["htex"] = json!("1")),
        ("version_unsupported", |m| m["htex"] = json!("2.0")),
        ("name_empty", |m| m["name"] = json!(" ")),
        ("license_missing", |m| drop(m.as_object_mut().unwrap().remove("license"))),
        ("quantity_unknown", |m| m["quantity"] = json!("friction")),
        ("name_empty_and_others", |m| {
            m["name"] = json!("");
            m["unit"] = json!("mN");
            m["z"] = json!(1);
            m["band"] = json!({ "a": 1, "low_hz": 30, "high_hz": 20 });
            m["conditions"] = json!([{ "speed_mm_s": -1 }, {}, {}]);
            let mut second = m["representations"][0].clone();
            second["model"] = json!("org.htex.sslope");
            second["at"][0]["condition"] = json!(3);
            second["at"][0]["quality"]["band_error_rms_db"] = json!(-1);
            m["representations"].as_array_mut().unwrap().push(second);
            m["reference"] = json!({ "file": "absent.bin" });
            m["extensions"] = json!({ "LOOK": {} });
        }),
        ("unit_unknown_acceleration", |m| m["quantity"] = json!("acceleration")),
        ("doi_invalid", |m| {
            m["doi"] = json!("https://doi.org/10.5281/zenodo.1234567");
        }),
        ("made_invalid", |m| {
            let part = json!({ "name": "Vinyl", "weight": 1.5, "blake3": "0123" });
            m["provenance"]["made"] = json!({ "how": "mixed", "from": [part] });
        }),
        ("quality_invalid_left_out", |m| {
            m["representations"][0]["at"][0]["left_out"] = json!({ "band_error_rms_db": -0.5 });
        }),
        ("law_invalid", |m| {
            m["law"] = json!({
                "frequency_speed": { "exponent": 0, "source": "assumed" },
                "level_speed": { "exponent": 5, "source": "given" },
                "level_force": { "exponent": 1, "source": "measured", "standard_error": -0.1 },
            });
        }),
        ("json_type_fluctuation", |m| {
            m["htex"] = json!("1.1");
            m["fluctuation"] = json!({ "slow": 256, "fast": 0 });
        }),
        ("json_type_fluctuation_missing", |m| {
            m["htex"] = json!("1.1");
            m["fluctuation"] = json!({ "slow": 12 });
        }),
        ("fluctuation_invalid", |m| {
            m["htex"] = json!("1.1");
            m["fluctuation"] = json!({ "slow": 12, "fast": 0, "held_out_error_db": -0.5 });
        }),
        ("fluctuation_invalid_each", |m| {
            m["htex"] = json!("1.1");
            m["law"] = json!({
                "frequency_speed": { "exponent": 0, "source": "assumed" },
                "level_speed": { "exponent": 0, "source": "assumed" },
                "level_force": { "exponent": 5, "source": "given" },
            });
            m["fluctuation"] = json!({
                "slow": 12, "fast": 0, "held_out_error_db": 100.5, "halves_error_db": -0.5,
            });
        }),
        ("license_invalid", |m| m["license"] = json!("CC BY 4.0")),
        ("license_unknown", |m| m["license"] = json!("CC-BY-9.0")),
        ("field_unknown", |m| m["representations"][0]["fields"][0]["name"] = json!("alfa")),
        ("field_unit_wrong", |m| m["representations"][0]["fields"][1]["unit"] = json!("Hz")),
        ("level_invalid_displacement", |m| {
            m["quantity"] = json!("displacement");
            m["unit"] = json!("m");
            m["representations"][0]["at"][0]["level_rms"] = json!(101);
        }),
        ("unit_unknown", |m| m["unit"] = json!("mN")),
        ("band_invalid", |m| m["band"] = json!({ "low_hz": 1000, "high_hz": 20 })),
        ("source_invalid", |m| m["provenance"]["recordings"][0]["rate_hz"] = json!(0)),
        ("source_path", |m| m["provenance"]["recordings"][0]["file"] = json!("/home/me/a.csv")),
        ("conditions_empty", |m| m["conditions"] = json!([])),
        ("condition_invalid_third_octaves", |m| {
            m["htex"] = json!("1.1");
            m["conditions"][0]["repeatability_third_octave_rms_db"] = json!(-0.1);
        }),
        ("condition_invalid", |m| m["conditions"][0]["speed_mm_s"] = json!(-40)),
        ("condition_duplicate", |m| m["conditions"] = json!([{}, {}])),
        ("condition_duplicate_absent", |m| {
            m["conditions"] = json!([{}, { "speed_mm_s": 0, "force_n": 0 }])
        }),
        ("representations_empty", |m| m["representations"] = json!([])),
        ("model_id_invalid", |m| m["representations"][0]["model"] = json!("sBeta")),
        ("model_duplicate", |m| {
            let twin = m["representations"][0].clone();
            m["representations"].as_array_mut().unwrap().push(twin);
        }),
        ("model_version_invalid", |m| m["representations"][0]["model_version"] = json!("1")),
        ("field_name_empty", |m| m["representations"][0]["fields"][0]["name"] = json!("")),
        ("field_duplicate", |m| m["representations"][0]["fields"][0]["name"] = json!("beta")),
        ("store_invalid", |m| {
            m["representations"][0]["fields"][0]["store"] = json!({ "u16": { "scale": 0 } });
        }),
        ("at_empty", |m| m["representations"][0]["at"] = json!([])),
        ("condition_index_invalid", |m| m["representations"][0]["at"][0]["condition"] = json!(1)),
        ("condition_index_duplicate", |m| {
            let twin = m["representations"][0]["at"][0].clone();
            m["representations"][0]["at"].as_array_mut().unwrap().push(twin);
        }),
        ("store_invalid_packed", |m| {
            m["representations"][0]["fields"][0]["store"] = json!({ "packed": { "scale": 1 } });
        }),
        ("quality_invalid_distance", |m| {
            m["representations"][0]["at"][0]["quality"]["log_spectral_distance_db"] = json!(-1);
        }),
        ("level_invalid", |m| m["representations"][0]["at"][0]["level_rms"] = json!(-0.1)),
        ("quality_invalid", |m| {
            m["representations"][0]["at"][0]["quality"]["band_error_db"] = json!([0.5, 1.5]);
        }),
        ("parameters_entry_invalid", |m| {
            m["representations"][0]["parameters"] = json!("manifest.json");
        }),
        ("parameters_invalid_length", |m| {
            m["representations"][0]["fields"][0]["list"] = json!(true)
        }),
        ("reference_length", |m| {
            m["reference"] = json!({ "file": "parameters/sbeta.bin" });
            m["representations"][0]["parameters"] = json!("absent.bin");
        }),
        ("extension_name_invalid", |m| m["extensions"] = json!({ "LOOK": {} })),
        ("extension_required_unknown_form", |m| m["extensions_required"] = json!(["LOOK"])),
        ("band_invalid_below_a_bin", |m| m["band"] = json!({ "low_hz": 4e-9, "high_hz": 4 })),
        ("condition_invalid_all", |m| {
            m["conditions"] = json!([{
                "speed_mm_s": -1, "force_n": -1, "repeatability_rms_db": -1,
                "repeatability_third_octave_rms_db": -1,
            }])
        }),
        ("model_id_invalid_and_version", |m| {
            m["representations"][0]["model"] = json!("sBeta");
            m["representations"][0]["model_version"] = json!("1");
        }),
        ("plugin_duplicate_and_invalid", |m| {
            let plugin = json!({
                "model": "sBeta", "version": "1", "file": "plugins/sBeta.wasm", "blake3": "A".repeat(64),
            });
            m["plugins"] = json!([plugin, plugin]);
        }),
        ("extension_required_unknown", |m| m["extensions_required"] = json!(["com.example.X/1"])),
        ("findings_truncated", |m| {
            m["conditions"] = (0..120).map(|i| json!({ "force_n": -1 - i })).collect();
        }),
    ];
    let mut files: Vec<Named> = changes.into_iter().map(|(n, c)| (n, with_manifest(c))).collect();
    files.push(("reference_invalid", with_reference_of(-1.0)));
    let alpha = json!({ "name": "alpha", "store": "f32" });
    let list = json!({ "name": "beta", "list": true, "store": "f32" });
    files.push(("json_unknown_key_store", with_store_key("1.0")));
    files.push(("field_missing", with_fields(json!([alpha]), &block()[..4])));
    let block = [&block()[..4], &[1], &block()[4..]].concat();
    files.push(("field_kind_wrong", with_fields(json!([alpha, list]), &block)));
    files
}

/// An asset whose fields differ from the model's, with a block that matches the fields.
fn with_fields(fields: Value, block: &[u8]) -> Vec<u8> {
    let mut manifest = manifest();
    manifest["representations"][0]["fields"] = fields;
    archive(&parts(manifest.to_string().as_bytes(), block))
}

fn with_reference_of(magnitude: f32) -> Vec<u8> {
    let mut manifest = manifest();
    manifest["band"] = json!({ "low_hz": 20, "high_hz": 21 });
    manifest["reference"] = json!({ "file": "reference.bin" });
    let mut parts = parts(manifest.to_string().as_bytes(), &block());
    parts.push(Entry::stored("reference.bin", &magnitude.to_le_bytes()));
    archive(&parts)
}
