//! Coded assets: the same texture in fewer bytes.
//!
//! A coded asset requires the extension [`CODED`]. It differs from a plain asset in three ways.
//! First, fields with values in 8-bit steps are coded: each condition is predicted from the
//! previous condition (`coded.rs`). Second, the manifest's arrays of conditions are stored as
//! tables (`table.rs`). Third, the measures of agreement with the recorded spectra are rounded to
//! two decimals. Parameters and levels do not change, so the samples do not change either.

use crate::manifest::{StoredAs, StoredField};
use crate::{Asset, CODED, Manifest, Steps};

impl Manifest {
    /// Returns whether the asset is coded. Only readers that support the extension [`CODED`] can
    /// use a coded asset.
    pub fn is_coded(&self) -> bool {
        self.extensions_required.iter().any(|name| name == CODED)
    }
}

impl Asset {
    /// Returns the asset in the coded form. Its parameters, and the samples that it plays, stay the
    /// same. Its file is usually much smaller if the asset has several conditions.
    #[must_use]
    pub fn coded(mut self) -> Self {
        if !self.manifest.is_coded() {
            self.manifest.extensions_required.push(CODED.to_owned());
        }
        for (i, representation) in self.manifest.representations.iter_mut().enumerate() {
            let flats = self.parameters.get(i).map_or(&[][..], Vec::as_slice);
            let whole = representation.fields.clone();
            for (i, field) in representation.fields.iter_mut().enumerate() {
                field.store = match field.store {
                    StoredAs::U8(steps) if !field.list => {
                        let values = flats.iter().filter_map(|flat| scalar(&whole, i, flat));
                        StoredAs::Coded(from_least(steps, &values.collect::<Vec<_>>()))
                    }
                    StoredAs::U8(steps) | StoredAs::Packed(steps) => StoredAs::Coded(steps),
                    other => other,
                };
            }
        }
        self
    }

    /// Returns the asset in the plain form, which readers of version 1.0 can read. Its parameters,
    /// and the samples that it plays, are the same.
    #[must_use]
    pub fn plain(mut self) -> Self {
        self.manifest.extensions_required.retain(|name| name != CODED);
        for representation in &mut self.manifest.representations {
            for field in &mut representation.fields {
                field.store = match field.store {
                    StoredAs::Coded(steps) if field.list => StoredAs::Packed(steps),
                    StoredAs::Coded(steps) => StoredAs::U8(steps),
                    other => other,
                };
            }
        }
        self
    }
}

/// Returns the value of the scalar field `index` in a flat array.
fn scalar(fields: &[StoredField], index: usize, flat: &[f64]) -> Option<f64> {
    let parts = crate::block::split(fields, flat).ok()?;
    parts.get(index)?.1.first().copied()
}

/// Returns steps with another offset, so that the smallest of these values is step 0. A code takes
/// fewest bits for 0. If this would change any value, returns the steps unchanged.
fn from_least(steps: Steps, values: &[f64]) -> Steps {
    let of = |steps: Steps, value: f64| {
        (0..=u16::from(u8::MAX)).find(|q| steps.value(*q).to_bits() == value.to_bits())
    };
    let Some(least) = values.iter().map(|value| of(steps, *value)).min().flatten() else {
        return steps;
    };
    let moved = Steps { offset: steps.offset + steps.scale * f64::from(least), ..steps };
    let same = values.iter().all(|value| of(moved, *value).is_some());
    if same && moved.are_valid(u8::MAX.into()) { moved } else { steps }
}
