//! Compares the program's WAV file with the samples of a voice.

use std::path::Path;
use std::process::Command;

use htex::{Motion, Texture, VoiceOptions};

/// The source reads the finger every 64 samples, and the finger moves every 480 samples.
#[test]
fn the_file_has_the_samples_of_a_voice() {
    let texture = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/vinyl.htex");
    let folder = tempfile::tempdir().unwrap();
    let wav = folder.path().join("vinyl.wav");
    let mut app = Command::new(env!("CARGO_BIN_EXE_app-rust-rodio"));
    let status = app.arg(&texture).arg("--wav").arg(&wav).arg("2").status().unwrap();
    assert!(status.success());

    let texture = Texture::open(texture).unwrap();
    let options = VoiceOptions::default()
        .with_rate_hz(48_000.0)
        .with_gain(0.1 / texture.level_rms(None).unwrap())
        .with_limit(0.9);
    let mut voice = texture.voice(&options).unwrap();
    let mut expected = vec![0.0; 2 * 48_000];
    for (block, samples) in expected.chunks_mut(64).enumerate() {
        let phase = (block * 64 / 480 % 100) as f32 / 100.0;
        let speed_mm_s = 240.0 * phase.min(1.0 - phase);
        voice.set_motion(Motion::new(speed_mm_s.into(), 0.4_f32.into())).unwrap();
        voice.render(samples).unwrap();
    }

    let mut reader = hound::WavReader::open(wav).unwrap();
    assert_eq!((reader.spec().channels, reader.spec().sample_rate), (1, 48_000));
    let samples: Vec<f32> = reader.samples().map(Result::unwrap).collect();
    let bits = |samples: &[f32]| samples.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
    assert!(bits(&samples) == bits(&expected));
    assert!(samples.iter().any(|sample| sample.abs() > 0.1));
}
