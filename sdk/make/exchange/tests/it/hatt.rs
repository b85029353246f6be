//! Model files like the ones in the Penn Haptic Texture Toolkit: filters, triangles, silent edges.

use crate::common;
use crate::common::busy;

use std::f64::consts::TAU;
use std::time::Duration;

use busy::Busy;
use common::{Model, draw, file};
use htex_dsp::line_spectrum::coefficients_of_lines;
use htex_dsp::linear_prediction::is_stable;
use htex_exchange::Naming;
use htex_exchange::hatt::{EXTENSION, MOST_BYTES, asset, extension_schema, read};
use htex_play::{Motion, Texture};
use proptest::prelude::*;

const MODEL: Option<&str> = Some("arma");

fn imported(text: &str) -> Texture {
    let texture = read(text.as_bytes()).unwrap();
    assert_eq!(texture.notes, [""; 0]);
    let made = asset(&texture, &Naming::default()).unwrap();
    Texture::from_bytes(&made.to_bytes().unwrap()).unwrap()
}

/// The magnitude of a model at its rate of 1 kHz, by definition: the amplitude that a Hann window
/// of 0.2 s reads from the model's power density.
fn magnitude(model: &Model, hz: f64) -> f64 {
    let response = |coefficients: &[f64]| {
        let terms = coefficients.iter().enumerate().map(|(i, b)| {
            let angle = -TAU * hz * (i as f64) / 1_000.0;
            (b * libm::cos(angle), b * angle.sin())
        });
        let (re, im) = terms.fold((0.0, 0.0), |(re, im), (a, b)| (re + a, im + b));
        re.hypot(im)
    };
    let density = 2.0 * model.variance / 1_000.0;
    let gain = model.gain * response(&model.ma) / response(&model.ar);
    gain * (2.0 * density * 1.5 * 5.0).sqrt()
}

/// The largest difference from 20 to 490 Hz over all audible models, decibels. Silent models must
/// be silent.
fn largest_error_db(models: &[Model], asset: &Texture) -> f64 {
    let grid: Vec<f64> = (4..=98).map(|bin| 5.0 * f64::from(bin)).collect();
    let mut worst = 0.0f64;
    for model in models {
        let motion = Some(Motion::new(model.speed, model.force));
        let found = asset.representation(MODEL).unwrap().recorded_magnitude(motion, &grid).unwrap();
        for (hz, found) in grid.iter().zip(found) {
            let expected = magnitude(model, *hz);
            if model.variance > 0.0 {
                worst = worst.max((20.0 * (found / expected).log10()).abs())
            } else {
                assert_eq!(found, 0.0, "{hz} Hz at {motion:?}")
            }
        }
    }
    worst
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Each audible model has the magnitude of its filter, and every mix of models is stable.
    #[test]
    fn each_model_is_exact_and_mixes_are_stable(seed in any::<u64>(), poles in 0usize..=20, zeros in 0usize..=18) {
        let models = draw(seed, poles, zeros);
        let asset = imported(&file(&models));
        let error_db = largest_error_db(&models, &asset);
        prop_assert!(error_db < 0.01, "{error_db} dB");
        let mut next = seed | 1;
        let mut part = || {
            next = next.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (next >> 11) as f64 / (1u64 << 53) as f64
        };
        for _ in 0..420 {
            let motion = Motion::new(260.0 * part(), 7.0 * part());
            let (parameters, level_rms) = asset.representation(MODEL).unwrap().parameters(Some(motion)).unwrap();
            let lines = &parameters[1..=parameters[0] as usize];
            let mut coefficients = vec![0.0; lines.len()];
            prop_assert!(coefficients_of_lines(lines, &mut coefficients) && is_stable(&coefficients));
            prop_assert!(level_rms.is_finite());
        }
    }
}

#[test]
fn forty_models_take_less_than_eight_kilobytes() {
    let models = draw(7, 20, 18);
    assert_eq!(models.len(), 40);
    let text = file(&models);
    let made = asset(&read(text.as_bytes()).unwrap(), &Naming::default()).unwrap();
    let bytes = made.to_bytes().unwrap().len();
    println!("{} bytes of XML are {bytes}", text.len());
    assert!(bytes <= 8_000, "{bytes}");
}

