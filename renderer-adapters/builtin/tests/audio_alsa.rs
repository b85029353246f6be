//! Playback through ALSA: its `file` device records the samples.
#![cfg(all(feature = "audio", target_os = "linux"))]
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;
use std::sync::OnceLock;
use std::time::Duration;

use htex_device::{Adapter, Capabilities, DeviceError, Output, Quantity, Settings, StreamFormat};
use htex_device_builtin::audio::Audio;

const LONG: Duration = Duration::from_secs(20);
const RATE_HZ: f64 = 48_000.0;

#[test]
fn what_is_recorded_is_what_was_written() {
    for (name, exact) in [("float", 0.0), ("short", 1.0 / 32_768.0)] {
        let samples: Vec<f32> = (0..4_000).map(|i| (i as f32 * 0.05).sin() * 0.8).collect();
        let mut device = open(name, "1000").unwrap();
        for block in samples.chunks(512) {
            assert_eq!(device.write(block, LONG).unwrap(), block.len());
        }
        assert!((device.status().latency_s - 4_000.0 / RATE_HZ).abs() < 1e-9);
        device.finish().unwrap();
        let status = device.status();
        assert_eq!((status.frames_written, status.frames_played), (4_000, 4_000));
        assert_eq!((status.underruns, status.latency_s), (0, 0.0));
        let closed = device.write(&[0.0], LONG).unwrap_err();
        assert!(matches!(closed, DeviceError::Closed(_)), "{closed}");
        let [left, right] = recorded(name);
        assert!(left == right, "both channels play the stream");
        let (played, after) = left.split_at(samples.len());
        let near = |(a, b): (&f32, &f32)| (a - b).abs() <= exact;
        assert!(played.iter().zip(&samples).all(near), "{name}");
        // The last sample fades to silence.
        assert!(after.iter().all(|x| x.abs() < 0.8) && after.ends_with(&[0.0]));
    }
}

#[test]
fn a_ring_that_runs_dry_is_counted_and_goes_on() {
    let mut device = open("gap", "100").unwrap();
    device.write(&[0.5; 4_800], LONG).unwrap();
    // This card takes samples as fast as it can. It soon finds the ring buffer empty.
    while device.status().underruns == 0 {
        std::thread::sleep(Duration::from_millis(1));
    }
    device.write(&[0.5; 2_400], LONG).unwrap();
    device.finish().unwrap();
    assert_eq!(device.status().frames_played, 7_200);
    let [left, _] = recorded("gap");
    let steepest = left.windows(2).map(|x| (x[1] - x[0]).abs()).fold(0.0, f32::max);
    let full = left.iter().filter(|x| **x == 0.5).count();
    assert!(full >= 4_800 && left.contains(&0.0) && steepest < 0.01, "{full} {steepest}");
}

#[test]
fn a_dropped_device_fades_out() {
    let mut device = open("drop", "10000").unwrap();
    device.write(&[0.5; 300_000], LONG).unwrap();
    drop(device);
    let [left, _] = recorded("drop");
    assert!(left.ends_with(&[0.0]));
    let steepest = left.windows(2).map(|x| (x[1] - x[0]).abs()).fold(0.0, f32::max);
    assert!(steepest < 0.01, "{steepest}");
}

#[test]
fn what_is_beyond_full_scale_is_refused() {
    let mut device = open("loud", "1000").unwrap();
    let error = device.write(&[0.0, 1.0, 1.5], LONG).unwrap_err();
    assert!(matches!(error, DeviceError::OverLimit { frame: 2, .. }), "{error}");
    assert!(matches!(device.write(&[0.0], LONG), Err(DeviceError::Closed(_))));
}

#[test]
fn a_card_says_what_it_can_do() {
    let (audio, _) = (Audio, folder());
    let there = audio.endpoints().unwrap();
    assert!(
        there.iter().any(|e| e.name == "alsa:float" && e.summary.contains("records")),
        "{there:?}"
    );
    let card: Capabilities = audio.capabilities(&settings("alsa:float", "60")).unwrap();
    card.check().unwrap();
    audio.descriptor().check().unwrap();
    assert_eq!((card.quantity, card.limit), (Quantity::Sound, Some(1.0)));
    assert!(card.paced && card.rates.has(RATE_HZ) && card.rates.has(card.default_rate_hz));
}

#[test]
fn a_machine_without_a_card_says_what_to_check() {
    for name in ["default", "alsa:nothing"] {
        let settings = settings(name, "60");
        let error = Audio.capabilities(&settings).unwrap_err();
        assert!(matches!(error, DeviceError::Missing(_)), "{error}");
        assert!(error.to_string().contains(name) && error.to_string().contains("aplay -l"));
    }
}

fn settings(device: &str, buffer_ms: &str) -> Settings {
    folder();
    let given = [("device", device), ("buffer_ms", buffer_ms)];
    let given: BTreeMap<String, String> =
        given.iter().map(|(k, v)| ((*k).to_owned(), (*v).to_owned())).collect();
    Settings::resolve(Audio.descriptor(), None, &given).unwrap()
}

fn open(name: &str, buffer_ms: &str) -> Result<Box<dyn Output>, DeviceError> {
    let format = StreamFormat { rate_hz: RATE_HZ, block_frames: 512 };
    Audio.open_output(&settings(&format!("alsa:{name}"), buffer_ms), &format)
}

/// Returns the two channels that a device recorded.
fn recorded(name: &str) -> [Vec<f32>; 2] {
    let bytes = fs::read(folder().join(name)).unwrap();
    let samples: Vec<f32> = match name {
        "short" => bytes
            .chunks_exact(2)
            .map(|b| f32::from(i16::from_le_bytes([b[0], b[1]])) / 32_768.0)
            .collect(),
        _ => bytes.chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect(),
    };
    [0, 1].map(|channel| samples.iter().skip(channel).step_by(2).copied().collect())
}

/// Returns the folder in which each device records to a file of its own name. ALSA knows only these
/// devices.
fn folder() -> &'static PathBuf {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    FOLDER.get_or_init(|| {
        let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("alsa");
        let _ = fs::remove_dir_all(&folder); // What an earlier run recorded.
        fs::create_dir_all(&folder).unwrap();
        let device = |name: &str| {
            // The `linear` plugin takes only integers.
            let (kind, format) = match name {
                "short" => ("linear", "format S16_LE"),
                _ => ("plug", "format FLOAT_LE rate 48000 channels 2"),
            };
            let file = folder.join(name);
            format!(
                "pcm.{name} {{ type {kind} slave {{ {format} pcm {{ type file file \"{}\" \
                 format raw slave.pcm.type null }} }} \
                 hint {{ show on description \"records {name}\" }} }}\n",
                file.display()
            )
        };
        let devices: String = ["float", "short", "gap", "drop", "loud"].map(device).concat();
        fs::write(folder.join("asound.conf"), devices).unwrap();
        // SAFETY: every test comes here first, so no other thread reads the environment at this
        // time.
        unsafe { std::env::set_var("ALSA_CONFIG_PATH", folder.join("asound.conf")) };
        folder
    })
}
