//! Written files follow the rules of their formats, and lose what is to be expected.

use crate::rules;
use crate::textures;

use htex_author::simulate::Surface;
use htex_exchange::{
    Coding, ExchangeError, Export, ExportedFile, FORMATS, Format, PROFILES, Path, Profile, Stroke,
    Writes, export,
};
use htex_play::{Motion, Texture};
use serde_json::Value;
use textures::texture;

fn of<'a>(format: &str) -> Export<'a> {
    Export::new(Format::find(format).unwrap())
}

/// Checks a file against the rules of its format.
fn check(name: &str, exported: &ExportedFile, profile: &Profile) {
    let json = || serde_json::from_slice::<Value>(&exported.bytes).unwrap();
    match name {
        "haptic" => rules::haptic(&json()),
        "ahap" => rules::ahap(&json()),
        "hjif" => rules::hjif(&json()),
        "android" => rules::android(
            &json(),
            profile.most_points.value as usize,
            profile.shortest_point_ms.value as u64,
        ),
        _ => {
            let wav = hound::WavReader::new(&exported.bytes[..]).unwrap();
            assert_eq!(wav.spec().sample_rate, 8_000);
            let samples = wav.into_samples::<f32>().map(Result::unwrap);
            assert!(samples.into_iter().all(|x| x.abs() <= 1.0));
        }
    }
}

fn stroke() -> Path {
    let mut csv = String::from("t_s,speed_mm_s,force_n\n");
    for i in 0..=300 {
        let t = 0.01 * f64::from(i);
        let speed = 80.0 + 60.0 * (2.0 * t).sin();
        csv += &format!("{t:.2},{speed:.3},{:.3}\n", 0.4 + 0.1 * t.cos());
    }
    Path::Stroke(Stroke::from_bytes("stroke.csv", csv.as_bytes()).unwrap())
}

/// Each format with each profile, at a condition and along a stroke.
#[test]
fn each_file_keeps_the_rules_of_its_format() {
    let asset = texture(Surface::CoarseFabric);
    let mut count = 0;
    let is_signal = |format: &&Format| matches!(format.writes, Some(Writes::Signal { .. }));
    for format in FORMATS.iter().filter(is_signal) {
        for profile in PROFILES.iter() {
            for path in [Path::Condition(Some(Motion::new(100.0, 0.5))), stroke()] {
                let mut how = of(format.name).with_profile(profile).with_path(path);
                how.seconds = 1.007;
                let exported = match export(&asset, &how) {
                    Ok(exported) => exported,
                    Err(ExchangeError::NoSamples { .. }) => {
                        assert_eq!(profile.name, "erm");
                        assert!(["hjif", "wav"].contains(&format.name));
                        continue;
                    }
                    Err(error) => unreachable!("{} {}: {error}", format.name, profile.name),
                };
                check(format.name, &exported, profile);
                let played = exported.played.unwrap();
                assert_eq!(played.profile, profile.name);
                let lost = exported.lost.unwrap();
                let felt = &lost.difference.felt.error;
                assert!(felt.error_rms_db.is_finite() && felt.error_rms_db >= 0.0);
                assert!(lost.level_db.is_finite());
                assert!((0.0..=1.0).contains(&played.limited));
                count += 1;
            }
        }
    }
    assert_eq!(count, 2 * (5 * 6 - 2));
}

/// With a wide actuator that is strong enough, samples lose little, and a single tone loses more.
#[test]
fn samples_lose_less_than_a_tone_does() {
    let asset = texture(Surface::CoarseFabric);
    let wide = Profile::find("console").unwrap();
    let felt = |how: Export<'_>| {
        let exported = export(&asset, &how.with_profile(wide)).unwrap();
        exported.lost.unwrap().difference.felt.error.error_rms_db
    };
    let wav = felt(of("wav"));
    let wavelet = felt(of("hjif").with_coding(Coding::Wavelet));
    let tones = felt(of("hjif"));
    let tone = felt(of("haptic"));
    println!("wav {wav:.2} dB, wavelet {wavelet:.2} dB, tones {tones:.2} dB, tone {tone:.2} dB");
    assert!((wav - wavelet).abs() < 1.0, "{wav} {wavelet}");
    assert!(wav < tones && tones < tone, "{wav} {tones} {tone}");
}

/// The same asset and seed give the same bytes; another seed gives other bytes.
#[test]
fn equal_inputs_give_equal_bytes() {
    let asset = texture(Surface::Vinyl);
    for format in ["haptic", "ahap", "android", "hjif", "wav"] {
        let bytes = |seed| {
            let mut how = of(format);
            how.seed = seed;
            export(&asset, &how).unwrap().bytes
        };
        assert_eq!(bytes(1), bytes(1), "{format}");
        assert_ne!(bytes(1), bytes(2), "{format}");
    }
}

/// A weak actuator is reported as weak.
#[test]
fn what_is_too_strong_is_counted() {
    let asset = texture(Surface::Sandpaper);
    let lra = Profile::find("lra-175").unwrap();
    let weak = Profile {
        strongest_m_s2: htex_exchange::SourcedValue { value: 0.1, source: "assumed".to_owned() },
        ..lra.clone()
    };
    for format in ["haptic", "ahap", "hjif", "wav"] {
        let limited = |profile: &Profile| {
            let exported = export(&asset, &of(format).with_profile(profile)).unwrap();
            exported.played.unwrap().limited
        };
        assert!(limited(&weak) > 0.5, "{format} {}", limited(&weak));
    }
}

