//! The rules of the formats, implemented a second time on plain JSON. They are the rules that other
//! readers of these formats enforce.

use serde_json::Value;

fn list<'a>(value: &'a Value, pointer: &str) -> &'a [Value] {
    match value.pointer(pointer) {
        Some(Value::Array(list)) => list,
        other => panic!("{pointer} is {other:?}"),
    }
}

fn number(value: &Value, key: &str) -> f64 {
    value[key].as_f64().unwrap_or_else(|| panic!("{key} of {value}"))
}

/// The strict `HapticData::validate` (core/haptic_data/src/v1.rs of facebook/meta-haptics-sdk),
/// which reads 32-bit floats.
pub fn haptic(file: &Value) {
    assert_eq!(file["version"]["major"], 1);
    for key in ["minor", "patch"] {
        assert!(file["version"][key].is_u64(), "{key}");
    }
    let envelopes = "/signals/continuous/envelopes";
    let amplitude = list(file, &format!("{envelopes}/amplitude"));
    assert!(amplitude.len() >= 2);
    let time = |point: &Value| number(point, "time") as f32;
    let sorted = |points: &[Value]| points.windows(2).all(|pair| time(&pair[0]) <= time(&pair[1]));
    assert!(sorted(amplitude) && time(&amplitude[0]) >= 0.0);
    let (start, end) = (time(&amplitude[0]), time(&amplitude[amplitude.len() - 1]));
    assert!(end > start);
    for point in amplitude {
        let value = number(point, "amplitude") as f32;
        assert!((0.0..=1.0).contains(&value));
        if let Some(emphasis) = point.get("emphasis") {
            assert!((value..=1.0).contains(&(number(emphasis, "amplitude") as f32)));
            assert!((0.0..=1.0).contains(&(number(emphasis, "frequency") as f32)));
        }
    }
    let frequency = list(file, &format!("{envelopes}/frequency"));
    assert!(sorted(frequency));
    for point in frequency {
        assert!((0.0..=1.0).contains(&(number(point, "frequency") as f32)));
        assert!((start..=end).contains(&time(point)));
    }
}

/// The rules in Core Haptics' documentation, and what Meta's reader of `.ahap` accepts
/// (core/haptic_data/src/ahap.rs).
pub fn ahap(file: &Value) {
    assert_eq!(number(file, "Version"), 1.0);
    let mut seconds = 0.0;
    for entry in list(file, "/Pattern") {
        let (kind, entry) = entry.as_object().into_iter().flatten().next().unwrap();
        match &kind[..] {
            "Event" => {
                assert_eq!(entry["EventType"], "HapticContinuous");
                let duration = number(entry, "EventDuration");
                assert!(duration > 0.0 && duration <= 30.0, "{duration}");
                seconds += duration;
                let parameters = list(entry, "/EventParameters");
                let ids: Vec<&Value> = parameters.iter().map(|p| &p["ParameterID"]).collect();
                assert_eq!(ids, ["HapticIntensity", "HapticSharpness"]);
                let values = parameters.iter().map(|p| number(p, "ParameterValue"));
                assert!(values.into_iter().all(|v| (0.0..=1.0).contains(&v)));
            }
            "ParameterCurve" => {
                let id = entry["ParameterID"].as_str().unwrap_or_default();
                assert!(["HapticIntensityControl", "HapticSharpnessControl"].contains(&id), "{id}");
                let points = list(entry, "/ParameterCurveControlPoints");
                assert!(!points.is_empty() && points.len() <= 16);
                assert_eq!(number(&points[0], "Time"), 0.0);
                let times: Vec<f64> = points.iter().map(|p| number(p, "Time")).collect();
                assert!(times.is_sorted() && number(entry, "Time") >= 0.0);
                let values = points.iter().map(|p| number(p, "ParameterValue"));
                assert!(values.into_iter().all(|v| (0.0..=1.0).contains(&v)));
            }
            other => panic!("{other}"),
        }
    }
    assert!(seconds > 0.0);
}

