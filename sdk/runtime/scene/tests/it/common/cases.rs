//! The conformance scenes and the files that they name. There are valid scenes, and for each rule
//! at least one scene that breaks it.

use std::path::Path;
use std::sync::Arc;

use htex_device::Devices;
use htex_format::{
    AtCondition, Band, Condition, Manifest, Quantity, Representation, StoredAs, StoredField,
};
use htex_play::Registry;
use htex_scene::{Surroundings, validate};
use serde_json::{Value, json};

/// A conformance scene.
pub(crate) struct Case {
    pub name: &'static str,
    pub text: String,
}

impl Case {
    /// The report expected for the scene in `folder`, as pretty-printed JSON.
    pub(crate) fn golden(&self, folder: &Path) -> String {
        let devices = Devices::new(vec![Arc::new(htex_device_builtin::file::FileAdapter)]);
        let around = Surroundings {
            models: &Registry::builtin(),
            embedded: true,
            devices: Some(&devices),
            signers: None,
        };
        let file = format!("{}.scene.json", self.name);
        let report = validate(&folder.join(&file), &around).unwrap();
        let golden = json!({ "file": file, "valid": report.valid, "findings": report.findings });
        serde_json::to_string_pretty(&golden).unwrap() + "\n"
    }
}

/// The files that the scenes name, as file name and bytes.
pub(crate) fn files() -> Vec<(&'static str, Vec<u8>)> {
    let trace = |header: &str, rows: &str| format!("{header}\n{rows}").into_bytes();
    let rows = "0,0,0,0.4\n0.5,40,0,0.4\n1,0,0,0.4\n";
    vec![
        ("cloth.htex", asset(Quantity::LateralForce, &["org.htex.sbeta", "org.htex.sslope"])),
        ("tool.htex", asset(Quantity::Acceleration, &["org.htex.sbeta"])),
        ("stranger.htex", asset(Quantity::LateralForce, &["org.example.stranger"])),
        ("broken.htex", b"not an asset".to_vec()),
        ("hand.csv", trace("t_s,x_mm,y_mm,force_n", rows)),
        ("assumed.csv", trace("t,x_mm,y_mm,force_n", rows)),
        ("stuck.csv", trace("t_s,x_mm,y_mm,force_n", "0,0,0,0.4\n0,1,0,0.4\n")),
        ("display.csv", b"frequency_hz,magnitude\n20,1\n1000,0.5\n".to_vec()),
        ("weak.csv", b"frequency_hz,magnitude\n0,1000\n10,1000\n20,1\n1000,0.1\n".to_vec()),
        ("elsewhere.csv", b"frequency_hz,magnitude\n0,1\n10,0\n2000,0\n".to_vec()),
        ("dead.csv", b"frequency_hz,magnitude\n20,0\n1000,0\n".to_vec()),
    ]
}

fn asset(quantity: Quantity, models: &[&str]) -> Vec<u8> {
    let fields = |model: &str| match model {
        "org.htex.sslope" => {
            vec![("peak_hz", 120.0), ("order_high_pass", 1.5), ("order_low_pass", 2.0)]
        }
        _ => vec![("alpha", 2.0), ("beta", 3.0)],
    };
    let representation = |model: &&str| Representation {
        model: (*model).to_owned(),
        model_version: "1.0.0".to_owned(),
        fields: fields(model).iter().map(|(name, _)| field(name)).collect(),
        at: vec![AtCondition { condition: 0, level_rms: 0.02, quality: None, left_out: None }],
        triangles: Vec::new(),
        parameters: format!("parameters/{model}.bin"),
    };
    let values = |model: &&str| vec![fields(model).iter().map(|(_, value)| *value).collect()];
    let condition =
        Condition { speed_mm_s: Some(80.0), force_n: Some(0.4), ..Condition::default() };
    let asset = htex_format::Asset {
        manifest: Manifest {
            htex: "1.0".to_owned(),
            name: "Cloth".to_owned(),
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
            quantity,
            unit: quantity.unit().to_owned(),
            band: Band { low_hz: 20.0, high_hz: 1000.0 },
            provenance: Default::default(),
            conditions: vec![condition],
            representations: models.iter().map(representation).collect(),
            reference: None,
            plugins: Vec::new(),
            extensions: Default::default(),
            extensions_required: Vec::new(),
            other: Default::default(),
        },
        parameters: models.iter().map(values).collect(),
        reference: None,
        plugins: Vec::new(),
        notes: Vec::new(),
    };
    asset.to_bytes().unwrap()
}

fn field(name: &str) -> StoredField {
    StoredField {
        name: name.to_owned(),
        unit: if name == "peak_hz" { "Hz" } else { "" }.to_owned(),
        list: false,
        store: StoredAs::F64,
    }
}

