//! The example `live` renders without a sound card.

#[allow(dead_code, reason = "the example also plays")]
#[path = "../../examples/live/player.rs"]
mod player;

const TEXTURES: [&str; 2] = ["vinyl.htex", "coarse-fabric.htex"];

fn texture(name: &str) -> String {
    format!("{}/../../../examples/scenes/{name}", env!("CARGO_MANIFEST_DIR"))
}

/// Both textures sound at the same level, and the fade between them neither clicks nor drops.
#[test]
fn a_stroke_over_two_textures_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("stroke.wav");
    player::write_wav(&file, &TEXTURES.map(texture)).unwrap();
    let mut wav = hound::WavReader::open(&file).unwrap();
    assert_eq!(wav.spec().sample_rate, 48_000);
    let samples: Vec<f32> = wav.samples().collect::<Result<_, _>>().unwrap();
    assert_eq!(samples.len(), 4 * 48_000);
    let rms = |part: &[f32]| {
        (part.iter().map(|x| f64::from(*x).powi(2)).sum::<f64>() / part.len() as f64).sqrt()
    };
    let (vinyl, fabric) = samples.split_at(2 * 48_000);
    for played in [vinyl, fabric] {
        assert!((0.02..0.5).contains(&rms(played)), "{}", rms(played));
    }
    // 40 ms around the change, which takes 20 ms.
    let change = rms(&samples[2 * 48_000 - 960..2 * 48_000 + 960]);
    assert!(change > 0.2 * rms(vinyl).min(rms(fabric)), "{change}");
    assert!(samples.iter().all(|x| x.abs() <= 1.3));
}
