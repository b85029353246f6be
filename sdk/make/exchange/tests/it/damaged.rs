//! Damaged or too large files are refused, and the error names the place.

use crate::common::busy;

use std::time::Duration;

use busy::Busy;
use htex_exchange::{Physical, missing, recording_of};
use serde_json::{Value, json};

fn haptic() -> Value {
    json!({
        "version": {"major": 1, "minor": 0, "patch": 0},
        "metadata": {"tags": ["cloth"]},
        "signals": {"continuous": {"envelopes": {
            "amplitude": [{"time": 0, "amplitude": 0.2}, {"time": 0.5, "amplitude": 0.4, "emphasis": {"amplitude": 0.6, "frequency": 0.7}},
                {"time": 1, "amplitude": 0.1}],
            "frequency": [{"time": 0, "frequency": 0.5}, {"time": 1, "frequency": 0.6}],
        }}},
    })
}

fn ahap() -> Value {
    json!({"Version": 1, "Pattern": [
        {"Event": {"Time": 0, "EventType": "HapticContinuous", "EventDuration": 1, "EventParameters": [
            {"ParameterID": "HapticIntensity", "ParameterValue": 0.5}]}},
        {"Event": {"Time": 0.5, "EventType": "HapticTransient", "EventParameters": []}},
        {"ParameterCurve": {"ParameterID": "HapticSharpnessControl", "Time": 0, "ParameterCurveControlPoints": [
            {"Time": 0, "ParameterValue": 0}, {"Time": 1, "ParameterValue": 0.5}]}},
        {"Parameter": {"ParameterID": "HapticIntensityControl", "ParameterValue": 0.9, "Time": 0.5}},
    ]})
}

fn hjif() -> Value {
    let wave = json!({"effect_type": "Basis", "position": 0, "phase": 0, "base_signal": "Sine", "keyframes": [
        {"relative_position": 0, "amplitude_modulation": 0.5, "frequency_modulation": 120},
        {"relative_position": 900, "amplitude_modulation": 0.5}]});
    let known = json!({"effect_type": "Basis", "id": 7, "position": 0, "phase": 0, "base_signal": "Triangle", "keyframes": [
        {"relative_position": 0, "amplitude_modulation": 0.2, "frequency_modulation": 60}, {"relative_position": 100}]});
    let reference = json!({"effect_type": "Reference", "id": 7, "position": 300});
    let pulse = json!({"effect_type": "Basis", "position": 100, "phase": 0, "base_signal": "Sine", "keyframes": [
        {"relative_position": 0, "amplitude_modulation": 0.7, "frequency_modulation": 100}]});
    let bands = json!([
        {"band_type": "VectorialWave", "lower_frequency_limit": 0, "upper_frequency_limit": 1000, "effects": [wave, reference]},
        {"band_type": "Transient", "lower_frequency_limit": 65, "upper_frequency_limit": 300, "effects": [pulse]},
    ]);
    let channel = json!({"id": 0, "description": "", "gain": 1, "mixing_coefficient": 1, "body_part_mask": 0, "reference_device_id": 1,
        "bands": bands});
    let device = json!({"id": 1, "name": "coil", "minimum_frequency": 20, "resonance_frequency": 60, "maximum_frequency": 300});
    let perception = json!({"id": 0, "avatar_id": 0, "description": "", "perception_modality": "Vibrotactile", "unit_exponent": -3,
        "effect_library": [known], "reference_devices": [device], "channels": [channel]});
    json!({"version": "2023", "profile": "Main", "level": 1, "date": "2026", "description": "", "timescale": 1000, "avatars": [],
        "syncs": [], "perceptions": [perception]})
}

fn said(name: &str, bytes: &[u8]) -> String {
    let physical = Physical {
        full_scale: Some(0.1),
        speed_mm_s: Some(80.0),
        force_n: Some(0.4),
        ..Physical::default()
    };
    let read = recording_of(name, bytes, &physical, None);
    read.map_or_else(|error| error.to_string(), |_| "it is read".to_owned())
}

