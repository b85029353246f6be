//! Four channels through ALSA: its `file` device records the frames.
#![cfg(all(feature = "audio", target_os = "linux"))]
#![allow(clippy::unwrap_used, unsafe_code)] // A failed unwrap is a failed test; the environment is set.

use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;
use std::time::Duration;

use htex_device::{Adapter, DeviceError, Settings, StreamFormat};
use htex_device_builtin::channels::Channels;

const RATE_HZ: f64 = 48_000.0;
const LONG: Duration = Duration::from_secs(20);

fn settings(given: &[(&str, &str)]) -> Settings {
    let given: BTreeMap<String, String> = [&[("to", "sound"), ("buffer_ms", "1000")], given]
        .concat()
        .iter()
        .map(|(k, v)| ((*k).to_owned(), (*v).to_owned()))
        .collect();
    Settings::resolve(Channels.descriptor(), None, &given).unwrap()
}

#[test]
fn a_card_of_four_channels_plays_on_the_chosen_ones() {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("alsa-channels");
    let _ = fs::remove_dir_all(&folder); // What an earlier run recorded.
    fs::create_dir_all(&folder).unwrap();
    let file = folder.join("pad.raw");
    // The `hw` device of a DualSense accepts exactly four channels, and so does this one.
    let card = format!(
        "pcm.pad {{ type linear slave {{ format S16_LE pcm {{ type plug slave {{ format S16_LE rate 48000 channels 4 \
         pcm {{ type file file \"{}\" format raw slave.pcm.type null }} }} }} }} hint {{ show on description \"a pad\" }} }}\n",
        file.display()
    );
    fs::write(folder.join("asound.conf"), card).unwrap();
    // SAFETY: this process has one test, which has started no other thread.
    unsafe { std::env::set_var("ALSA_CONFIG_PATH", folder.join("asound.conf")) };
    let channels = Channels;
    let listed = channels.endpoints().unwrap();
    assert!(listed.iter().any(|e| e.name == "alsa:pad" && e.setting == "device"), "{listed:?}");
    let settings = settings(&[("device", "alsa:pad")]);
    let can = channels.capabilities(&settings).unwrap();
    can.check().unwrap();
    assert!(can.has_rate(RATE_HZ), "{can:?}");
    let format = StreamFormat { rate_hz: RATE_HZ, block_frames: 480 };
    let mut device = channels.open_output(&settings, &format).unwrap();
    let samples: Vec<f32> = (0..4_000).map(|i| (i as f32 * 0.05).sin() * 0.8).collect();
    for block in samples.chunks(512) {
        assert_eq!(device.write(block, LONG).unwrap(), block.len());
    }
    device.finish().unwrap();
    assert_eq!(device.status().frames_played, 4_000);
    let bytes = fs::read(&file).unwrap();
    let all: Vec<f32> = bytes
        .chunks_exact(2)
        .map(|b| f32::from(i16::from_le_bytes([b[0], b[1]])) / 32_768.0)
        .collect();
    assert!(all.len() > 16_000, "{}", all.len());
    for (n, frame) in all.chunks_exact(4).take(4_000).enumerate() {
        assert_eq!(frame[..2], [0.0, 0.0], "{n}");
        assert!(frame[2] == frame[3] && (frame[2] - samples[n]).abs() < 1e-4, "{n} {frame:?}");
    }
    assert!(all.ends_with(&[0.0; 4]));

    let missing = channels.capabilities(&self::settings(&[("device", "alsa:nothing")]));
    assert!(matches!(missing.unwrap_err(), DeviceError::Missing(_)));
}