/// Android's builders: `createWaveform`, `WaveformEnvelopeBuilder`, `BasicEnvelopeBuilder`, and
/// what `VibratorEnvelopeEffectInfo` guarantees.
pub fn android(file: &Value, most_points: usize, shortest_ms: u64) {
    let timings = list(file, "/waveform/timings_ms");
    let amplitudes = list(file, "/waveform/amplitudes");
    assert_eq!(timings.len(), amplitudes.len());
    assert!(timings.iter().any(|ms| ms.as_u64() > Some(0)));
    assert!(amplitudes.iter().all(|a| a.as_u64().is_some_and(|a| a <= 255)));
    for (envelope, amplitude, other) in [
        ("waveform_envelope", "amplitude", "frequency_hz"),
        ("basic_envelope", "intensity", "sharpness"),
    ] {
        let points = list(file, &format!("/{envelope}/control_points"));
        assert!(!points.is_empty() && points.len() <= most_points, "{}", points.len());
        for point in points {
            let ms = point["duration_ms"].as_u64().unwrap_or_default();
            assert!((shortest_ms..=1_000).contains(&ms), "{envelope}: {ms} ms");
            assert!((0.0..=1.0).contains(&number(point, amplitude)));
            assert!(number(point, other) >= 0.0);
        }
        assert_eq!(number(&points[points.len() - 1], amplitude), 0.0);
    }
}

/// What `IOJson::loadFile` of the reference software (MPEGGroup/HapticReferenceSoftware) requires,
/// and the rules of its conformance check for files of the profile Main, level 1.
pub fn hjif(file: &Value) {
    let year = file["version"].as_str().unwrap_or_default();
    assert!(year.parse::<u32>().is_ok_and(|year| year >= 2023), "{year}");
    assert_eq!(file["profile"], "Main");
    assert_eq!(file["level"], 1);
    let date = file["date"].as_str().unwrap_or_default().as_bytes();
    assert!(date.len() >= 4 && date[..4].iter().all(u8::is_ascii_digit));
    assert!(file["description"].is_string());
    assert!((1..=48_000).contains(&file["timescale"].as_u64().unwrap_or_default()));
    assert!(file["avatars"].is_array() && file["syncs"].is_array());
    for perception in list(file, "/perceptions") {
        for key in ["id", "avatar_id", "unit_exponent"] {
            assert!(perception[key].is_i64(), "{key}");
        }
        assert!(perception["description"].is_string() && perception["effect_library"].is_array());
        let modality = perception["perception_modality"].as_str().unwrap_or_default();
        assert!(["Vibrotactile", "Vibrotactile Texture"].contains(&modality), "{modality}");
        for device in list(perception, "/reference_devices") {
            assert!(device["id"].as_u64() >= Some(1) && device["name"].is_string());
            let hertz = ["minimum_frequency", "resonance_frequency", "maximum_frequency"];
            assert!(hertz.map(|key| number(device, key)).is_sorted());
        }
        for channel in list(perception, "/channels") {
            check_channel(channel, perception);
        }
    }
}

fn check_channel(channel: &Value, perception: &Value) {
    assert!(channel["id"].is_i64() && channel["description"].is_string());
    assert!(channel["gain"].is_number() && channel["mixing_coefficient"].is_number());
    assert!(channel["body_part_mask"].is_u64());
    let devices = list(perception, "/reference_devices");
    assert!(devices.iter().any(|d| d["id"] == channel["reference_device_id"]));
    let bands = list(channel, "/bands");
    assert!(!bands.is_empty() && bands.len() <= 7, "{}", bands.len());
    for band in bands {
        let limits = ["lower_frequency_limit", "upper_frequency_limit"]
            .map(|key| band[key].as_i64().unwrap_or_else(|| panic!("{key}")));
        assert!(limits[0] <= limits[1]);
        assert!(band.get("curve_type").is_none());
        let is_wavelet = band["band_type"] == "WaveletWave";
        assert!(is_wavelet || band["band_type"] == "VectorialWave");
        assert_eq!(is_wavelet, band["block_length"].is_i64());
        for effect in list(band, "/effects") {
            assert_eq!(effect["effect_type"], "Basis");
            assert!(effect["position"].is_i64() && effect["phase"].is_number());
            assert_eq!(effect["base_signal"], "Sine");
            for keyframe in list(effect, "/keyframes") {
                assert!(keyframe["relative_position"].is_i64());
                assert!(keyframe["amplitude_modulation"].is_number());
                assert!(keyframe.get("frequency_modulation").is_none_or(Value::is_i64));
            }
        }
    }
}