/// The message for a file in which the value at a pointer is replaced, or removed if `to` is null.
fn changed(name: &str, file: &Value, pointer: &str, to: Value) -> String {
    let mut file = file.clone();
    let (parent, key) = pointer.rsplit_once('/').unwrap();
    let parent = file.pointer_mut(parent).unwrap();
    match (parent, to) {
        (Value::Object(map), Value::Null) => drop(map.remove(key)),
        (Value::Object(map), to) => drop(map.insert(key.to_owned(), to)),
        (parent, to) => parent[key.parse::<usize>().unwrap()] = to,
    }
    said(name, file.to_string().as_bytes())
}

#[test]
fn whole_files_are_read() {
    for (name, file) in [("a.haptic", haptic()), ("a.ahap", ahap()), ("a.hjif", hjif())] {
        assert_eq!(said(name, file.to_string().as_bytes()), "it is read", "{name}");
        // With a byte order mark.
        let marked = format!("\u{feff}{file}");
        assert_eq!(said(name, marked.as_bytes()), "it is read", "{name}");
    }
    let draft = hjif()
        .to_string()
        .replace("channels", "tracks")
        .replace("mixing_coefficient", "mixing_weight");
    assert_eq!(said("a.hjif", draft.as_bytes()), "it is read");
    // Meta's legacy files have a last point whose line crosses the end. A null and a missing
    // envelope both mean no envelope.
    let frequency = "/signals/continuous/envelopes/frequency";
    let across = json!([{"time": 0, "frequency": 0.5}, {"time": 1.5, "frequency": 1}]);
    assert_eq!(changed("a.haptic", &haptic(), frequency, across), "it is read");
    assert_eq!(changed("a.haptic", &haptic(), frequency, Value::Null), "it is read");
    let null = haptic().to_string().replace(
        r#""frequency":[{"frequency":0.5,"time":0},{"frequency":0.6,"time":1}]"#,
        r#""frequency":null"#,
    );
    assert!(null.contains("null"), "{null}");
    assert_eq!(said("a.haptic", null.as_bytes()), "it is read");
}

#[test]
fn what_a_file_does_not_say_is_told_of_whole_files_alone() {
    let told = |name: &str, bytes: &[u8]| match missing(name, bytes) {
        Ok(all) => all.iter().map(|one| one.setting).collect::<Vec<_>>().join(", "),
        Err(error) => error.to_string(),
    };
    let hatt = include_bytes!("../felt.xml");
    assert_eq!(told("felt.xml", hatt), "");
    assert!(told("felt.xml", &hatt[..500]).starts_with("felt.xml: line "));
    for (name, file) in [("a.haptic", haptic()), ("a.ahap", ahap()), ("a.hjif", hjif())] {
        let text = file.to_string();
        assert_eq!(told(name, text.as_bytes()), "full_scale, speed, force");
        let torn = told(name, &text.as_bytes()[..text.len() / 2]);
        assert!(torn.contains("line 1 column"), "{name}: {torn}");
    }
    assert!(told("a.mp4", b"").contains("no format that is read"));
}

#[test]
fn damaged_haptic_files_are_named_with_place() {
    let envelopes = "/signals/continuous/envelopes";
    let at = |rest: &str| format!("{envelopes}{rest}");
    for (pointer, to, expected) in [
        ("/version/major".to_owned(), json!(2), "version 2 is not known"),
        ("/version".to_owned(), Value::Null, "missing field `version`"),
        ("/signals".to_owned(), Value::Null, "missing field `signals`"),
        (at("/amplitude"), json!([]), "it has 0 points; it needs two or more"),
        (at("/amplitude"), json!([{"time": 0, "amplitude": 1}]), "it has 1 points"),
        (
            at("/amplitude"),
            json!([{"time": 0, "amplitude": 1}, {"time": 0, "amplitude": 1}]),
            "it has no duration",
        ),
        (at("/amplitude/1/time"), json!(1.5), "1 s is before the 1.5 s of the point before"),
        (at("/amplitude/0/time"), json!(-1), "/amplitude/0/time: the time is -1"),
        (at("/amplitude/2/time"), json!(1e9), "the time is 1000000000"),
        (
            at("/amplitude/0/amplitude"),
            json!(1.1),
            "/amplitude/0/amplitude: the amplitude is 1.1; it must be 0 to 1",
        ),
        (at("/amplitude/0/amplitude"), json!("loud"), "/amplitude/0/amplitude: invalid type"),
        (
            at("/amplitude/1/emphasis/amplitude"),
            json!(0.3),
            "the emphasis is 0.3; it must be 0.4 to 1",
        ),
        (at("/amplitude/1/emphasis/frequency"), json!(2), "/amplitude/1/emphasis/frequency"),
        (at("/frequency/1/time"), json!(-0.5), "/frequency/1/time"),
        (at("/frequency/0/frequency"), json!(-0.1), "/frequency/0/frequency"),
        (
            at("/frequency"),
            json!([{"time": 1, "frequency": 0}, {"time": 1.5, "frequency": 0}]),
            "is outside the amplitude envelope, 0 to 1 s",
        ),
    ] {
        let said = changed("a.haptic", &haptic(), &pointer, to);
        assert!(said.starts_with("a.haptic: ") && said.contains(expected), "{pointer}: {said}");
    }
}

