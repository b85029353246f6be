//! Manifests and parameter blocks that differ in single bytes.

use super::cases::Named;
use serde_json::{Value, json};

use super::parts::{block, manifest, with_block, with_coded, with_packed, with_text};

/// The code of the specification's example.
const CODE: &[u8] = &[0xFF, 0xFF, 0xFB, 0x76, 0x57, 0x42, 0xB5];

/// Takes the extension, and the tables, away from a coded asset.
fn plain(manifest: &mut Value) {
    manifest["extensions_required"] = json!([]);
    manifest["conditions"] = json!([{ "speed_mm_s": 40 }, { "speed_mm_s": 80 }]);
    manifest["representations"][0]["at"] =
        json!([{ "condition": 0, "level_rms": 0.01 }, { "condition": 1, "level_rms": 0.02 }]);
}

pub(super) fn texts() -> Vec<Named> {
    let text = manifest().to_string();
    let twice = text.replacen('{', "{\"name\":\"Twice\",", 1);
    let with = |key: &str| with_text(text.replacen('{', &format!("{{{key},"), 1).as_bytes());
    let deep = format!("{}{}", "[".repeat(40), "]".repeat(40));
    vec![
        ("json_syntax", with_text(b"{\"htex\": \"1.0\",}")),
        ("json_syntax_utf8", with_text(b"{\"htex\": \"1.0\", \"name\": \"\xFF\"}")),
        ("json_syntax_not_finite", with_text(text.replacen("20.0", "1e999", 1).as_bytes())),
        ("json_syntax_surrogate", with(r#""author":"\ud800""#)),
        ("json_too_deep", with_text(deep.as_bytes())),
        ("json_type_twice", with_text(twice.as_bytes())),
        (
            "json_type_twice_extension",
            with(r#""extensions":{"com.example.LOOK/1":[{"a~b":{"x":1,"x":1}}]}"#),
        ),
        ("json_type_twice_unknown", with(r#""friction":{"static":0.4,"static":0.4}"#)),
        ("valid_null_in_extension", with(r#""extensions":{"com.example.LOOK/1":{"colour":null}}"#)),
        (
            "valid_whole_numbers",
            with_text(
                text.replacen("\"condition\":0", "\"condition\":0e0", 1)
                    .replacen("\"segments\":48", "\"segments\":4.8e1", 1)
                    .as_bytes(),
            ),
        ),
        ("parameters_invalid_short", with_block(&block()[..7])),
        ("parameters_invalid_long", with_block(&[0; 9])),
        ("parameters_invalid_packed", with_packed(&[1, 0x1F, 0xE1])),
        ("valid_coded_table", with_coded(CODE, |_| ())),
        ("parameters_invalid_coded_long", with_coded(&[CODE, &[0]].concat(), |_| ())),
        ("parameters_invalid_coded_step", with_coded(&[0xFF; 40], |_| ())),
        ("parameters_invalid_coded_form", with_coded(&[CODE, &[1]].concat(), |_| ())),
        ("store_invalid_coded", with_coded(CODE, plain)),
        (
            "json_type_table_rows",
            with_coded(CODE, |m| m["conditions"]["columns"]["force_n"]["rows"] = json!([2])),
        ),
        (
            "json_type_table_column",
            with_coded(CODE, |m| m["representations"][0]["at"]["columns"]["quality"] = json!([{}])),
        ),
        (
            "json_type_table_per",
            with_coded(CODE, |m| m["conditions"]["columns"]["force_n"]["per"] = json!(0)),
        ),
        (
            "json_type_table_in_plain",
            with_coded(CODE, |m| {
                plain(m);
                m["conditions"] = json!({ "columns": { "speed_mm_s": [40, 80] } });
            }),
        ),
        (
            "level_invalid_in_table",
            with_coded(CODE, |m| {
                m["representations"][0]["at"]["columns"]["level_rms"] = json!([0.01, -0.02]);
            }),
        ),
        ("parameters_not_finite", with_block(&[0, 0, 0xC0, 0x7F, 0, 0, 0, 0])),
    ]
}
