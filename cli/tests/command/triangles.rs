//! Textures that store their triangles, and voices at motions beyond the recorded ones, as a user
//! has them.

use crate::common::Place;
use htex::format::Triangle;
use htex::{Motion, Texture};

/// The asset of `spec/playing-conformance` that stores triangles.
fn stored() -> Texture {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../spec/playing-conformance/triangles.htex");
    Texture::open(folder).unwrap()
}

fn triangles(asset: &Texture) -> Vec<Triangle> {
    asset.manifest().representations[0].triangles.clone()
}

/// Level in the middle of a rectangle's corners: on the diagonal that is used.
fn level(asset: &Texture) -> f64 {
    let middle = Some(Motion::new(100.0, 0.8));
    asset.representation("bands").unwrap().level_rms(middle).unwrap()
}

#[test]
fn stored_triangles_are_shown_and_kept_as_long_as_the_conditions_stay() {
    let place = Place::new();
    let asset = stored();
    // Levels of 0.08 to 0.12 N, in the order of the conditions: the stored diagonal joins the
    // second and the fourth.
    assert!((level(&asset) - 0.1).abs() < 1e-12, "{}", level(&asset));
    asset.data().write(&place.path("a.htex")).unwrap();
    let text = place.run(&["info", "a.htex"]).text();
    assert!(text.contains("bands: interpolated in 4 stored triangles"), "{text}");
    let info = place.json(&["info", "a.htex", "--json"]);
    assert_eq!(
        info["manifest"]["representations"][0]["triangles"],
        serde_json::json!(triangles(&asset))
    );

    let mut plain = asset.data().clone();
    for representation in &mut plain.manifest.representations {
        representation.triangles.clear();
    }
    // Without them three are mixed, one of them the condition on the lower edge.
    let found = Texture::new(plain.clone());
    assert!((level(&found) - level(&asset)).abs() > 0.005, "{}", level(&found));
    plain.write(&place.path("plain.htex")).unwrap();
    plain.manifest.conditions[0].speed_mm_s = Some(20.0);
    plain.write(&place.path("other.htex")).unwrap();

    let open = |name: &str| Texture::open(place.path(name)).unwrap();
    let edited = place.run(&["edit", "a.htex", "--author", "Ann", "-o", "edited.htex"]);
    assert_eq!(edited.code(), 0, "{}", edited.error());
    assert_eq!(triangles(&open("edited.htex")), triangles(&asset));
    let mix = |other: &str, output: &str| {
        let run = place.run(&["mix", "a.htex", other, "--weight", "0.25", "-o", output]);
        assert_eq!(run.code(), 0, "{}", run.error());
        (triangles(&open(output)), run.text())
    };
    let (kept, said) = mix("plain.htex", "kept.htex");
    assert_eq!(kept, triangles(&asset));
    assert!(!said.contains("are left out"), "{said}");
    let (dropped, said) = mix("other.htex", "dropped.htex");
    assert!(dropped.is_empty());
    assert!(said.contains("the stored triangles of org.htex.bands are left out"), "{said}");
}

/// A force far above the recorded ones: as loud as the law says, up to the ceiling.
#[test]
fn a_voice_is_as_loud_as_its_ceiling() {
    let place = Place::new();
    stored().data().write(&place.path("a.htex")).unwrap();
    let synth = |more: &[&str]| {
        let words = ["synth", "a.htex", "--model", "bands", "--seconds", "4", "-o", "a.wav"];
        place.run(&[&words[..], &["--speed", "900", "--force", "19"], more].concat())
    };
    let rms = |more: &[&str]| {
        let run = synth(more);
        assert_eq!(run.code(), 0, "{}", run.error());
        crate::common::rms(&place.samples("a.wav"))
    };
    let free = rms(&[]);
    let bound = rms(&["--ceiling", "1.5"]) / free;
    // The strongest recorded level is at 0.12 N. The law raises the level of the strongest motion
    // by 5.6^0.43 15.8^0.07.
    let law = 5.625f64.powf(0.43) * (19.0f64 / 1.2).powf(0.07) * 0.10 / 0.12;
    assert!((bound * law / 1.5 - 1.0).abs() < 0.02, "{bound} {law}");
    for wrong in ["0", "-1", "inf", "nan"] {
        let run = synth(&[&format!("--ceiling={wrong}")]);
        assert_eq!(run.code(), 2, "{wrong}: {}", run.error());
        assert!(run.error().contains("--ceiling"), "{}", run.error());
    }
}