/// Zeros outside the circle are mirrored, which leaves the magnitude the same.
#[test]
fn zeros_outside_the_circle_are_mirrored() {
    let mut models = draw(3, 4, 2);
    for (i, model) in models.iter_mut().enumerate() {
        let (radius, angle) = (0.8 + 0.01 * i as f64, 0.1 + 0.05 * i as f64);
        model.ma = vec![1.0, -2.0 * radius * f64::cos(angle), radius * radius];
    }
    let text = file(&models).replace("MAlsf", "other");
    let error_db = largest_error_db(&models, &imported(&text));
    assert!(error_db < 0.01, "{error_db} dB");
}

#[test]
fn the_asset_says_what_it_is() {
    let asset = imported(&file(&draw(1, 6, 4)));
    let manifest = asset.manifest();
    assert_eq!(manifest.name, "Velvet & Co");
    assert_eq!((manifest.unit.as_str(), manifest.contact.name()), ("m/s2", "tool"));
    assert_eq!((manifest.band.low_hz, manifest.band.high_hz), (20.0, 500.0));
    assert_eq!(manifest.law().frequency_speed.exponent, 0.0);
    assert_eq!(manifest.representations[0].triangles.len(), 56);
    let numbers = &manifest.extensions[EXTENSION];
    assert_eq!(numbers["friction_coefficient"], 0.25);
    assert_eq!(numbers["sample_rate_hz"], 1_000.0);
    let schema = htex_base::schema::Schema::new(&extension_schema()).unwrap();
    assert_eq!(schema.violations(numbers), []);
    assert_ne!(schema.violations(&serde_json::json!({"mu": 1})), []);
}

/// The message for a file in which `from` is replaced by `to` once.
fn said(from: &str, to: &str) -> String {
    let text = file(&draw(1, 6, 4));
    assert!(text.contains(from), "{from}");
    let changed = text.replacen(from, to, 1);
    let made = read(changed.as_bytes()).and_then(|texture| asset(&texture, &Naming::default()));
    made.map_or_else(|fault| fault.to_string(), |_| "it is read".to_owned())
}

#[test]
fn damaged_files_are_named_with_place() {
    for (from, to, expected) in [
        ("<modelSet", "<set", "line 310, set: this is no XML"),
        ("<SampleRate>1000", "<SampleRate>fast", "line 6, SampleRate: \"fast\" is no number"),
        ("<SampleRate>1000", "<SampleRate>1e400", "line 6, SampleRate: \"1e400\" is no number"),
        ("<SampleRate>1000", "<SampleRate>5", "line 6, SampleRate: 5 is none from 100"),
        ("<AccelUnits>m/s^2", "<AccelUnits>g", "line 3, AccelUnits: \"g\" is not m/s^2"),
        ("<numMod>40", "<numMod>41", "line 8, numMod: \"41\" are stated and there are 40"),
        ("<numTri>56", "<numTri>57", "numTri: \"57\" are stated and there are 56"),
        (
            "<tri type=\"array\"><value>1<",
            "<tri type=\"array\"><value>0<",
            "value: there is no model 0; they are 1 to 40",
        ),
        (
            "<tri type=\"array\"><value>1</value>",
            "<tri type=\"array\">",
            "tri: 2 corners; a triangle has three",
        ),
        ("<ARcoeff><value>1.0", "<ARcoeff><value>2.0", "ARcoeff: the first coefficient is 2"),
        (
            "<ARlsf><value>",
            "<ARlsf><value>0</value><value>",
            "ARlsf: 7 lines beside 6 coefficients",
        ),
        ("<var>", "<var>x", "var: \"x0\" is no number"),
        ("<speedMod>", "<speed>", "speed"),
        ("</model>", "", "line"),
        ("<gain>", "<gain>1</gain><gain>", "gain: it is there twice"),
        ("<speedList><value>0", "<speedList><value>5", "speedList: value 1 is 5"),
    ] {
        let said = said(from, to);
        assert!(said.contains(expected) && said.starts_with("line "), "{from}: {said}");
    }
    // An unstable filter, and a file that is cut off at any byte.
    let unstable = said("<ARcoeff><value>1.0", "<ARcoeff><value>1.0</value><value>9");
    assert!(unstable.contains("ARcoeff: "), "{unstable}");
    let text = file(&draw(1, 6, 4));
    assert!(
        read(b"<set>\n</set>").unwrap_err().to_string().starts_with("line 1, set: a model file")
    );
    for end in (0..text.len()).step_by(997) {
        let fault = read(&text.as_bytes()[..end]).unwrap_err();
        assert!(
            !fault.problem.is_empty() && (end < 60 || !fault.place.is_empty()),
            "{end}: {fault}"
        );
    }
}

