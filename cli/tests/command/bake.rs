//! `htex bake` as a user runs it.

use std::sync::LazyLock;

use crate::common::{Files, Place, numbers, stated};
use htex_player::{Block, BlockKind, Player};

/// A place with the asset `t.htex`, and the level of sBeta.
fn fitted() -> (Place, f64) {
    static FITTED: LazyLock<(Files, f64)> = LazyLock::new(fit);
    (Place::with(&FITTED.0), FITTED.1)
}

fn fit() -> (Files, f64) {
    let place = Place::new();
    let csv = place.recording("coarse-fabric");
    let at = ["--at", "speed=80,force=0.4", "-o", "t.htex", "--json"];
    let fit = place.json(&[&["fit", &csv][..], &at].concat());
    let level = stated(&fit, 3)["level_rms"].as_f64().unwrap();
    (place.files(), level)
}

fn bytes(place: &Place, name: &str) -> Vec<u8> {
    std::fs::read(place.path(name)).unwrap()
}

/// The numbers between the last pair of brackets.
fn listed(source: &str, brackets: [char; 2]) -> Vec<u8> {
    let from = source.rfind(brackets[0]).unwrap() + 1;
    let to = source.rfind(brackets[1]).unwrap();
    let numbers = source[from..to].split(',').map(str::trim);
    numbers.filter(|x| !x.is_empty()).map(|x| x.parse().unwrap()).collect()
}

#[test]
fn a_condition_is_written_as_bytes_and_as_source() {
    let (place, level) = fitted();
    let bake = |name: &str| {
        let at = ["--at", "speed=80,force=0.4", "-o", name];
        let run = place.run(&[&["bake", "t.htex", "--model", "sbeta"][..], &at].concat());
        assert_eq!(run.code(), 0, "{}", run.error());
        assert!(run.text().contains("org.htex.sbeta at 8000 Hz, 1 conditions"), "{}", run.text());
        bytes(&place, name)
    };
    let block = bake("t.bin");
    let header = String::from_utf8(bake("my-texture.h")).unwrap();
    let source = String::from_utf8(bake("my-texture.rs")).unwrap();
    let length = block.len();
    assert!(header.contains(&format!("static const uint8_t my_texture[{length}] = {{")));
    assert!(source.contains(&format!("pub static MY_TEXTURE: [u8; {length}] = [")));
    assert_eq!(listed(&header, ['{', '}']), block);
    assert_eq!(listed(&source, ['[', ']']), block);
    assert_eq!(bake("again.bin"), block);

    for (output, name, line) in [
        ("a.h", "felt2", format!("static const uint8_t felt2[{length}] = {{")),
        ("a.rs", "FELT_2", format!("pub static FELT_2: [u8; {length}] = [")),
    ] {
        let at = ["--at", "speed=80,force=0.4", "--name", name, "-o", output];
        let run = place.run(&[&["bake", "t.htex", "--model", "sbeta"][..], &at].concat());
        assert_eq!(run.code(), 0, "{}", run.error());
        let text = String::from_utf8(bytes(&place, output)).unwrap();
        assert!(text.contains(&line), "{text}");
    }
    let numbers = Block::open(&block).unwrap().numbers();
    assert!(header.contains(&format!("#define MY_TEXTURE_NUMBERS {numbers}\n")));

    let block = Block::open(&block).unwrap();
    assert!(matches!(block.kind(), BlockKind::Noise { .. }));
    let mut samples = vec![0.0; 80_000];
    Player::new(block, 1).render(&mut samples);
    let power: f64 = samples.iter().map(|x| f64::from(*x).powi(2)).sum();
    let ratio = (power / 80_000.0).sqrt() / level;
    assert!((0.95..1.15).contains(&ratio), "{ratio}");
}

#[test]
fn a_grid_gets_the_conditions_its_accuracy_needs() {
    let place = Place::new();
    let vinyl = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/scenes/vinyl.htex");
    std::fs::copy(vinyl, place.path("t.htex")).unwrap();
    let bake = |within: &str| {
        let grid = ["--grid", "speed=40:120:2,force=0.2:0.6:2", "--within", within];
        let output = ["-o", "t.bin", "--json"];
        place.json(&[&["bake", "t.htex", "--model", "mfcc"][..], &grid, &output].concat())
    };
    let (coarse, fine) = (bake("20"), bake("0.3"));
    assert_eq!(numbers(&coarse["speeds_mm_s"]), [40.0, 120.0]);
    assert_eq!(numbers(&fine["forces_n"]).first(), Some(&f64::from(0.2f32)));
    assert!(numbers(&fine["speeds_mm_s"]).len() > 2, "{fine}");
    let error = |report: &serde_json::Value| report["error_between_db"].as_f64().unwrap();
    assert!(error(&fine) <= 0.3 && error(&coarse) > 0.3, "{coarse} and {fine}");
    let block = bytes(&place, "t.bin");
    assert_eq!(fine["bytes"], block.len());
    let block = Block::open(&block).unwrap();
    assert_eq!(block.speeds_mm_s().len(), numbers(&fine["speeds_mm_s"]).len());
}