#[test]
fn damaged_ahap_files_are_named_with_place() {
    for (pointer, to, expected) in [
        ("/Version", json!(2), "/Version: version 2 is not known"),
        ("/Pattern", Value::Null, "missing field `Pattern`"),
        (
            "/Pattern/0",
            json!({"ParameterCurves": {}}),
            "/Pattern/0: unknown variant `ParameterCurves`",
        ),
        ("/Pattern/0/Event/EventType", json!("Loud"), "/Pattern/0/Event/EventType"),
        (
            "/Pattern/0/Event/EventDuration",
            Value::Null,
            "/Pattern/0/Event: a continuous event has no EventDuration",
        ),
        (
            "/Pattern/0/Event/EventDuration",
            json!(-1),
            "/Pattern/0/Event/EventDuration: the duration is -1",
        ),
        ("/Pattern/0/Event/Time", json!(1e9), "/Pattern/0/Event/Time"),
        (
            "/Pattern/0/Event/EventParameters/0/ParameterValue",
            json!(1.5),
            "/Pattern/0/Event/EventParameters/0/ParameterValue: the value is 1.5",
        ),
        (
            "/Pattern/2/ParameterCurve/ParameterCurveControlPoints/1/ParameterValue",
            json!(-2),
            "ParameterCurveControlPoints/1/ParameterValue",
        ),
        (
            "/Pattern/2/ParameterCurve/ParameterCurveControlPoints/0/Time",
            json!(2),
            "ParameterCurveControlPoints/1/Time: 1 s is before",
        ),
        ("/Pattern/2/ParameterCurve/Time", json!("now"), "/Pattern/2/ParameterCurve/Time"),
        ("/Pattern/3/Parameter/ParameterValue", json!(9), "/Pattern/3/Parameter/ParameterValue"),
    ] {
        let said = changed("a.ahap", &ahap(), pointer, to);
        assert!(said.starts_with("a.ahap: ") && said.contains(expected), "{pointer}: {said}");
    }
}

