//! Conversion of a model's parameter fields to the fields that an asset stores.

use htex_format::{Steps, StoredAs, StoredField, stored_unit};
use htex_host::{Descriptor, Kind};

/// Returns the asset's fields for a model.
pub fn stored_fields(descriptor: &Descriptor) -> Vec<StoredField> {
    let field = |f: &htex_host::Field| StoredField {
        name: f.name.clone(),
        unit: stored_unit(&f.unit).to_owned(),
        list: matches!(f.kind, Kind::List { .. }),
        store: store(f.store),
    };
    descriptor.fields.iter().map(field).collect()
}

fn store(store: htex_host::Store) -> StoredAs {
    let steps = |scale, offset, log| Steps { scale, offset, log };
    match store {
        htex_host::Store::F64 => StoredAs::F64,
        htex_host::Store::F32 => StoredAs::F32,
        htex_host::Store::U16 { scale, offset, log } => StoredAs::U16(steps(scale, offset, log)),
        htex_host::Store::U8 { scale, offset, log } => StoredAs::U8(steps(scale, offset, log)),
        htex_host::Store::Packed { scale, offset, log } => {
            StoredAs::Packed(steps(scale, offset, log))
        }
    }
}
