//! Concurrent updates of a gains file.

use htex_scene::{Gain, GainKey, Gains};

#[test]
fn concurrent_updates_lose_no_gain() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("htex/gains.json");
    let gain = |person: usize, drive_v: f64| Gain {
        key: GainKey {
            person: person.to_string(),
            texture: "cloth".to_owned(),
            device: "org.htex.daq".to_owned(),
            profile: String::new(),
        },
        file: "cloth.htex".to_owned(),
        drive_v,
        reference_rms: None,
        recordings: Vec::new(),
        blake3: None,
    };
    std::thread::scope(|scope| {
        for person in 0..8 {
            let (path, gain) = (&path, &gain);
            scope.spawn(move || {
                for drive_v in [50.0, 60.0, 70.0] {
                    Gains::update(path, |gains| gains.put(gain(person, drive_v), "")).unwrap();
                }
            });
        }
    });
    let kept = Gains::load(&path).unwrap().gains;
    assert_eq!(kept.len(), 8);
    assert!(kept.iter().all(|gain| gain.drive_v == 70.0));
}

/// An unknown key would be lost when the next gain is stored.
#[test]
fn a_file_with_unknown_keys_is_refused_and_kept() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("gains.json");
    let text = r#"{"gains": [{"person": "A", "texture": "cloth", "device": "org.htex.daq", "profile": "", "file": "cloth.htex",
        "drive_v": 60.0, "referece_rms": 0.1}]}"#;
    std::fs::write(&path, text).unwrap();
    let error = Gains::update(&path, |_| {}).unwrap_err().to_string();
    let expected = "there is no key `gains[0].referece_rms`; did you mean `reference_rms`?";
    assert_eq!(error, expected);
    assert_eq!(std::fs::read_to_string(&path).unwrap(), text);
}
