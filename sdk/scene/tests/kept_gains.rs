//! Concurrent updates of a gains file.
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

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
