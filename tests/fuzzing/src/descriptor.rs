//! Descriptors, as JSON.

use htex_author::stored_fields;
use htex_format::round_parameters;
use htex_host::read_descriptor;
use htex_model::{Descriptor, Kind, Values, flatten};

use crate::promise::{finite, sentence};

/// Longest list that is filled.
const LONGEST: u32 = 8;

/// Reads a descriptor, writes it, and makes parameters that match it.
pub fn descriptor(input: &[u8]) -> bool {
    let Ok(json) = std::str::from_utf8(input) else {
        return false;
    };
    match read_descriptor(json) {
        Ok(descriptor) => {
            let text = serde_json::to_string(&descriptor).expect("a descriptor is JSON");
            assert_eq!(read_descriptor(&text).as_ref(), Ok(&descriptor));
            finite("default", descriptor.default_options());
            [0.0, 0.5, 1.0].iter().for_each(|weight| use_at(&descriptor, *weight));
            true
        }
        Err(what) => {
            sentence(&what);
            false
        }
    }
}

/// Makes parameters between the minimum (0) and the maximum (1) that the fields allow.
fn use_at(descriptor: &Descriptor, weight: f64) {
    let numbers = |field: &htex_model::Field| {
        let one = (field.min * (1.0 - weight) + field.max * weight).clamp(field.min, field.max);
        let length = match field.kind {
            Kind::Scalar => 1,
            Kind::List { max_len } => max_len.min(LONGEST) as usize,
        };
        vec![one; length]
    };
    let all: Vec<Vec<f64>> = descriptor.fields.iter().map(numbers).collect();
    let slices: Vec<&[f64]> = all.iter().map(Vec::as_slice).collect();
    let flat = flatten(descriptor, &slices);
    let values = Values::read(descriptor, &flat).unwrap_or_else(|e| panic!("{e}: {flat:?}"));
    for (i, numbers) in slices.iter().enumerate() {
        assert_eq!(values.list(i), *numbers);
    }
    match round_parameters(&stored_fields(descriptor), &flat) {
        Ok(rounded) => finite("rounded", rounded),
        Err(error) => sentence(&error),
    }
}
