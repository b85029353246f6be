//! The flat array of parameters, and access to its fields.
//!
//! A scalar field is one number; a list is its length followed by its numbers. A reader that knows
//! the descriptor can therefore tell where a parameter set ends, so several sets can be
//! concatenated without separate lengths.

use alloc::vec::Vec;

use crate::abi::{MAX_FIELDS, MAX_LIST_LEN};
use crate::text;
use crate::{Error, Kind, StaticDescriptor};

/// Names and ranges of a model's parameters and fit options. Two types implement this trait:
/// [`StaticDescriptor`], which a model declares, and `Descriptor`, which a host reads.
pub trait Fields {
    /// Reverse-DNS id of the model.
    fn id(&self) -> &str;

    /// The number of fields.
    fn count(&self) -> usize;

    /// The range of field `i`. `i` must be below [`Self::count`].
    fn range(&self, i: usize) -> Range<'_>;

    /// The number of fit options.
    fn option_count(&self) -> usize;

    /// The range of option `i`, and whether the option allows only whole numbers. `i` must be below
    /// [`Self::option_count`].
    fn option(&self, i: usize) -> (Range<'_>, bool);
}

/// Name, unit and limits of a field or an option.
#[derive(Debug, Clone, Copy)]
pub struct Range<'a> {
    /// Name, including the unit, e.g. `peak_hz`.
    pub name: &'a str,
    /// Unit symbol; `1` for a pure number.
    pub unit: &'a str,
    /// Whether the field is one number or a list of numbers. An option is always one number.
    pub kind: Kind,
    /// Smallest value allowed.
    pub min: f64,
    /// Largest value allowed.
    pub max: f64,
}

macro_rules! fields_of {
    ($descriptor:ty) => {
        impl Fields for $descriptor {
            fn id(&self) -> &str {
                &self.id
            }

            fn count(&self) -> usize {
                self.fields.len()
            }

            fn range(&self, i: usize) -> Range<'_> {
                let field = &self.fields[i];
                Range {
                    name: &field.name,
                    unit: &field.unit,
                    kind: field.kind,
                    min: field.min,
                    max: field.max,
                }
            }

            fn option_count(&self) -> usize {
                self.options.len()
            }

            fn option(&self, i: usize) -> (Range<'_>, bool) {
                let option = &self.options[i];
                let range = Range {
                    name: &option.name,
                    unit: &option.unit,
                    kind: Kind::Scalar,
                    min: option.min,
                    max: option.max,
                };
                (range, option.integer)
            }
        }
    };
}

fields_of!(StaticDescriptor);
#[cfg(feature = "host")]
fields_of!(crate::Descriptor);

/// A parameter set that was checked against a descriptor. This type borrows the set's flat array.
///
/// ```
/// use htex_model::{StaticDescriptor, StaticField, Values};
/// const D: StaticDescriptor = StaticDescriptor::new("org.example.x", "X", "1.0.0", "An example.")
///     .fields(&[
///         StaticField::list("amplitude", "1", (0.0, 1.0), 4, "Amplitudes."),
///         StaticField::scalar("peak_hz", "Hz", (20.0, 1000.0), "Peak."),
///     ]);
/// let (values, used) = Values::read_first(&D, &[2.0, 0.5, 0.25, 80.0])?;
/// assert_eq!((values.list(0), values.scalar(1), used), (&[0.5, 0.25][..], 80.0, 4));
/// # Ok::<(), htex_model::Error>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Values<'a> {
    flat: &'a [f64],
    /// Start and end of each field's numbers in `flat`.
    spans: [(u32, u32); MAX_FIELDS],
}

impl<'a> Values<'a> {
    /// An empty set, as an initial value to be replaced.
    #[cfg(any(feature = "std", target_family = "wasm"))]
    pub(crate) const NONE: Self = Self { flat: &[], spans: [(0, 0); MAX_FIELDS] };

