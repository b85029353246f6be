//! Stored fields are matched by name.

use htex::model::Band;
use htex::{Error, Registry, Texture, VoiceOptions};
use htex_format::{FieldMismatch, StoredAs, StoredField, match_fields};
use htex_model::{Descriptor, StaticDescriptor, StaticField};
use htex_tests::workspace;

fn conformance(name: &str) -> Texture {
    Texture::open(workspace().join("spec/conformance").join(name)).unwrap()
}

#[test]
fn fields_in_another_order_play_by_their_names() {
    // The block holds beta = 1.5 and then alpha = 2.5.
    let asset = conformance("valid_field_order.htex");
    let (parameters, level_rms) = asset.representation(None).unwrap().parameters(None).unwrap();
    assert_eq!(parameters, [2.5, 1.5]);

    let rate_hz = 20_000.0;
    let options = VoiceOptions::default().with_rate_hz(rate_hz);
    let mut played = [0.0f32; 512];
    asset.voice(&options).unwrap().render(&mut played).unwrap();
    let models = Registry::builtin();
    let sbeta = models.find("sbeta").unwrap();
    let mut stream = htex_host::Stream::new(sbeta, &[2.5, 1.5], Band::TACTILE, rate_hz, 0).unwrap();
    let mut expected = [0.0f32; 512];
    stream.render(&mut expected).unwrap();
    for (played, expected) in played.iter().zip(expected) {
        assert!((f64::from(*played) - f64::from(expected) * level_rms).abs() < 1e-6);
    }
}

#[test]
fn fields_that_are_not_the_models_are_refused_with_their_names() {
    for (file, words) in [
        ("field_unknown.htex", ["the model has no field \"alfa\"", "\"alpha\" is not stored"]),
        ("field_missing.htex", ["\"beta\" is not stored", "1.0.0 is installed"]),
        ("field_kind_wrong.htex", ["\"beta\" is stored as a list", "expects one number"]),
        ("field_unit_wrong.htex", ["\"beta\" is stored in \"Hz\"", "fit the recording again"]),
        (
            "valid_field_of_newer_model.htex",
            [
                "the model has no field \"gamma\"",
                "install version 1.9.0 or newer of org.htex.sbeta",
            ],
        ),
    ] {
        let asset = conformance(file);
        let Err(error @ (Error::Fields { .. } | Error::ModelOlder { .. })) =
            asset.voice(&VoiceOptions::default())
        else {
            panic!("{file} plays");
        };
        for word in words {
            assert!(error.to_string().contains(word), "{file}: {error}");
        }
        let magnitude = asset.magnitude(None, &[100.0]);
        assert_eq!(magnitude.unwrap_err().to_string(), error.to_string());
    }
}

#[test]
fn a_field_with_a_default_may_be_absent() {
    const MODEL: StaticDescriptor =
        StaticDescriptor::new("org.example.x", "X", "1.1.0", "An example.").fields(&[
            StaticField::list("line_hz", "Hz", (0.0, 1e3), 8, "Lines."),
            StaticField::scalar("tilt", "1", (-1.0, 1.0), "Tilt.").defaulted(0.25),
            StaticField::scalar("gain", "1", (0.0, 1.0), "Gain."),
        ]);
    let model = Descriptor::from(&MODEL);
    let field = |name: &str, unit: &str, list| StoredField {
        name: name.to_owned(),
        unit: unit.to_owned(),
        list,
        store: StoredAs::F64,
    };
    let stored = [field("gain", "", false), field("line_hz", "Hz", true)];
    let order = match_fields(&stored, &model).unwrap();
    let arranged = order.arrange(&[0.5, 2.0, 80.0, 240.0]).unwrap();
    assert_eq!(arranged, [2.0, 80.0, 240.0, 0.25, 0.5]);
    assert!(order.arrange(&[0.5, 3.0, 80.0]).is_err());
    let missing = match_fields(&stored[1..], &model).unwrap_err();
    let name = "gain".to_owned();
    assert_eq!(missing, [FieldMismatch::Missing { name }]);
}