#[test]
fn entities_and_sizes_are_refused() {
    let of = |text: &str| read(text.as_bytes()).unwrap_err().to_string();
    let external = "<!DOCTYPE a [<!ENTITY b SYSTEM 'file:///etc/passwd'>]><modelSet><material>&b;</material></modelSet>";
    assert!(of(external).contains("a document type definition"));
    assert!(of("<modelSet><material>&b;</material></modelSet>").contains("none of the five"));
    assert!(of(&"<a>".repeat(17)).contains("more than 16 elements in each other"));
    let many = format!("<modelSet>{}</modelSet>", "<a/>".repeat(200_001));
    assert!(of(&many).contains("more than 200000 elements"));
    assert!(of(&format!("<a>{}</a>", "x".repeat(5_000))).contains("more than 4096 bytes"));
    assert!(read(&vec![b' '; MOST_BYTES + 1]).unwrap_err().to_string().contains("the most"));
    assert!(
        read(b"<modelSet>\n\xff</modelSet>")
            .unwrap_err()
            .to_string()
            .contains("line 2: this is no UTF-8")
    );
}

/// Blanks are looked at only once, and the work of searching for zeros is counted over the whole
/// file.
#[test]
fn no_file_takes_more_than_seconds() {
    let start = Busy::start();
    let of = |text: &str| read(text.as_bytes()).map_err(|error| error.to_string());
    let blanks = " ".repeat(500_000) + &"&#32;".repeat(120_000);
    let text = file(&draw(1, 6, 4)).replacen("<material>", "<material>x", 1);
    let plain = of(&text).unwrap().material;
    let blank = text.replacen("</material>", &format!("{blanks}</material>"), 1);
    assert_eq!(of(&blank).unwrap().material, plain);
    let inner = text.replacen("</material>", &format!("{blanks}y</material>"), 1);
    assert!(of(&inner).unwrap_err().contains("more than 4096 bytes"));
    let attributes: String = (0..65).map(|i| format!(" a{i}=''")).collect();
    let refused = of(&format!("<modelSet{attributes}/>")).unwrap_err();
    assert!(refused.contains("more than 64 attributes"), "{refused}");

    // Sixteen pairs of zeros outside the circle.
    let mut numerator = vec![1.0];
    for k in 0..16 {
        let (radius, angle) = (1.02 + 0.03 * f64::from(k), 0.05 + 0.19 * f64::from(k));
        let before = numerator.clone();
        numerator.extend([0.0, 0.0]);
        for (i, b) in before.iter().enumerate() {
            numerator[i + 1] -= 2.0 * radius * libm::cos(angle) * b;
            numerator[i + 2] += radius * radius * b;
        }
    }
    let values: String = numerator.iter().map(|b| format!("<value>{b:e}</value>")).collect();
    let model = |i: usize| {
        format!(
            "<model><ARcoeff><value>1</value><value>-0.5</value></ARcoeff><MAcoeff>{values}</MAcoeff>\
             <var>1</var><speedMod>{i}</speedMod><forceMod>1</forceMod></model>"
        )
    };
    let models: String = (0..4_000).map(model).collect();
    let refused =
        of(&format!("<modelSet><SampleRate>1000</SampleRate>{models}</modelSet>")).unwrap_err();
    assert!(refused.contains("take too much work"), "{refused}");
    assert!(start.elapsed() < Duration::from_secs(10));
}

/// Triangles that leave a gap are ignored with a note, and the format's own triangles are used.
#[test]
fn triangles_that_leave_a_gap_are_left_out() {
    let text = file(&draw(1, 6, 4)).replacen("<numTri>56</numTri>", "", 1);
    let from = text.find("<tri ").unwrap();
    let to = from + text[from..].find('\n').unwrap();
    let texture = read([&text[..from], &text[to..]].concat().as_bytes()).unwrap();
    assert!(texture.triangles.is_empty());
    assert!(texture.notes[0].contains("the triangles are left out"), "{:?}", texture.notes);
    assert!(asset(&texture, &Naming::default()).unwrap().to_bytes().is_ok());
}