#[test]
fn numbers_that_cannot_be_are_refused() {
    let asset = texture(Surface::Vinyl);
    let said = |how: &Export<'_>| export(&asset, how).unwrap_err().to_string();
    for seconds in [0.1, 601.0, f64::NAN] {
        let mut how = of("haptic");
        how.seconds = seconds;
        assert!(said(&how).contains("0.5 to 600 s"), "{seconds}");
    }
    for rate in [100.0, 1e6, f64::NAN] {
        let mut how = of("wav");
        how.rate_hz = Some(rate);
        assert!(said(&how).contains("twice the texture's highest frequency"), "{rate}");
    }
    let mut long = of("android");
    long.seconds = 60.0;
    assert!(said(&long).contains("export a shorter part"), "{}", said(&long));
    let erm = of("wav").with_profile(Profile::find("erm").unwrap());
    assert!(said(&erm).contains("choose haptic, ahap or android"), "{}", said(&erm));
    let slow = of("hjif")
        .with_coding(Coding::Wavelet)
        .with_path(Path::Condition(Some(Motion::new(0.1, 0.4))));
    assert!(said(&slow).contains("choose a higher speed"), "{}", said(&slow));
    for speed_mm_s in [1e6, 1e300] {
        let fast = of("hjif")
            .with_coding(Coding::Wavelet)
            .with_path(Path::Condition(Some(Motion::new(speed_mm_s, 0.4))));
        assert!(said(&fast).contains("choose a lower speed"), "{}", said(&fast));
    }
}

/// A motion outside the recorded ones is exported, and a note says how the asset plays it.
#[test]
fn a_motion_that_was_not_recorded_is_noted() {
    let asset = texture(Surface::Vinyl);
    let noted = |speed, force| {
        let path = Path::at(&asset, None, speed, force).unwrap();
        let notes = export(&asset, &of("wav").with_path(path)).unwrap().notes;
        notes.iter().any(|note| note.contains("was recorded"))
    };
    let recorded = asset.manifest().conditions[0];
    assert!(!noted(None, None));
    assert!(!noted(recorded.speed_mm_s, recorded.force_n));
    assert!(noted(recorded.speed_mm_s.map(|speed| 2.0 * speed), None));
}

#[test]
fn an_export_says_which_rights_the_file_states() {
    let asset = texture(Surface::Vinyl);
    let stated = |license: &str, author: &str, format: &str| {
        let mut data = asset.data().clone();
        data.manifest.license = Some(license.to_owned()).filter(|own| !own.is_empty());
        data.manifest.author = Some(author.to_owned()).filter(|own| !own.is_empty());
        export(&Texture::new(data), &of(format)).unwrap().rights
    };
    let all = ["haptic", "ahap", "android", "hjif", "wav", "png", "gltf"];
    for format in all {
        let place = Format::find(format).unwrap().rights.place;
        assert_eq!(
            stated("CC-BY-4.0", "Ada", format),
            format!("It states the licence CC-BY-4.0 and the author Ada ({place}).")
        );
        assert_eq!(
            stated("CC0-1.0", "", format),
            format!("It states the licence CC0-1.0 ({place}).")
        );
        assert!(stated("", "", format).starts_with("It states no licence, and without one"));
    }
    let author = stated("", "Ada", "wav");
    assert!(author.contains("the author Ada") && author.contains("no licence"), "{author}");
}

/// The Kotlin code has the same numbers as the JSON.
#[test]
fn kotlin_has_the_points_of_the_envelope() {
    let asset = texture(Surface::Vinyl);
    let mut how = of("android");
    let json: Value = serde_json::from_slice(&export(&asset, &how).unwrap().bytes).unwrap();
    how.extension = Some("kt");
    let kotlin = String::from_utf8(export(&asset, &how).unwrap().bytes).unwrap();
    for name in ["vinylWaveform", "vinylEnvelope", "vinylBasicEnvelope"] {
        assert!(kotlin.contains(&format!("fun {name}(): VibrationEffect =")), "{kotlin}");
    }
    let points = json["waveform_envelope"]["control_points"].as_array().unwrap();
    let line = |p: &Value| {
        let number = |key: &str| p[key].as_f64().unwrap();
        let (amplitude, hertz) = (number("amplitude"), number("frequency_hz"));
        format!(".addControlPoint({amplitude}f, {hertz}f, {}L)", p["duration_ms"])
    };
    assert!(points.iter().all(|p| kotlin.contains(&line(p))), "{kotlin}");
    assert_eq!(kotlin.matches(".addControlPoint(").count(), 2 * points.len());
}

#[test]
fn an_asset_that_cannot_be_played_says_why() {
    let asset: Texture = texture(Surface::Vinyl);
    let error = export(&asset, &of("haptic").with_model("ar")).unwrap_err();
    assert!(error.to_string().contains("ar"), "{error}");
}