/// A scene with one surface and a constant motion.
pub(crate) fn plain() -> Value {
    json!({
        "htex_scene": "1.0",
        "surfaces": [{ "asset": "cloth.htex" }],
        "motion": { "constant": { "speed_mm_s": 80, "force_n": 0.4 } },
        "duration_s": 1,
    })
}

/// Returns the scene [`plain`] with other values at some JSON pointers. Missing parents are created
/// as objects.
fn with(changes: &[(&str, Value)]) -> String {
    let mut scene = plain();
    for (pointer, value) in changes {
        let (parent, key) = pointer.rsplit_once('/').unwrap();
        let mut at = &mut scene;
        for part in parent.split('/').skip(1) {
            at = match part.parse::<usize>() {
                Ok(index) => &mut at[index],
                Err(_) => &mut at[part],
            };
        }
        at[key] = value.clone();
    }
    serde_json::to_string_pretty(&scene).unwrap() + "\n"
}

fn without(key: &str) -> String {
    let mut scene = plain();
    scene.as_object_mut().unwrap().remove(key);
    serde_json::to_string_pretty(&scene).unwrap() + "\n"
}

/// Returns a scene with two surfaces side by side. `second` is the range of the second surface
/// along x.
fn two(second: [f64; 2]) -> Value {
    let region = |x_mm: [f64; 2]| json!({ "x_mm": x_mm, "y_mm": [0, 50] });
    json!([
        { "asset": "cloth.htex", "region": region([0.0, 50.0]) },
        { "asset": "cloth.htex", "region": region(second), "representation": "sslope", "gain": 2 },
    ])
}

