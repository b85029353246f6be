//! The flat array of parameters, read by field.

use alloc::format;
use alloc::vec::Vec;

use crate::abi::{MAX_FIELDS, MAX_LIST_LEN};
use crate::{Descriptor, Error, Field, Kind};

/// Parameters, checked against a descriptor, without a copy.
///
/// ```
/// use htex_model::{Descriptor, Values};
/// let d = Descriptor::new("org.example.x", "X", "1.0.0", "An example.")
///     .list("amplitude", "1", (0.0, 1.0), 4, "Amplitudes.")
///     .scalar("peak_hz", "Hz", (20.0, 1000.0), "Peak.");
/// let (values, used) = Values::read_first(&d, &[2.0, 0.5, 0.25, 80.0])?;
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
    /// No parameters: a place for some.
    #[cfg(feature = "std")]
    pub(crate) const NONE: Self = Self {
        flat: &[],
        spans: [(0, 0); MAX_FIELDS],
    };

    /// Reads an array that holds just one set of parameters.
    ///
    /// # Errors
    /// Names the field that is missing, too long, out of range or not finite.
    pub fn read(descriptor: &Descriptor, flat: &'a [f64]) -> Result<Self, Error> {
        let (values, used) = Self::read_first(descriptor, flat)?;
        if used == flat.len() {
            return Ok(values);
        }
        let extra = flat.len() - used;
        Err(Error::parameters(format!(
            "{} numbers stand behind the last parameter field of {}",
            extra, descriptor.id
        )))
    }

    /// Reads the set of parameters at the start of an array; says how many numbers it took.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn read_first(descriptor: &Descriptor, flat: &'a [f64]) -> Result<(Self, usize), Error> {
        if descriptor.fields.len() > MAX_FIELDS {
            return Err(Error::parameters(format!(
                "{} has more than {MAX_FIELDS} parameter fields",
                descriptor.id
            )));
        }
        let mut spans = [(0, 0); MAX_FIELDS];
        let mut at = 0;
        for (field, span) in descriptor.fields.iter().zip(&mut spans) {
            let len = match field.kind {
                Kind::Scalar => 1,
                Kind::List { max_len } => {
                    let len = list_length(field, flat.get(at).copied(), max_len)?;
                    at += 1;
                    len
                }
            };
            let Some(numbers) = flat.get(at..at + len) else {
                return Err(Error::parameters(format!(
                    "parameter `{}` wants {len} numbers and {} are left",
                    field.name,
                    flat.len().saturating_sub(at)
                )));
            };
            check_range(field, numbers)?;
            *span = (at as u32, (at + len) as u32);
            at += len;
        }
        let flat = &flat[..at];
        Ok((Self { flat, spans }, at))
    }

    /// The numbers of field `i` (one for a scalar); empty if there is no such field.
    pub fn list(&self, i: usize) -> &'a [f64] {
        let (start, end) = self.spans.get(i).copied().unwrap_or_default();
        &self.flat[start as usize..end as usize]
    }

    /// The number of scalar field `i`; NaN if there is no such field.
    pub fn scalar(&self, i: usize) -> f64 {
        self.list(i).first().copied().unwrap_or(f64::NAN)
    }

    /// The array itself.
    pub fn flat(&self) -> &'a [f64] {
        self.flat
    }
}

/// Writes fields' numbers as one flat array (the other way round from [`Values`]).
pub fn flatten(descriptor: &Descriptor, fields: &[&[f64]]) -> Vec<f64> {
    let mut flat = Vec::new();
    for (field, numbers) in descriptor.fields.iter().zip(fields) {
        if let Kind::List { .. } = field.kind {
            flat.push(numbers.len() as f64);
        }
        flat.extend_from_slice(numbers);
    }
    flat
}

fn list_length(field: &Field, value: Option<f64>, max_len: u32) -> Result<usize, Error> {
    let max = f64::from(max_len.min(MAX_LIST_LEN));
    match value {
        Some(n) if (0.0..=max).contains(&n) && whole_part(n) == n => Ok(n as usize),
        Some(n) => Err(Error::parameters(format!(
            "parameter `{}` says its length is {n}; a whole number from 0 to {max} is allowed",
            field.name
        ))),
        None => Err(Error::parameters(format!(
            "parameter `{}` is missing",
            field.name
        ))),
    }
}

fn whole_part(x: f64) -> f64 {
    x as u64 as f64
}

fn check_range(field: &Field, numbers: &[f64]) -> Result<(), Error> {
    match numbers
        .iter()
        .position(|x| !(field.min..=field.max).contains(x))
    {
        None => Ok(()),
        Some(i) => Err(Error::parameters(format!(
            "parameter `{}`[{i}] is {}; {} to {} {} is allowed",
            field.name, numbers[i], field.min, field.max, field.unit
        ))),
    }
}