#[test]
fn damaged_hjif_files_are_named_with_place() {
    let perception = hjif()["perceptions"][0].clone();
    let band = json!({"band_type": "Curve", "lower_frequency_limit": 0, "upper_frequency_limit": 1, "effects": []});
    let many = Value::Array(vec![band; 8]);
    let block = json!([{"amplitude_modulation": 1}, {"amplitude_modulation": 1}]);
    for (rest, to, expected) in [
        ("", json!([]), "/perceptions: there is no perception"),
        ("", json!([perception, perception]), "/perceptions/1/id: another one has the id 0"),
        (
            "/0/perception_modality",
            json!("Temperature"),
            "no perception vibrates: they are Temperature",
        ),
        ("/0/unit_exponent", json!(9), "/perceptions/0/unit_exponent"),
        ("/0/channels", Value::Null, "missing field `channels`"),
        ("/0/channels/0/gain", json!(1e9), "/perceptions/0/channels/0/gain"),
        (
            "/0/channels/0/reference_device_id",
            json!(4),
            "reference_device_id: there is no reference device 4",
        ),
        (
            "/0/reference_devices/0/maximum_frequency",
            json!(50),
            "maximum_frequency: the frequency is 50; it must be 60",
        ),
        ("/0/channels/0/bands", many, "bands: the number of bands is 8; it must be 0 to 7"),
        ("/0/channels/0/bands/0/band_type", json!("Noise"), "bands/0/band_type"),
        ("/0/channels/0/bands/0/upper_frequency_limit", json!(-1), "bands/0/upper_frequency_limit"),
        ("/0/channels/0/bands/0/curve_type", json!("Cubic"), "curve_type: only bands of curves"),
        (
            "/0/channels/0/bands/0/effects/1/id",
            json!(8),
            "effects/1/id: the effect library has no basis effect of this id",
        ),
        (
            "/0/channels/0/bands/0/effects/1/effect_type",
            json!("Composite"),
            "composite effects are not read",
        ),
        ("/0/channels/0/bands/0/effects/0/position", json!(-1), "effects/0/position"),
        (
            "/0/channels/0/bands/0/effects/0/keyframes/0/relative_position",
            json!(1000),
            "keyframes/1/relative_position: 900 is before",
        ),
        (
            "/0/channels/0/bands/0/effects/0/keyframes/1/relative_position",
            json!(4_000_000_000_u32),
            "and 600 s are read at most",
        ),
        (
            "/0/channels/0/bands/0/effects/0/keyframes/0/amplitude_modulation",
            json!(1e9),
            "keyframes/0/amplitude_modulation",
        ),
        (
            "/0/channels/0/bands/0/effects/0/keyframes/0/frequency_modulation",
            json!(1e9),
            "keyframes/0/frequency_modulation",
        ),
    ] {
        let said = changed("a.hjif", &hjif(), &format!("/perceptions{rest}"), to);
        assert!(said.starts_with("a.hjif: ") && said.contains(expected), "{rest}: {said}");
    }
    let wavelet = hjif().to_string().replace("VectorialWave", "WaveletWave");
    assert!(
        said("a.hjif", wavelet.as_bytes()).contains("a block of wavelets has a power of two"),
        "{block}"
    );
    for (pointer, to, expected) in [
        ("/timescale", json!(0), "/timescale: the timescale is 0"),
        ("/profile", json!("Basic"), "/profile: there is no profile \"Basic\""),
        ("/level", json!(3), "/level: the level is 3"),
    ] {
        let said = changed("a.hjif", &hjif(), pointer, to);
        assert!(said.contains(expected), "{pointer}: {said}");
    }
}

#[test]
fn files_that_end_anywhere_or_repeat_a_key_are_named_with_place() {
    for (name, file) in [("a.haptic", haptic()), ("a.ahap", ahap()), ("a.hjif", hjif())] {
        let text = serde_json::to_string_pretty(&file).unwrap();
        for end in (0..text.len() - 1).step_by(37) {
            let said = said(name, &text.as_bytes()[..end]);
            assert!(said.contains("line ") && said.contains("it is not JSON"), "{end}: {said}");
        }
        let twice = text.replacen('{', "{\"version\": 1, \"version\": 1,", 1);
        assert!(said(name, twice.as_bytes()).contains("/version: the key appears twice"), "{name}");
        assert!(said(name, b"\xff\xfe").contains("it is not JSON"), "{name}");
        assert!(said(name, b"").contains("it is not JSON"), "{name}");
    }
}

#[test]
fn sizes_are_limited() {
    let large = vec![b' '; htex_exchange::MOST_BYTES as usize + 1];
    for name in ["a.haptic", "a.ahap", "a.hjif", "a.xml"] {
        let start = Busy::start();
        let said = match name {
            "a.xml" => {
                let none = htex_exchange::Import::default();
                let registry = htex_play::Registry::builtin();
                htex_exchange::import(name, &large, &none, &registry).unwrap_err().to_string()
            }
            _ => said(name, &large),
        };
        assert!(said.contains("the most") || said.contains("at most 16777216 are read"), "{said}");
        assert!(start.elapsed() < Duration::from_secs(5));
    }
}

