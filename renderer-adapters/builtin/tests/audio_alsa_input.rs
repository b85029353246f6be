//! Recording through ALSA: its `file` device plays a file as an input.
#![cfg(all(feature = "audio", target_os = "linux"))]
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;
use std::sync::{Arc, OnceLock};
use std::time::Duration;

use htex_device::{Adapter, DeviceError, Devices, Input, InputFrames};
use htex_device_builtin::audio::AudioInput;

const LONG: Duration = Duration::from_secs(5);
/// Number of frames in the file that is played.
const FRAMES: usize = 40_000;

#[test]
fn what_is_read_is_what_the_card_delivers() {
    let mut source = open("float", &[("channels", "2"), ("rate_hz", "48000")]).unwrap();
    assert_eq!((source.stream().rate_hz, source.stream().channels.len()), (48_000.0, 2));
    assert_eq!(source.stream().channels[1].name, "ch2");
    let early = source.read(&mut [0.0; 2], Duration::ZERO);
    assert!(matches!(early, Err(DeviceError::Closed(_))), "{early:?}");
    source.start().unwrap();
    let mut read = Vec::new();
    while read.len() < 2 * 20_000 {
        let mut block = [0.0; 2 * 333];
        match source.read(&mut block, LONG).unwrap() {
            InputFrames::Count(frames) => read.extend_from_slice(&block[..2 * frames]),
            InputFrames::End => break,
        }
    }
    let same = |(i, x): (usize, &f64)| *x == f64::from(sample(i));
    assert!(read.iter().enumerate().all(same), "{:?}", &read[..8]);
    source.finish().unwrap();
    let late = source.read(&mut [0.0; 2], Duration::ZERO);
    assert!(matches!(late, Err(DeviceError::Closed(_))), "{late:?}");
    assert!(matches!(source.start(), Err(DeviceError::Closed(_))));
}

/// This card delivers samples as fast as it can. If the test does not read, the buffer soon
/// overflows.
#[test]
fn an_overrun_ends_the_source_behind_what_came_before_it() {
    let mut source = open("float", &[("buffer_s", "0.1")]).unwrap();
    source.start().unwrap();
    std::thread::sleep(Duration::from_millis(500));
    let mut read = Vec::new();
    let error = loop {
        let mut block = [0.0; 2 * 100];
        match source.read(&mut block, LONG) {
            Ok(InputFrames::Count(frames)) => read.extend_from_slice(&block[..2 * frames]),
            Ok(InputFrames::End) => unreachable!("a card does not end"),
            Err(error) => break error,
        }
        assert!(read.len() < 100_000, "it goes on behind a gap");
    };
    let frames = read.len() / 2;
    let is_lost = |e: &DeviceError| matches!(e, DeviceError::Overrun { frames: f, .. } if *f == frames as u64);
    assert!(is_lost(&error) && error.to_string().contains("raise `buffer_s`"), "{error}");
    // As many frames as the buffer holds, minus what the card delivers at once.
    assert!((1_000..=4_800).contains(&frames), "{frames}");
    let same = |(i, x): (usize, &f64)| *x == f64::from(sample(i));
    assert!(read.iter().enumerate().all(same));
    let closed = source.read(&mut [0.0; 2], LONG);
    assert!(matches!(closed, Err(DeviceError::Closed(_))), "{closed:?}");
}

#[test]
fn inputs_are_listed() {
    folder();
    let there = AudioInput.endpoints().unwrap();
    let is_float =
        |e: &htex_device::Endpoint| e.name == "alsa:float" && e.summary.contains("plays");
    assert!(there.iter().any(is_float), "{there:?}");
    AudioInput.descriptor().check().unwrap();
}

#[test]
fn what_a_card_does_not_have_is_refused() {
    for name in ["default", "alsa:nothing"] {
        let error = named(name, &[]).err().unwrap();
        assert!(matches!(error, DeviceError::Missing(_)), "{error}");
        assert!(error.to_string().contains(name) && error.to_string().contains("arecord -l"));
    }
    let cases: [(&[(&str, &str)], &str); 2] = [
        (&[("rate_hz", "44100.5")], "does not run at 44100.5 Hz"),
        (
            &[("rate_hz", "96000"), ("channels", "64"), ("buffer_s", "60")],
            "setting `buffer_s`: 10.9 s of so many samples are the most",
        ),
    ];
    for (given, words) in cases {
        let error = open("float", given).err().unwrap();
        assert!(error.to_string().contains(words), "{error}");
    }
}

fn open(name: &str, given: &[(&str, &str)]) -> Result<Box<dyn Input>, DeviceError> {
    named(&format!("alsa:{name}"), given)
}

fn named(device: &str, given: &[(&str, &str)]) -> Result<Box<dyn Input>, DeviceError> {
    folder();
    let given: BTreeMap<String, String> =
        given.iter().map(|(k, v)| ((*k).to_owned(), (*v).to_owned())).collect();
    Devices::new(vec![Arc::new(AudioInput)]).open_input(&format!("audio:{device}"), None, &given)
}

/// Returns a sample of the file, which has frames of two channels.
fn sample(index: usize) -> f32 {
    let channel = if index.is_multiple_of(2) { 0.5 } else { -0.25 };
    channel * ((index / 2) as f32 * 0.01).sin()
}

/// Returns the folder of the files that the devices play. ALSA knows only these devices.
fn folder() -> &'static PathBuf {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    FOLDER.get_or_init(|| {
        let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("alsa-input");
        fs::create_dir_all(&folder).unwrap();
        let samples: Vec<f32> = (0..2 * FRAMES).map(sample).collect();
        let floats: Vec<u8> = samples.iter().flat_map(|x| x.to_le_bytes()).collect();
        let file = folder.join("float");
        fs::write(&file, floats).unwrap();
        let devices = format!(
            "pcm.float {{ type plug slave {{ format FLOAT_LE rate 48000 channels 2 pcm {{ type file \
             file \"/dev/null\" infile \"{}\" format raw slave.pcm.type null }} }} \
             hint {{ show on description \"plays a file\" }} }}\n",
            file.display()
        );
        fs::write(folder.join("asound.conf"), devices).unwrap();
        // SAFETY: every test comes here first, so no other thread reads the environment at this
        // time.
        unsafe { std::env::set_var("ALSA_CONFIG_PATH", folder.join("asound.conf")) };
        folder
    })
}
