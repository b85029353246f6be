//! Tests selected channels of a file, of the output `null`, and of a sound card. (`with_alsa.rs`
//! runs the tests of sound cards if ALSA is installed.)

use std::collections::BTreeMap;
use std::time::{Duration, Instant};

use htex_device::{Adapter, DeviceError, Output, Quantity, Settings, StreamFormat};
use htex_device_builtin::channels::Channels;

const RATE_HZ: f64 = 48_000.0;
const LONG: Duration = Duration::from_secs(5);

fn settings(given: &[(&str, &str)]) -> Result<Settings, DeviceError> {
    let given: BTreeMap<String, String> =
        given.iter().map(|(k, v)| ((*k).to_owned(), (*v).to_owned())).collect();
    Settings::resolve(Channels.descriptor(), None, &given)
}

fn open(given: &[(&str, &str)]) -> Result<Box<dyn Output>, DeviceError> {
    let format = StreamFormat { rate_hz: RATE_HZ, block_frames: 480 };
    Channels.open_output(&settings(given)?, &format)
}

#[test]
fn a_file_has_the_samples_on_the_channels_that_play_them() {
    let folder = tempfile::tempdir().unwrap();
    let samples: Vec<f32> = (0..1_000).map(|i| (i as f32 * 0.05).sin() * 0.8).collect();
    for (plays, factors) in [
        (None, &[0.0, 0.0, 1.0, 1.0][..]),
        (Some("texture,-0.5"), &[1.0, -0.5]),
        (Some("texture"), &[1.0]),
        (Some("off,0.25,off,texture,off,1"), &[0.0, 0.25, 0.0, 1.0, 0.0, 1.0]),
    ] {
        let path = folder.path().join("pad.wav");
        let mut given = vec![("to", "file"), ("path", path.to_str().unwrap())];
        given.extend(plays.map(|plays| ("plays", plays)));
        let mut device = open(&given).unwrap();
        for block in samples.chunks(300) {
            assert_eq!(device.write(block, LONG), Ok(block.len()));
        }
        assert!(!path.exists(), "a file appears when it is finished");
        device.finish().unwrap();
        assert_eq!(device.status().frames_played, 1_000);
        let mut wav = hound::WavReader::open(&path).unwrap();
        let spec = wav.spec();
        assert_eq!((usize::from(spec.channels), spec.sample_rate), (factors.len(), 48_000));
        let played: Vec<f32> = wav.samples::<f32>().map(Result::unwrap).collect();
        let expected = samples.iter().flat_map(|x| factors.iter().map(move |f| x * f));
        assert!(played.iter().copied().eq(expected), "{plays:?}");
        std::fs::remove_file(&path).unwrap();
    }
}

#[test]
fn a_file_that_is_not_finished_is_none() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("pad.wav");
    let given = [("to", "file"), ("path", path.to_str().unwrap())];
    let mut device = open(&given).unwrap();
    device.write(&[0.5; 100], LONG).unwrap();
    let error = device.write(&[1.01], LONG).unwrap_err();
    assert!(matches!(error, DeviceError::OverLimit { frame: 100, .. }), "{error}");
    drop(device);
    drop(open(&given).unwrap());
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn nothing_takes_the_samples_at_the_pace_of_the_clock() {
    let mut device = open(&[("to", "null"), ("buffer_ms", "100")]).unwrap();
    let since = Instant::now();
    assert_eq!(device.write(&[0.5; 14_400], LONG), Ok(14_400));
    device.finish().unwrap();
    assert!(since.elapsed() >= Duration::from_millis(280), "{:?}", since.elapsed());
    assert_eq!(device.status().frames_played, 14_400);
}

#[test]
fn what_cannot_take_effect_is_refused() {
    let channels = Channels;
    channels.descriptor().check().unwrap();
    for (given, name) in [
        (&[("to", "null"), ("path", "a.wav")][..], "path"),
        (&[("to", "null"), ("device", "card")], "device"),
        (&[("to", "file"), ("path", "a.wav"), ("device", "card")], "device"),
        (&[("to", "file"), ("path", "a.wav"), ("buffer_ms", "50")], "buffer_ms"),
        (&[("to", "file")], "path"),
        (&[("to", "sound"), ("path", "a.wav")], "path"),
        (&[("to", "null"), ("plays", "off,off")], "plays"),
        (&[("to", "null"), ("plays", "left,right")], "plays"),
        (&[("plays", "texture")], "to"),
    ] {
        let refused = settings(given).and_then(|s| channels.capabilities(&s));
        match refused {
            Err(DeviceError::Setting { name: named, .. }) => assert_eq!(named, name, "{given:?}"),
            other => unreachable!("{given:?}: {other:?}"),
        }
    }
    let can = channels.capabilities(&settings(&[("to", "null")]).unwrap()).unwrap();
    can.check().unwrap();
    assert_eq!(
        (can.quantity, can.limit, can.default_rate_hz),
        (Quantity::Sound, Some(1.0), RATE_HZ)
    );
    let rate = StreamFormat { rate_hz: 48_001.0, block_frames: 480 };
    let refused = channels.open_output(&settings(&[("to", "null")]).unwrap(), &rate);
    assert!(matches!(refused.err().unwrap(), DeviceError::Rate { .. }));
    assert_eq!(channels.endpoints().unwrap()[0].name, "null");
}

#[cfg(not(feature = "audio"))]
#[test]
fn a_build_without_sound_says_so() {
    let error = open(&[("to", "sound")]).err().unwrap();
    assert!(
        matches!(&error, DeviceError::Missing(text) if text.contains("feature `audio`")),
        "{error}"
    );
}
