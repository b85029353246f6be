//! The table of formats and the profiles of actuators.

use std::collections::BTreeSet;

use htex_exchange::{
    Coding, Export, FORMATS, Format, Import, PROFILES, Physical, Profile, Reads, Writes, import,
};
use htex_play::Registry;

#[test]
fn names_and_extensions_lead_to_one_format() {
    let names: BTreeSet<&str> = FORMATS.iter().map(|format| format.name).collect();
    assert_eq!(names.len(), FORMATS.len());
    let mut extensions = BTreeSet::new();
    for format in FORMATS {
        assert_eq!(Format::find(format.name).unwrap().title, format.title);
        assert!(format.reads.is_some() || format.writes.is_some(), "{}", format.name);
        for extension in format.extensions.iter().filter(|_| format.reads.is_some()) {
            assert!(extensions.insert(*extension), "{extension}");
            let found = Format::of_file(&format!("a.b.{}", extension.to_uppercase())).unwrap();
            assert_eq!(found.name, format.name);
        }
    }
    assert_eq!(extensions, BTreeSet::from(["ahap", "glb", "gltf", "haptic", "hjif", "png", "xml"]));
    let error = Format::of_file("texture.wav").unwrap_err().to_string();
    assert!(error.contains(".xml, .haptic, .ahap, .hjif, .png, .glb and .gltf"), "{error}");
    assert!(Format::of_file("haptic").is_err());
}

#[test]
fn each_profile_is_whole_and_says_where_its_values_are_from() {
    assert_eq!(PROFILES.len(), 6);
    for profile in PROFILES.iter() {
        assert_eq!(Profile::find(&profile.name).unwrap(), profile);
        let (low, high) = (profile.low_hz.value, profile.high_hz.value);
        assert!((low..=high).contains(&profile.resonance_hz.value), "{}", profile.name);
        for (name, value) in profile.values() {
            assert!(value.value > 0.0 && !value.source.is_empty(), "{} {name}", profile.name);
        }
        assert_eq!(profile.response(0.9 * low), 0.0);
        assert!((profile.response(profile.resonance_hz.value) - 1.0).abs() < 1e-12);
        assert!((profile.part_of(profile.hertz_of(0.3)) - 0.3).abs() < 1e-12);
    }
    let error = Profile::find("phone").unwrap_err().to_string();
    assert!(error.contains("quest, lra-175, erm"), "{error}");
    // A format that exports what an asset plays must have a profile of its own.
    for format in FORMATS {
        if let Some(Writes::Signal { profile, .. }) = format.writes {
            Profile::find(profile).unwrap();
        }
        if let Some(Reads::Positions { profile, .. }) = format.reads {
            Profile::find(profile).unwrap();
        }
    }
}

#[test]
fn a_setting_that_means_nothing_is_refused() {
    let import_of = |name: &str, setting| Format::find(name).unwrap().check_import([setting]);
    let export_of = |name: &str, setting| Format::find(name).unwrap().check_export([setting]);
    assert!(import_of("hatt", "full_scale").is_err());
    assert!(import_of("hjif", "profile").is_err());
    assert!(import_of("haptic", "profile").is_ok());
    assert!(import_of("haptic", "grid").is_err());
    assert!(export_of("wav", "coding").is_err());
    assert!(export_of("hjif", "coding").is_ok());
    assert!(export_of("hjif", "rate").is_err());
    assert!(export_of("wav", "rate").is_ok());
    let error = export_of("wav", "coding").unwrap_err().to_string();
    assert!(
        error.contains("its export takes no `coding`; leave it out (it takes `model`"),
        "{error}"
    );

    let along = |name: &str, setting| {
        let refused = Format::find(name).unwrap().check_export(["stroke", setting]);
        refused.map_or_else(|error| error.to_string(), |()| String::new())
    };
    for setting in ["speed", "force", "seconds"] {
        let error = along("ahap", setting);
        assert!(error.contains(&format!("along a stroke takes no `{setting}`")), "{error}");
    }
    assert_eq!(along("ahap", "profile"), "");
    assert!(along("png", "speed").contains("its export takes no `stroke`"));

    // The functions refuse a setting that is set but does not apply.
    let how = Import {
        physical: Physical { speed_mm_s: Some(80.0), ..Physical::default() },
        ..Import::default()
    };
    let error = import("cork.xml", b"<modelSet/>", &how, &Registry::builtin()).unwrap_err();
    assert!(error.to_string().contains("takes no `speed`"), "{error}");
    let mut how = Export::new(Format::find("ahap").unwrap());
    how.rate_hz = Some(8_000.0);
    let asset = made();
    let error = htex_exchange::export(&asset, &how).unwrap_err().to_string();
    assert!(error.contains("takes no `rate`"), "{error}");
    let not_written = Export::new(Format::find("hatt").unwrap());
    let error = htex_exchange::export(&asset, &not_written).unwrap_err().to_string();
    assert!(error.contains("it is not written; there are haptic, ahap"), "{error}");
    let error = Format::find_for_export("bmp").unwrap_err().to_string();
    assert_eq!(
        error,
        "there is no format `bmp`; there are haptic, ahap, android, hjif, wav, png and gltf"
    );
    let error = Coding::find("tones").unwrap_err().to_string();
    assert_eq!(error, "there is no coding `tones`; there are vectorial and wavelet");
    assert_eq!(Coding::find("wavelet").unwrap(), Coding::Wavelet);
}

