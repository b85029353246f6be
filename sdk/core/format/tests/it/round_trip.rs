//! A written asset reads back equal, and writing it again gives the same bytes.

use crate::common;

use common::{Fitted, asset, fitted, reference, steps};
use htex_format::{
    Asset, Reference, Steps, StoredAs, StoredField, WriteError, round_parameters, round_within,
    stored_bytes,
};
use htex_model::{Descriptor, Kind, StaticDescriptor, StaticField, Store};
use proptest::prelude::*;

fn number() -> impl Strategy<Value = f64> {
    prop_oneof![-1e3..1e3, any::<f64>().prop_filter("finite", |x| x.is_finite())]
}

fn store() -> impl Strategy<Value = StoredAs> {
    let steps =
        (1e-6..1e3, -1e3..1e3).prop_map(|(scale, offset)| Steps { scale, offset, log: false });
    let log =
        (1e-6..1e-3, -5.0..5.0).prop_map(|(scale, offset)| Steps { scale, offset, log: true });
    prop_oneof![
        Just(StoredAs::F64),
        Just(StoredAs::F32),
        steps.clone().prop_map(StoredAs::U16),
        steps.prop_map(StoredAs::U8),
        log.clone().prop_map(StoredAs::U16),
        log.clone().prop_map(StoredAs::U8),
        log.prop_map(StoredAs::Packed),
    ]
}

/// A representation with values over the whole range of its stores.
fn representation(i: usize, conditions: usize) -> impl Strategy<Value = Fitted> {
    let field = (store(), 0usize..300, 0.0..1.0f64);
    prop::collection::vec(field, 0..4).prop_map(move |fields| {
        let names = ["a", "b", "c", "d"];
        let numbered = fields.iter().zip(names);
        let shapes: Vec<_> =
            numbered.map(|(&(_, length, _), name)| (name, "Hz", length, StoredAs::F64)).collect();
        let (mut representation, mut flats) = fitted(&format!("m{i}"), conditions, &shapes);
        for (field, (store, ..)) in representation.fields.iter_mut().zip(&fields) {
            field.store = match *store {
                StoredAs::Packed(steps) if !field.list => StoredAs::U8(steps),
                store => store,
            };
        }
        for flat in &mut flats {
            let mut at = 0;
            for &(store, length, place) in &fields {
                at += usize::from(length > 0);
                for value in flat.iter_mut().skip(at).take(length.max(1)) {
                    *value = inside(store, place, *value);
                }
                at += length.max(1);
            }
            *flat = round_parameters(&representation.fields, flat).unwrap();
        }
        (representation, flats)
    })
}

fn inside(store: StoredAs, place: f64, otherwise: f64) -> f64 {
    let (steps, last) = match store {
        StoredAs::U16(steps) => (steps, f64::from(u16::MAX)),
        StoredAs::U8(steps) | StoredAs::Packed(steps) | StoredAs::Coded(steps) => {
            (steps, f64::from(u8::MAX))
        }
        StoredAs::F64 | StoredAs::F32 => return otherwise * place,
    };
    let x = steps.offset + steps.scale * (place * last);
    if steps.log { x.exp() } else { x }
}

fn any_asset() -> impl Strategy<Value = Asset> {
    let words = ("\\PC{1,40}", prop::option::of("\\PC{0,40}"), "\\PC{0,20}", "[a-z]{1,9}");
    let numbers = (0.0..1e4f64, number(), 0..=1u64 << 53, any::<bool>(), any::<bool>());
    let parts =
        (1usize..4).prop_flat_map(|c| (Just(c), representation(0, c), representation(1, c)));
    (parts, words, numbers).prop_map(|((conditions, first, second), words, numbers)| {
        let mut asset = asset(conditions, vec![first, second]);
        let (name, author, tag, key) = words;
        let (level, error, segments, extra, coded) = numbers;
        let manifest = &mut asset.manifest;
        manifest.name = format!("n{name}");
        manifest.author = author;
        manifest.tags = vec![tag.clone()];
        manifest.provenance.simulated = extra;
        manifest.provenance.recordings[0].segments = segments;
        manifest.provenance.options.insert(key.clone(), tag);
        manifest
            .extensions
            .insert(format!("com.example.{key}/2"), serde_json::json!([error, null]));
        let at = &mut manifest.representations[0].at[0];
        at.level_rms = level;
        at.quality.as_mut().unwrap().band_error_db[3] = error;
        if extra {
            manifest.reference = Some(Reference { file: "reference.bin".to_owned() });
            asset.reference = Some(reference(conditions));
        }
        if coded {
            asset = asset.coded();
        }
        asset.manifest = asset.manifest.rounded();
        asset
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 512, failure_persistence: None, ..Default::default() })]

    #[test]
    fn an_asset_comes_back_and_its_bytes_do_too(asset in any_asset()) {
        let bytes = asset.to_bytes().unwrap();
        let read = Asset::from_bytes(&bytes).unwrap();
        prop_assert_eq!(&read, &asset);
        prop_assert_eq!(read.to_bytes().unwrap(), bytes);
        if read.manifest.is_coded() {
            let plain = Asset::from_bytes(&read.clone().plain().to_bytes().unwrap()).unwrap();
            prop_assert_eq!(&plain.parameters, &read.parameters);
            prop_assert_eq!(&plain.coded().parameters, &read.parameters);
            return Ok(());
        }
        for (i, representation) in read.manifest.representations.iter().enumerate() {
            let sizes = read.parameters[i].iter().map(|flat| stored_bytes(&representation.fields, flat).unwrap());
            prop_assert_eq!(sizes.sum::<usize>(), read.payload_bytes(i));
        }
    }

    #[test]
    fn rounding_is_to_the_nearest_step_and_done_once(
        scale in 1e-3..1e2f64, offset in -10.0..10.0f64, place in 0.0..255.0f64,
    ) {
        let (mut fields, _) = (fitted("m", 1, &[("a", "", 0, StoredAs::F64)]).0.fields, ());
        fields[0].store = StoredAs::U8(Steps { scale, offset, log: false });
        let value = offset + scale * place;
        let once = round_parameters(&fields, &[value]).unwrap();
        prop_assert!((once[0] - value).abs() <= scale * 0.500001);
        prop_assert_eq!(&round_parameters(&fields, &once).unwrap(), &once);
    }
}