#[test]
fn sinusoids_and_rates() {
    let (place, _) = fitted();
    let bake = ["bake", "t.htex", "--model", "speak", "-o", "t.bin"];
    for rate in ["2100", "8000", "44100", "100000"] {
        let report = place.json(&[&bake[..], &["--rate", rate, "--json"]].concat());
        assert_eq!(report["tones"], 10, "{report}");
        let block = bytes(&place, "t.bin");
        let block = Block::open(&block).unwrap();
        assert_eq!(block.rate_hz(), rate.parse::<f32>().unwrap());
    }
}

#[test]
fn quantity_and_law_are_told_and_a_narrow_grid_is_warned_of() {
    let place = Place::new();
    let csv = place.recording("coarse-fabric");
    let at = ["--at", "speed=80,force=0.4", "--contact", "finger", "-o", "t.htex"];
    assert_eq!(place.run(&[&["fit", &csv][..], &at].concat()).code(), 0);
    let bake = |more: &[&str]| place.run(&[&["bake", "t.htex", "-o", "t.bin"][..], more].concat());
    let one = ["--at", "speed=80,force=0.4", "--model", "sslope"];
    let run = bake(&one);
    assert_eq!(run.code(), 0, "{}", run.error());
    for words in [
        "samples: lateral force, N, full scale",
        "frequency over speed ^1.00, level over speed ^0.00, level over force ^1.00",
        "dB at half the lowest and twice the highest speed",
    ] {
        assert!(run.text().contains(words), "{}", run.text());
    }
    assert!(run.error().contains("keeps the frequencies"), "{}", run.error());
    let wide = ["--grid", "speed=60:120:2,force=0.4", "--model", "sslope"];
    assert!(!bake(&wide).error().contains("keeps the frequencies"));
    let report = place.json(&[&["bake", "t.htex", "-o", "t.bin", "--json"][..], &one].concat());
    assert!(report["error_beyond_db"].as_f64().unwrap() > 1.0, "{report}");
    assert_eq!((&report["unit"], &report["quantity"]), (&"N".into(), &"lateral_force".into()));
    assert_eq!(report["law"]["frequency_speed"], 1.0);
    let block = bytes(&place, "t.bin");
    let block = Block::open(&block).unwrap();
    assert_eq!(report["full_scale"].as_f64().unwrap() as f32, block.full_scale());
    // Sinusoids follow.
    let tones = ["--at", "speed=80,force=0.4", "--model", "speak"];
    let run = bake(&tones);
    assert!(!run.error().contains("keeps the frequencies"), "{}", run.error());
}

#[test]
fn wrong_conditions_rates_and_names_are_explained() {
    let (place, _) = fitted();
    for (arguments, words) in [
        (&["--at", "speed=80", "-o", "t.bin"][..], "a speed and a force"),
        (&["--at", "speed=fast,force=1", "-o", "t.bin"], "a speed and a force"),
        (&["--at", "speed=0,force=0.4", "-o", "t.bin"], "from 0.5 to"),
        (&["--grid", "speed=40:80:1,force=0.4", "-o", "t.bin"], "count from 2 to 32"),
        (&["--rate", "1500", "-o", "t.bin"], "the rate is from 2050"),
        (&["--within", "0", "-o", "t.bin"], "above 0"),
        (&["--longest", "64", "-o", "t.bin"], "65..=641"),
        (&["-o", "t.wav"], ".bin, .h or .rs"),
        (&["--name", "felt", "-o", "t.bin"], "have no name"),
        (&["--name", "2felt", "-o", "t.h"], "begins with a letter"),
        (&["--name", "float", "-o", "t.h"], "is no keyword"),
        (&["--name", "felt", "-o", "t.rs"], "capital letters"),
        (&["-o", "t.htex"], "it is read here"),
        (
            &["--at", "speed=40,force=0.2", "--at", "speed=80,force=0.4", "-o", "t.bin"],
            "all combinations",
        ),
    ] {
        let run = place.run(&[&["bake", "t.htex"][..], arguments].concat());
        assert_eq!(run.code(), 2, "{arguments:?}: {}", run.error());
        assert!(run.error().contains(words), "{arguments:?}: {}", run.error());
        assert!(!place.path("t.bin").exists());
    }
    let run = place.run(&["bake", "t.htex", "--model", "none", "-o", "t.bin"]);
    assert_eq!(run.code(), 1);
    assert!(run.error().contains("no representation `none`"), "{}", run.error());
}