    /// Reads an array that contains exactly one parameter set.
    ///
    /// # Errors
    /// Returns an error if a field is missing, too long, out of range or not finite, or if numbers
    /// follow the last field. The error message names the field, or states how many numbers follow
    /// the last field.
    pub fn read(descriptor: &dyn Fields, flat: &'a [f64]) -> Result<Self, Error> {
        let (values, used) = Self::read_first(descriptor, flat)?;
        if used == flat.len() {
            return Ok(values);
        }
        let extra = flat.len() - used;
        Err(Error::parameters(text![
            extra,
            " numbers follow the last parameter field of ",
            descriptor.id(),
        ]))
    }

    /// Reads the parameter set at the start of an array, and returns it with its length.
    ///
    /// # Errors
    /// Returns an error if a field is missing, too long, out of range or not finite.
    pub fn read_first(descriptor: &dyn Fields, flat: &'a [f64]) -> Result<(Self, usize), Error> {
        if descriptor.count() > MAX_FIELDS {
            return Err(Error::parameters(text![
                descriptor.id(),
                " has more than ",
                MAX_FIELDS,
                " parameter fields",
            ]));
        }
        let mut spans = [(0, 0); MAX_FIELDS];
        let mut at = 0;
        for (i, span) in spans.iter_mut().enumerate().take(descriptor.count()) {
            let field = &descriptor.range(i);
            let len = match field.kind {
                Kind::Scalar => 1,
                Kind::List { max_len } => {
                    let len = list_length(field, flat.get(at).copied(), max_len)?;
                    at += 1;
                    len
                }
            };
            let Some(numbers) = flat.get(at..at + len) else {
                return Err(Error::parameters(text![
                    "parameter `",
                    field.name,
                    "` needs ",
                    len,
                    " numbers; ",
                    flat.len().saturating_sub(at),
                    " are left",
                ]));
            };
            check_range(field, numbers)?;
            *span = (at as u32, (at + len) as u32);
            at += len;
        }
        let flat = &flat[..at];
        Ok((Self { flat, spans }, at))
    }

    /// Returns the numbers of field `i`. A scalar field has one number. Returns an empty slice if
    /// there is no field `i`.
    pub fn list(&self, i: usize) -> &'a [f64] {
        let (start, end) = self.spans.get(i).copied().unwrap_or_default();
        &self.flat[start as usize..end as usize]
    }

    /// Returns the number of the scalar field `i`, or NaN if there is no field `i`.
    pub fn scalar(&self, i: usize) -> f64 {
        self.list(i).first().copied().unwrap_or(f64::NAN)
    }

    /// Returns the flat array, as the ABI passes it.
    pub fn flat(&self) -> &'a [f64] {
        self.flat
    }
}

/// Concatenates the numbers of the fields to one flat array: the inverse of [`Values`].
pub fn flatten(descriptor: &impl Fields, fields: &[&[f64]]) -> Vec<f64> {
    let mut flat = Vec::new();
    for (i, numbers) in fields.iter().enumerate().take(descriptor.count()) {
        if let Kind::List { .. } = descriptor.range(i).kind {
            flat.push(numbers.len() as f64);
        }
        flat.extend_from_slice(numbers);
    }
    flat
}

fn list_length(field: &Range<'_>, value: Option<f64>, max_len: u32) -> Result<usize, Error> {
    let max = f64::from(max_len.min(MAX_LIST_LEN));
    match value {
        Some(n) if (0.0..=max).contains(&n) && whole_part(n) == n => Ok(n as usize),
        Some(n) => Err(Error::parameters(text![
            "parameter `",
            field.name,
            "` has the length ",
            n,
            "; a whole number from 0 to ",
            max,
            " is allowed",
        ])),
        None => Err(Error::parameters(text!["parameter `", field.name, "` is missing",])),
    }
}

fn whole_part(x: f64) -> f64 {
    // Without `std`, `trunc` does not exist.
    x as u64 as f64
}

fn check_range(field: &Range<'_>, numbers: &[f64]) -> Result<(), Error> {
    // NaN lies in no range, so it is also refused.
    match numbers.iter().position(|x| !(field.min..=field.max).contains(x)) {
        None => Ok(()),
        Some(i) => Err(Error::parameters(text![
            "parameter `",
            field.name,
            "`[",
            i,
            "] is ",
            numbers[i],
            "; ",
            field.min,
            " to ",
            field.max,
            " ",
            field.unit,
            " is allowed",
        ])),
    }
}