/// Both limits of a field, and all values between them, stay in the field's range in every store.
#[test]
fn a_value_in_its_range_is_stored_in_it() {
    let stores = [
        (Store::F64, StoredAs::F64),
        (Store::F32, StoredAs::F32),
        stores(|scale, offset, log| Store::U16 { scale, offset, log }, StoredAs::U16),
        stores(|scale, offset, log| Store::U8 { scale, offset, log }, StoredAs::U8),
        stores(|scale, offset, log| Store::Packed { scale, offset, log }, StoredAs::Packed),
    ];
    for (store, stored_as) in stores {
        for (min, max) in [(-0.1, 0.2), (0.1, 0.7), (0.012, 1.2), (-0.3, -0.1)] {
            let list = matches!(store, Store::Packed { .. });
            let kind = if list { Kind::List { max_len: 9 } } else { Kind::Scalar };
            let mut model = model();
            let field = &mut model.fields[0];
            (field.kind, field.min, field.max, field.store) = (kind, min, max, store);
            let fields =
                [StoredField { name: "a".to_owned(), unit: String::new(), list, store: stored_as }];
            for part in [0.0, 0.001, 0.3, 0.999, 1.0] {
                let value = if part == 1.0 { max } else { min + part * (max - min) };
                let flat = if list { vec![1.0, value] } else { vec![value] };
                let rounded = round_within(&fields, &model, &flat).unwrap();
                let own = *rounded.last().unwrap();
                assert!(min <= own && own <= max, "{stored_as:?}: {value} became {own}");
                assert!((own - value).abs() <= 0.011, "{stored_as:?}: {value} became {own}");
                // A file reads back exactly the rounded values.
                assert_eq!(round_parameters(&fields, &rounded).unwrap(), rounded);
            }
        }
    }
    // The store has no value in the range.
    let mut model = model();
    (model.fields[0].min, model.fields[0].max) = (0.2, 0.2);
    let fields = [StoredField {
        name: "a".to_owned(),
        unit: String::new(),
        list: false,
        store: StoredAs::F32,
    }];
    let refused = round_within(&fields, &model, &[0.2]);
    assert!(matches!(refused, Err(WriteError::OutOfRange { .. })));
    // A value outside the range stays outside, and is refused when it is read.
    model.fields[0].min = 0.0;
    let outside = round_within(&fields, &model, &[0.3]).unwrap();
    assert!(outside[0] > 0.2);
}

/// A model with one field, from 0 to 1.
fn model() -> Descriptor {
    const FIELDS: &[StaticField] = &[StaticField::scalar("a", "1", (0.0, 1.0), "A.")];
    let model = StaticDescriptor::new("org.example.x", "X", "1.0.0", "X.");
    Descriptor::from(&model.fields(FIELDS))
}

/// Steps of 0.01 that begin below all ranges, halfway between two hundredths.
fn stores(
    store: fn(f64, f64, bool) -> Store,
    stored_as: fn(Steps) -> StoredAs,
) -> (Store, StoredAs) {
    let (scale, offset) = (0.01, -0.994);
    let steps = Steps { scale, offset, log: false };
    (store(scale, offset, false), stored_as(steps))
}

#[test]
fn a_value_outside_its_store_is_named_with_its_range() {
    let fields = fitted("m", 1, &[("peak_hz", "Hz", 2, StoredAs::F64)]).0.fields;
    let stored = |store| vec![htex_format::StoredField { store, ..fields[0].clone() }];
    let message = |store, value| match round_parameters(&stored(store), &[2.0, 1.0, value]) {
        Err(error @ WriteError::OutOfRange { .. }) => error.to_string(),
        other => format!("{other:?}"),
    };
    let text = message(StoredAs::U8(steps(0.5)), 128.0);
    assert!(text.contains("peak_hz[1] is 128") && text.contains("0 to 127.5"), "{text}");
    assert!(message(StoredAs::U16(steps(1.0)), -1.0).contains("0 to 65535"));
    assert!(message(StoredAs::F32, 1e300).contains("peak_hz[1]"));
    assert!(message(StoredAs::F64, f64::NAN).contains("is NaN"));
    assert!(matches!(round_parameters(&fields, &[3.0, 1.0, 2.0]), Err(WriteError::Layout { .. })));
}

#[test]
fn a_broken_asset_is_not_written() {
    let mut broken = asset(1, common::five(1));
    broken.manifest.band.low_hz = f64::NAN;
    assert!(matches!(broken.to_bytes(), Err(WriteError::Invalid { .. })));
    let mut short = asset(1, common::five(1));
    short.parameters.pop();
    let text = short.to_bytes().unwrap_err().to_string();
    assert!(text.contains("parameters by representation: 4 given"), "{text}");
}

#[test]
fn a_file_is_written_whole_and_opened_within_the_limit() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cotton.htex");
    let asset = asset(1, common::five(1));
    asset.write(&path).unwrap();
    assert_eq!(Asset::open(&path).unwrap(), asset);
    std::fs::File::create(&path).unwrap().set_len(17 << 20).unwrap();
    let text = Asset::open(&path).unwrap_err().to_string();
    assert!(text.contains("FILE_TOO_LARGE"), "{text}");
}