/// All conformance scenes.
pub(crate) fn cases() -> Vec<Case> {
    let volts =
        || ("/device", json!({ "settings": { "quantity": "display_voltage", "limit_v": 100 } }));
    let start = || ("/motion/constant/from_mm", json!([10, 10]));
    let tool = || ("/surfaces/0/asset", json!("tool.htex"));
    let all = [
        ("valid_plain", with(&[])),
        ("valid_live", with(&[("/motion", json!("live"))])),
        ("valid_trace", {
            let mut scene = plain();
            scene["motion"] = json!({ "trace": "hand.csv" });
            scene.as_object_mut().unwrap().remove("duration_s");
            scene.to_string()
        }),
        ("valid_regions", with(&[("/surfaces", two([50.0, 100.0])), start()])),
        ("valid_layers", {
            let mut surfaces = two([20.0, 100.0]);
            surfaces[1]["layer"] = json!(1);
            with(&[("/surfaces", surfaces), start()])
        }),
        ("valid_electrovibration", {
            let device = ("/device/drive_v", json!(50));
            let response = ("/device/response", json!("display.csv"));
            with(&[volts(), device, response, ("/effects", json!({ "crossfade": "off" }))])
        }),
        (
            "valid_budget",
            with(&[(
                "/budget",
                json!({ "ns_per_sample": 100, "max_error_db": 3, "error": "third_octave" }),
            )]),
        ),
        (
            "valid_own_levels",
            with(&[
                volts(),
                ("/device/levels", json!("own")),
                ("/device/reference_rms", json!(0.02)),
            ]),
        ),
        ("motion_beyond_recorded", with(&[("/motion/constant/speed_mm_s", json!(1000))])),
        ("device_field_unfit_levels", with(&[("/device", json!({ "levels": "own" }))])),
        ("device_field_unfit_reference", with(&[volts(), ("/device/reference_rms", json!(0.02))])),
        ("scene_json_too_deep", "[".repeat(17) + &"]".repeat(17)),
        ("scene_json_syntax", "{ \"htex_scene\": \"1.0\", }".to_owned()),
        ("scene_version_missing", without("htex_scene")),
        ("scene_version_invalid", with(&[("/htex_scene", json!(1.0))])),
        ("scene_version_unsupported", with(&[("/htex_scene", json!("2.0"))])),
        (
            "scene_version_newer",
            with(&[("/htex_scene", json!("1.4")), ("/temperature_c", json!(20))]),
        ),
        (
            "scene_version_newer_effect",
            with(&[("/htex_scene", json!("1.4")), ("/effects", json!({ "warmth": "on" }))]),
        ),
        ("effect_unknown", with(&[("/effects", json!({ "cross_fade": "on" }))])),
        ("scene_json_type", with(&[("/surfaces/0/gain", json!("loud"))])),
        ("scene_json_type_switch", with(&[("/effects", json!({ "crossfade": "yes" }))])),
        ("scene_json_type_motion", without("motion")),
        ("scene_json_type_seed", with(&[("/seed", json!((1u64 << 53) + 2))])),
        (
            "scene_unknown_key",
            with(&[("/surfaces/0/regoin", json!({})), ("/motion/constant/spede", json!(1))]),
        ),
        ("surfaces_empty", with(&[("/surfaces", json!([]))])),
        (
            "surfaces_too_many",
            with(&[
                ("/surfaces", Value::Array(vec![json!({ "asset": "cloth.htex" }); 257])),
                start(),
            ]),
        ),
        ("surface_gain_invalid", with(&[("/surfaces/0/gain", json!(-1))])),
        ("representation_name_empty", with(&[("/surfaces/0/representation", json!(" "))])),
        (
            "region_invalid",
            with(&[("/surfaces/0/region", json!({ "x_mm": [50, 0], "y_mm": [0, 2e6] })), start()]),
        ),
        ("region_overlap", with(&[("/surfaces", two([49.9, 100.0])), start()])),
        ("region_unknown_position", with(&[("/surfaces", two([50.0, 100.0]))])),
        (
            "motion_invalid",
            with(&[
                ("/motion/constant/speed_mm_s", json!(-80)),
                ("/motion/constant/force_n", json!(1e4)),
            ]),
        ),
        ("duration_invalid", with(&[("/duration_s", json!(0))])),
        ("budget_invalid", with(&[("/budget", json!({ "ns_per_sample": 0 }))])),
        ("device_field_invalid", with(&[("/device", json!({ "gain_db": 1000, "rate_hz": 0 }))])),
        ("asset_missing", with(&[("/surfaces/0/asset", json!("silk.htex"))])),
        ("asset_invalid", with(&[("/surfaces/0/asset", json!("broken.htex"))])),
        ("representation_missing", with(&[("/surfaces/0/representation", json!("ar"))])),
        ("representation_unplayable", with(&[("/surfaces/0/asset", json!("stranger.htex"))])),
        ("trace_missing", with(&[("/motion", json!({ "trace": "foot.csv" }))])),
        ("trace_invalid", with(&[("/motion", json!({ "trace": "stuck.csv" }))])),
        ("trace_assumed", with(&[("/motion", json!({ "trace": "assumed.csv" }))])),
        (
            "duration_beyond_trace",
            with(&[("/motion", json!({ "trace": "hand.csv" })), ("/duration_s", json!(1.5))]),
        ),
        ("response_missing", with(&[volts(), ("/device/response", json!("silk.csv"))])),
        ("response_invalid", with(&[volts(), ("/device/response", json!("dead.csv"))])),
        ("response_invalid_band", with(&[volts(), ("/device/response", json!("elsewhere.csv"))])),
        ("response_raised", with(&[volts(), ("/device/response", json!("weak.csv"))])),
        ("device_unknown", with(&[("/device", json!({ "adapter": "gramophone" }))])),
        (
            "device_path_unused",
            with(&[("/device", json!({ "settings": { "path": "../out.wav" } }))]),
        ),
        (
            "device_path_unsafe_driver",
            with(&[("/device", json!({ "settings": { "driver": "evil.so" } }))]),
        ),
        (
            "device_path_unused_absolute",
            with(&[("/device", json!({ "settings": { "path": "/out.wav" } }))]),
        ),
        ("device_setting", with(&[("/device", json!({ "settings": { "encoding": "f64" } }))])),
        (
            "device_setting_list",
            with(&[("/device", json!({ "settings": { "encoding": ["f32"] } }))]),
        ),
        ("device_setting_profile", with(&[("/device", json!({ "profile": "rig" }))])),
        (
            "device_setting_limit",
            with(&[("/device", json!({ "settings": { "quantity": "display_voltage" } }))]),
        ),
        ("device_rate", with(&[("/device", json!({ "rate_hz": 50 }))])),
        (
            "device_rate_of_a_carrier",
            with(&[(
                "/device",
                json!({
                    "rate_hz": 7000,
                    "settings": { "quantity": "display_voltage", "limit_v": 100, "carrier_hz": 7000 },
                }),
            )]),
        ),
        ("device_field_unfit", with(&[("/device", json!({ "drive_v": 50, "pitch": 2 }))])),
        (
            "valid_quantity",
            with(&[tool(), ("/device", json!({ "settings": { "quantity": "acceleration" } }))]),
        ),
        ("valid_quantity_gain", with(&[tool(), ("/device", json!({ "quantity_gain": 0.1 }))])),
        ("device_quantity", with(&[tool()])),
        ("device_quantity_of_a_display", with(&[tool(), volts()])),
        ("device_quantity_gain", with(&[("/device", json!({ "quantity_gain": 0.1 }))])),
        (
            "device_quantity_gain_of_a_sound",
            with(&[
                tool(),
                ("/device", json!({ "quantity_gain": 0.1, "settings": { "quantity": "sound" } })),
            ]),
        ),
        (
            "quantities_differ",
            with(&[
                ("/surfaces", two([50.0, 100.0])),
                start(),
                ("/surfaces/1/asset", json!("tool.htex")),
                ("/surfaces/1/representation", json!("auto")),
            ]),
        ),
        ("device_drive_too_high", with(&[volts(), ("/device/drive_v", json!(101))])),
    ];
    let case = |(name, text)| Case { name, text };
    all.into_iter().map(case).collect()
}