/// A second of a sine at half of full scale.
const HUM: &[u8] = br#"{"version": {"major": 1}, "signals": {"continuous": {"envelopes": {
    "amplitude": [{"time": 0, "amplitude": 0.5}, {"time": 1, "amplitude": 0.5}]}}}}"#;

fn made() -> htex_play::Texture {
    let registry = Registry::builtin();
    let how = Import {
        name: "hum",
        physical: Physical {
            full_scale: Some(0.1),
            speed_mm_s: Some(80.0),
            force_n: Some(0.4),
            ..Physical::default()
        },
        fit: htex_author::settings::FitSettings {
            models: Some(vec!["bands".to_owned()]),
            ..Default::default()
        },
        ..Import::default()
    };
    let imported = import("hum.haptic", HUM, &how, &registry).unwrap();
    htex_play::Texture::with_registry(imported.asset, registry)
}

#[test]
fn what_a_file_does_not_say_is_asked_for_and_kept() {
    let none = import("a.haptic", HUM, &Import::default(), &Registry::builtin());
    let error = none.unwrap_err().to_string();
    for word in ["how strong 1 is", "`full_scale`, `speed` and `force`"] {
        assert!(error.contains(word), "{error}");
    }
    let asset = made();
    let manifest = asset.manifest();
    assert_eq!(manifest.name, "hum");
    assert_eq!(manifest.conditions[0].speed_mm_s, Some(80.0));
    assert_eq!(manifest.conditions[0].force_n, Some(0.4));
    // A sine at half of full scale.
    let level = asset.level_rms(None).unwrap();
    assert!((level - 0.05 / 2f64.sqrt()).abs() < 0.001, "{level}");
    let warnings = &manifest.provenance.warnings;
    assert!(warnings.iter().any(|w| w.contains("are repeated 4 times")), "{warnings:?}");
}

#[test]
fn numbers_out_of_range_and_silence_are_refused() {
    let file = |level: f64| {
        format!(
            r#"{{"version": {{"major": 1}}, "signals": {{"continuous": {{"envelopes": {{
            "amplitude": [{{"time": 0, "amplitude": {level}}}, {{"time": 1, "amplitude": {level}}}]}}}}}}}}"#
        )
    };
    let of = |level: f64, full_scale: f64, speed: f64, force: f64| {
        let physical = Physical {
            full_scale: Some(full_scale),
            speed_mm_s: Some(speed),
            force_n: Some(force),
            ..Physical::default()
        };
        let read = htex_exchange::recording_of("a.haptic", file(level).as_bytes(), &physical, None);
        read.map_or_else(|error| error.to_string(), |_| String::new())
    };
    assert_eq!(of(0.5, 0.1, 80.0, 0.4), "");
    assert!(of(0.0, 0.1, 80.0, 0.4).contains("a.haptic: it is silent"));
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(of(0.5, bad, 80.0, 0.4).starts_with("full_scale "), "{bad}");
        assert!(of(0.5, 0.1, bad, 0.4).starts_with("speed "), "{bad}");
        assert!(of(0.5, 0.1, 80.0, bad).starts_with("force "), "{bad}");
    }
}