/// Small files that would take minutes to read.
#[test]
fn work_is_limited() {
    let event = json!({"Event": {"Time": 0, "EventType": "HapticContinuous", "EventDuration": 1}});
    let point = |i: u32| json!({"Time": f64::from(i) / 1e3, "ParameterValue": f64::from(i % 2)});
    let curve = json!({"ParameterCurve": {"ParameterID": "HapticIntensityControl", "Time": 0,
        "ParameterCurveControlPoints": (0..999).map(point).collect::<Vec<_>>()}});
    let crossed = |events: usize| {
        let mut pattern = vec![event.clone(); events];
        pattern.push(curve.clone());
        said("a.ahap", json!({"Version": 1, "Pattern": pattern}).to_string().as_bytes())
    };
    assert_eq!(crossed(100), "it is read");
    assert!(crossed(1_100).contains("/Pattern: its events have"), "{}", crossed(1_100));
    let long = json!({"Event": {"Time": 0, "EventType": "HapticContinuous", "EventDuration": 600}});
    let long = json!({"Version": 1, "Pattern": vec![long; 7]});
    assert!(
        said("a.ahap", long.to_string().as_bytes()).contains("at most 1000000 and 4000 s are read")
    );

    let mut file = hjif();
    let keyframe =
        json!({"relative_position": 0, "amplitude_modulation": 1, "frequency_modulation": 60});
    file["perceptions"][0]["effect_library"][0]["keyframes"] = json!(vec![keyframe; 30_000]);
    let reference = json!({"effect_type": "Reference", "id": 7, "position": 300});
    file["perceptions"][0]["channels"][0]["bands"][0]["effects"] = json!(vec![reference; 2_000]);
    let start = Busy::start();
    let said = said("a.hjif", file.to_string().as_bytes());
    assert!(said.contains("samples and keyframes at 8000 Hz; leave some out"), "{said}");
    assert!(start.elapsed() < Duration::from_secs(10));
}

/// Files in which the work grows with a product of two numbers: pulses of a referenced effect,
/// pulses of a low frequency, points of curves times parameters of their event, channels times
/// devices.
#[test]
fn no_work_is_left_out_of_the_count() {
    let start = Busy::start();
    let mut pulses = hjif();
    let pulse = json!({"relative_position": 0, "amplitude_modulation": 1});
    let perception = &mut pulses["perceptions"][0];
    perception["effect_library"][0]["keyframes"] = json!(vec![pulse; 3_000]);
    let reference = json!({"effect_type": "Reference", "id": 7, "position": 300});
    perception["channels"][0]["bands"][1]["effects"] = json!(vec![reference; 3_000]);
    let text = pulses.to_string();
    let refused = said("a.hjif", text.as_bytes());
    assert!(refused.contains("/bands/1"), "{refused}");
    assert!(refused.contains("3.2e7 samples"), "{refused}");

    let low = r#"{"Event":{"Time":0,"EventType":"HapticTransient"}}"#;
    let controlled =
        r#"{"Parameter":{"ParameterID":"HapticSharpnessControl","ParameterValue":-1,"Time":0}}"#;
    let lows = [low].repeat(320_000).join(",");
    let text = format!(r#"{{"Version":1,"Pattern":[{controlled},{lows}]}}"#);
    let refused = said("a.ahap", text.as_bytes());
    assert!(refused.contains("/Pattern: its effects have"), "{refused}");

    let parameter = json!({"ParameterID": "a", "ParameterValue": 0});
    let event = json!({"Time": 0, "EventType": "HapticContinuous", "EventDuration": 100,
        "EventParameters": vec![parameter; 60_000]});
    let point = |i: u32| json!({"Time": f64::from(i) / 1e3, "ParameterValue": f64::from(i % 2)});
    let points: Vec<Value> = (0..60_000).map(point).collect();
    let curve = json!({"ParameterID": "HapticIntensityControl", "Time": 0,
        "ParameterCurveControlPoints": points});
    let file = json!({"Version": 1, "Pattern": [{ "Event": event }, { "ParameterCurve": curve }]});
    assert_eq!(said("a.ahap", file.to_string().as_bytes()), "it is read");

    let mut many = hjif();
    many["level"] = json!(2);
    let perception = &mut many["perceptions"][0];
    let channel = |i: u32| json!({"id": i, "reference_device_id": 300_000, "bands": []});
    let channels = perception["channels"].as_array_mut().unwrap();
    channels[0]["reference_device_id"] = json!(300_000);
    channels.extend((1..60_000).map(channel));
    let devices: Vec<Value> = (0..=300_000).map(|i| json!({ "id": i })).collect();
    perception["reference_devices"] = json!(devices);
    assert_eq!(said("a.hjif", many.to_string().as_bytes()), "it is read");
    assert!(start.elapsed() < Duration::from_secs(10));
}
