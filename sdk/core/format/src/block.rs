//! Encoder and decoder of parameter blocks.
//!
//! For each condition, a block contains the stored values of each field that is not coded. Values
//! are in little-endian order and have a fixed width, except in packed lists. The length of a list
//! is a variable-length integer of bincode, which precedes the values of the list. After the values
//! of all conditions, the block contains the coded fields of all conditions, which are encoded
//! together (`coded.rs`). The layout depends only on the fields in the manifest. This is the only
//! module that uses bincode.

use bincode::config::{Configuration, standard};
use bincode::{Decode, Encode};

use htex_model::Descriptor;

use crate::coded::{self, CodeError, MOST_STEPS};
use crate::packed::{most_steps, pack, packed_bytes, unpack};
use crate::{Steps, StoredAs, StoredField, WriteError};

const CONFIGURATION: Configuration = standard();

/// Why a parameter block cannot be decoded.
#[derive(Debug, thiserror::Error)]
pub(crate) enum BlockError {
    #[error("the block ends inside field {field} of condition {condition}")]
    Truncated { field: String, condition: usize },
    #[error("the length of list {field} of condition {condition} is not in its shortest form")]
    Length { field: String, condition: usize },
    #[error(
        "the packed list {field} of condition {condition} is truncated or not in canonical form"
    )]
    Packed { field: String, condition: usize },
    #[error("the code of the coded fields is truncated or not in canonical form")]
    Coded,
    #[error("{0} bytes follow the last value")]
    Trailing(usize),
    #[error("{field}[{index}] of condition {condition} is not a finite number")]
    NotFinite { field: String, condition: usize, index: usize },
    #[error("there are more numbers than the limit of {0}")]
    TooMany(usize),
}

/// Encodes a representation's parameter block from one flat array per condition.
pub(crate) fn encode(
    fields: &[StoredField],
    conditions: &[Vec<f64>],
) -> Result<Vec<u8>, WriteError> {
    let mut out = Vec::new();
    let mut coded = Vec::new();
    for flat in conditions {
        let mut steps = Vec::new();
        for (field, values) in split(fields, flat)? {
            if let StoredAs::Coded(_) = field.store {
                steps.push(coded_steps(field, values)?);
                continue;
            }
            if field.list {
                put(&mut out, values.len() as u64)?;
            }
            if let StoredAs::Packed(_) = field.store {
                out.extend(pack(&steps_of(field, values)?));
                continue;
            }
            for (index, &value) in values.iter().enumerate() {
                put_number(&mut out, quantise(field, index, value)?)?;
            }
        }
        coded.push(steps);
    }
    out.extend(coded::encode(&coded_lists(fields), &coded));
    Ok(out)
}

/// Returns, for each coded field, whether it is a list.
fn coded_lists(fields: &[StoredField]) -> Vec<bool> {
    fields.iter().filter(|field| field.store.is_coded()).map(|field| field.list).collect()
}

fn coded_steps(field: &StoredField, values: &[f64]) -> Result<Vec<u8>, WriteError> {
    if values.len() > MOST_STEPS {
        let problem = format!(
            "list {} has {} values, and a coded list has at most {MOST_STEPS}",
            field.name,
            values.len()
        );
        return Err(WriteError::Layout { problem });
    }
    steps_of(field, values)
}

/// Decodes a block into flat arrays. `values` is the number of values that the reader may still
/// read. This function subtracts the number of values that it reads, even if an error follows them.
pub(crate) fn decode(
    fields: &[StoredField],
    conditions: usize,
    bytes: &[u8],
    values: &mut usize,
) -> Result<Vec<Vec<f64>>, BlockError> {
    let mut reader = Reader { bytes, limit: *values, left: *values };
    let flats = if coded_lists(fields).is_empty() {
        (0..conditions).map(|condition| reader.condition(fields, condition)).collect()
    } else {
        reader.with_coded_fields(fields, conditions)
    };
    *values = reader.left;
    match reader.bytes.len() {
        rest if rest > 0 && flats.is_ok() => Err(BlockError::Trailing(rest)),
        _ => flats,
    }
}

/// Returns the number of bytes that a parameter set (a flat array) takes in a parameter block with
/// only one condition. In a block with several conditions, coded fields take fewer bytes for each
/// later condition.
///
/// # Errors
/// Returns the errors of [`round_parameters`].
pub fn stored_bytes(fields: &[StoredField], flat: &[f64]) -> Result<usize, WriteError> {
    let mut bytes = 0;
    let mut coded = Vec::new();
    for (field, values) in split(fields, flat)? {
        if let StoredAs::Coded(_) = field.store {
            coded.push(coded_steps(field, values)?);
            continue;
        }
        if field.list {
            bytes += shortest(values.len() as u64);
        }
        bytes += match field.store {
            StoredAs::Packed(_) => packed_bytes(&steps_of(field, values)?),
            store => values.len() * store.bytes(),
        };
    }
    Ok(bytes + coded::encode(&coded_lists(fields), &[coded]).len())
}

/// Quantises the values of a packed or coded field into steps.
fn steps_of(field: &StoredField, values: &[f64]) -> Result<Vec<u8>, WriteError> {
    let step = |(index, &value): (usize, &f64)| match quantise(field, index, value)? {
        Number::U8(q) => Ok(q),
        // This case does not occur, because `quantise` returns a byte for such a field.
        _ => Ok(0),
    };
    values.iter().enumerate().map(step).collect()
}

/// Rounds a parameter set (a flat array) to the values that an asset stores. A reader gets exactly
/// these values.
///
/// `flat` contains the fields in order: the value of a scalar, or the length of a list followed by
/// its values.
///
/// # Errors
/// Returns [`WriteError::OutOfRange`] if a value is not finite or its field cannot store it.
/// Returns [`WriteError::Layout`] if `flat` does not match `fields`.
///
/// ```
/// use htex_format::{StoredField, Steps, StoredAs, round_parameters};
///
/// let steps = Steps { scale: 0.5, offset: 20.0, log: false };
/// let store = StoredAs::U8(steps);
/// let fields = [StoredField { name: "peak_hz".to_owned(), unit: "Hz".to_owned(), list: true, store }];
/// // A list of two values.
/// assert_eq!(round_parameters(&fields, &[2.0, 30.2, 40.9])?, [2.0, 30.0, 41.0]);
/// # Ok::<(), htex_format::WriteError>(())
/// ```
pub fn round_parameters(fields: &[StoredField], flat: &[f64]) -> Result<Vec<f64>, WriteError> {
    let mut rounded = Vec::with_capacity(flat.len());
    for (field, values) in split(fields, flat)? {
        if field.list {
            rounded.push(values.len() as f64);
        }
        for (index, &value) in values.iter().enumerate() {
            rounded.push(value_of(quantise(field, index, value)?, field.store));
        }
    }
    Ok(rounded)
}

/// Rounds a model's parameters as [`round_parameters`] does, but never rounds a value out of its
/// field's range.
///
/// If the nearest value that can be stored is outside the range, the function uses the nearest
/// storable value inside the range. For example, the 32-bit float nearest to a field's maximum of
/// 0.2 is 0.200000003, which the model refuses. The function returns 0.199999988 instead. Every
/// writer of a model's parameters rounds with this function.
///
/// # Errors
/// Returns the errors of [`round_parameters`], and [`WriteError::OutOfRange`] if the field cannot
/// store any value in its range.
pub fn round_within(
    fields: &[StoredField],
    model: &Descriptor,
    flat: &[f64],
) -> Result<Vec<f64>, WriteError> {
    let mut rounded = Vec::with_capacity(flat.len());
    for (field, values) in split(fields, flat)? {
        if field.list {
            rounded.push(values.len() as f64);
        }
        let own = model.fields.iter().find(|own| own.name == field.name);
        for (index, &value) in values.iter().enumerate() {
            let nearest = quantise(field, index, value)?;
            let stored = match own {
                Some(own) if own.min <= value && value <= own.max => {
                    let inside = inside(nearest, field.store, own.min, own.max);
                    inside.ok_or_else(|| WriteError::OutOfRange {
                        field: field.name.clone(),
                        index,
                        value,
                        low: value_of(nearest, field.store),
                        high: value_of(nearest, field.store),
                    })?
                }
                // A value outside its field's range stays outside. It is refused when it is read.
                _ => value_of(nearest, field.store),
            };
            rounded.push(stored);
        }
    }
    Ok(rounded)
}

/// Returns the value of `nearest` if it is in the range, otherwise the value of the next number
/// towards the range. Returns `None` if both are outside.
fn inside(nearest: Number, store: StoredAs, min: f64, max: f64) -> Option<f64> {
    let value = value_of(nearest, store);
    let next = match value {
        low if low < min => nearest.next(1),
        high if high > max => nearest.next(-1),
        _ => return Some(value),
    };
    let next = value_of(next?, store);
    (min <= next && next <= max).then_some(next)
}

/// Splits a flat array into one slice per field, without the list lengths.
pub(crate) fn split<'a>(
    fields: &'a [StoredField],
    flat: &'a [f64],
) -> Result<Vec<(&'a StoredField, &'a [f64])>, WriteError> {
    let layout = |problem: String| Err(WriteError::Layout { problem });
    let mut rest = flat;
    let mut parts = Vec::with_capacity(fields.len());
    for field in fields {
        let Some((&first, after)) = rest.split_first() else {
            return layout(format!("they end before field {}", field.name));
        };
        let (values, after) = if !field.list {
            rest.split_at(1)
        // NaN and infinity also fail these comparisons, so the cast below is exact.
        } else if first.fract() == 0.0 && first >= 0.0 && first <= after.len() as f64 {
            after.split_at(first as usize)
        } else {
            let left = after.len();
            return layout(format!(
                "list {} says its length is {first}, and {left} values follow",
                field.name
            ));
        };
        parts.push((field, values));
        rest = after;
    }
    if rest.is_empty() {
        return Ok(parts);
    }
    layout(format!("{} values follow the last field", rest.len()))
}

/// A number in its stored form.
#[derive(Clone, Copy)]
enum Number {
    F64(f64),
    F32(f32),
    U16(u16),
    U8(u8),
}

impl Number {
    /// Returns the next number above (`direction` 1) or below (`direction` -1), or `None` at the
    /// end of the range.
    fn next(self, direction: i8) -> Option<Self> {
        let up = direction > 0;
        Some(match self {
            Self::F64(x) => Self::F64(if up { x.next_up() } else { x.next_down() }),
            Self::F32(x) => Self::F32(if up { x.next_up() } else { x.next_down() }),
            Self::U16(q) => Self::U16(q.checked_add_signed(direction.into())?),
            Self::U8(q) => Self::U8(q.checked_add_signed(direction)?),
        })
    }
}

fn quantise(field: &StoredField, index: usize, value: f64) -> Result<Number, WriteError> {
    let (number, low, high) = match field.store {
        StoredAs::F64 => (Some(Number::F64(value)), f64::MIN, f64::MAX),
        StoredAs::F32 => {
            let inside = (value as f32).is_finite().then_some(Number::F32(value as f32));
            (inside, f64::from(f32::MIN), f64::from(f32::MAX))
        }
        StoredAs::U16(steps) => {
            let q = step(steps, value, f64::from(u16::MAX)).map(|q| Number::U16(q as u16));
            (q, steps.value(0), steps.value(u16::MAX))
        }
        StoredAs::U8(steps) | StoredAs::Packed(steps) | StoredAs::Coded(steps) => {
            let q = step(steps, value, f64::from(u8::MAX)).map(|q| Number::U8(q as u8));
            (q, steps.value(0), steps.value(u8::MAX.into()))
        }
    };
    match number {
        // The value of the step is also tested. The check of the manifest may not have been passed,
        // and the exponential of a large step is infinite.
        Some(number) if value.is_finite() && value_of(number, field.store).is_finite() => {
            Ok(number)
        }
        _ => Err(WriteError::OutOfRange { field: field.name.clone(), index, value, low, high }),
    }
}

/// Returns the nearest step; halves are rounded away from zero. Returns `None` if the step is below
/// 0 or above `last`.
fn step(steps: Steps, value: f64, last: f64) -> Option<f64> {
    let x = if steps.log { libm::log(value) } else { value };
    // The logarithm of `libm` is used, because the last digit of the standard library's logarithm
    // differs between systems. With it, a value near the middle between two steps would be stored
    // as another step on some systems.
    let q = libm::round((x - steps.offset) / steps.scale);
    (0.0..=last).contains(&q).then_some(q)
}

impl Steps {
    /// Returns the value of step `q`.
    pub(crate) fn value(&self, q: u16) -> f64 {
        let x = self.offset + self.scale * f64::from(q);
        if self.log { libm::exp(x) } else { x }
    }
}

fn value_of(number: Number, store: StoredAs) -> f64 {
    match (number, store) {
        (Number::F64(x), _) => x,
        (Number::F32(x), _) => f64::from(x),
        (Number::U16(q), StoredAs::U16(steps)) => steps.value(q),
        (Number::U8(q), StoredAs::U8(steps) | StoredAs::Packed(steps) | StoredAs::Coded(steps)) => {
            steps.value(q.into())
        }
        (Number::U16(q), _) => f64::from(q),
        (Number::U8(q), _) => f64::from(q),
    }
}

/// Writes a number. Integers are written as raw bytes, because bincode needs three bytes for a
/// `u16` above 250.
fn put_number(out: &mut Vec<u8>, number: Number) -> Result<(), WriteError> {
    match number {
        Number::F64(x) => put(out, x),
        Number::F32(x) => put(out, x),
        Number::U16(q) => put(out, q.to_le_bytes()),
        Number::U8(q) => put(out, q),
    }
}

fn put(out: &mut Vec<u8>, value: impl Encode) -> Result<(), WriteError> {
    match bincode::encode_into_std_write(value, out, CONFIGURATION) {
        Ok(_) => Ok(()),
        Err(error) => Err(WriteError::Archive { problem: error.to_string() }),
    }
}

/// Appends the values of packed or coded steps. If the manifest has an error, such as steps that
/// are too large, a value may not be finite.
fn put_steps(
    all: &[u8],
    steps: Steps,
    field: &StoredField,
    condition: usize,
    flat: &mut Vec<f64>,
) -> Result<(), BlockError> {
    for (index, &q) in all.iter().enumerate() {
        let value = steps.value(q.into());
        if !value.is_finite() {
            return Err(BlockError::NotFinite { field: field.name.clone(), condition, index });
        }
        flat.push(value);
    }
    Ok(())
}

struct Reader<'a> {
    bytes: &'a [u8],
    limit: usize,
    left: usize,
}

impl Reader<'_> {
    fn condition(
        &mut self,
        fields: &[StoredField],
        condition: usize,
    ) -> Result<Vec<f64>, BlockError> {
        let mut flat = Vec::new();
        for field in fields {
            self.field(field, condition, &mut flat)?;
        }
        Ok(flat)
    }

    /// Reads the conditions of a block that has coded fields.
    fn with_coded_fields(
        &mut self,
        fields: &[StoredField],
        conditions: usize,
    ) -> Result<Vec<Vec<f64>>, BlockError> {
        // Contains, for each condition, the values of each field. For a list, the length comes
        // first.
        let mut all = Vec::new();
        for condition in 0..conditions {
            let mut parts = vec![Vec::new(); fields.len()];
            for (field, part) in fields.iter().zip(&mut parts) {
                if !field.store.is_coded() {
                    self.field(field, condition, part)?;
                }
            }
            all.push(parts);
        }
        let bytes = std::mem::take(&mut self.bytes);
        let coded = coded::decode(&coded_lists(fields), conditions, bytes, &mut self.left);
        let coded = coded.map_err(|error| match error {
            CodeError::Invalid => BlockError::Coded,
            CodeError::TooMany => BlockError::TooMany(self.limit),
        })?;
        for (condition, (parts, steps_of_fields)) in all.iter_mut().zip(coded).enumerate() {
            let mut steps_of_fields = steps_of_fields.into_iter();
            for (field, part) in fields.iter().zip(parts) {
                let StoredAs::Coded(steps) = field.store else {
                    continue;
                };
                let own = steps_of_fields.next().unwrap_or_default();
                if field.list {
                    part.push(own.len() as f64);
                }
                put_steps(&own, steps, field, condition, part)?;
            }
        }
        Ok(all.into_iter().map(|parts| parts.concat()).collect())
    }

    /// Reads a field that is not coded.
    fn field(
        &mut self,
        field: &StoredField,
        condition: usize,
        flat: &mut Vec<f64>,
    ) -> Result<(), BlockError> {
        let count = if field.list { self.length(field, condition)? } else { 1 };
        if field.list {
            flat.push(count as f64);
        }
        // The values are counted before anything is read, because a packed step may take only one
        // bit in the file, but takes eight bytes in memory.
        self.left = self.left.checked_sub(count).ok_or(BlockError::TooMany(self.limit))?;
        if let StoredAs::Packed(steps) = field.store {
            let all = self.steps(field, condition, count)?;
            return put_steps(&all, steps, field, condition, flat);
        }
        for index in 0..count {
            let value = self.number(field.store).ok_or_else(|| truncated(field, condition))?;
            if !value.is_finite() {
                return Err(BlockError::NotFinite { field: field.name.clone(), condition, index });
            }
            flat.push(value);
        }
        Ok(())
    }

    /// Reads the steps of a packed list.
    fn steps(
        &mut self,
        field: &StoredField,
        condition: usize,
        count: usize,
    ) -> Result<Vec<u8>, BlockError> {
        let (steps, used) = unpack(self.bytes, count)
            .ok_or_else(|| BlockError::Packed { field: field.name.clone(), condition })?;
        self.bytes = &self.bytes[used..];
        Ok(steps)
    }

    /// Reads a list's length. Refuses a length if the remaining bytes are too few for it.
    fn length(&mut self, field: &StoredField, condition: usize) -> Result<usize, BlockError> {
        let before = self.bytes.len();
        let length = self.decode::<u64>().ok_or_else(|| truncated(field, condition))?;
        // If a shorter code for the same length exists, the code is refused, so that each block has
        // only one encoding.
        if before - self.bytes.len() != shortest(length) {
            return Err(BlockError::Length { field: field.name.clone(), condition });
        }
        // The file may state any length, so it is limited before values are read.
        let most = match field.store {
            StoredAs::Packed(_) => most_steps(self.bytes.len()),
            store => self.bytes.len() / store.bytes(),
        };
        match usize::try_from(length) {
            Ok(length) if length <= most => Ok(length),
            _ => Err(truncated(field, condition)),
        }
    }

    fn number(&mut self, store: StoredAs) -> Option<f64> {
        let number = match store {
            StoredAs::F64 => Number::F64(self.decode()?),
            StoredAs::F32 => Number::F32(self.decode()?),
            StoredAs::U16(_) => Number::U16(u16::from_le_bytes(self.decode()?)),
            StoredAs::U8(_) | StoredAs::Packed(_) | StoredAs::Coded(_) => {
                Number::U8(self.decode()?)
            }
        };
        Some(value_of(number, store))
    }

    fn decode<T: Decode<()>>(&mut self) -> Option<T> {
        let (value, used) = bincode::decode_from_slice(self.bytes, CONFIGURATION).ok()?;
        self.bytes = self.bytes.get(used..)?;
        Some(value)
    }
}

impl StoredAs {
    /// Returns the size of a stored number in bytes. For packed and coded fields this is the size
    /// of a step, because their numbers have no fixed size.
    fn bytes(self) -> usize {
        match self {
            Self::F64 => 8,
            Self::F32 => 4,
            Self::U16(_) => 2,
            Self::U8(_) | Self::Packed(_) | Self::Coded(_) => 1,
        }
    }
}

/// Returns the length in bytes of bincode's shortest variable-length integer for this number.
fn shortest(length: u64) -> usize {
    match length {
        0..=250 => 1,
        251..=0xFFFF => 3,
        0x1_0000..=0xFFFF_FFFF => 5,
        _ => 9,
    }
}

fn truncated(field: &StoredField, condition: usize) -> BlockError {
    BlockError::Truncated { field: field.name.clone(), condition }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn each_value_of_steps_that_work_leads_back_to_its_step(
            offset in prop_oneof![-800.0..800.0f64, 700.0..800.0f64, (-1020.0..1020.0f64).prop_map(libm::exp2)],
            finer in -56.0..4.0f64, log: bool, negative: bool, q: u16,
        ) {
            let offset = if negative { -offset } else { offset };
            let scale = offset.abs().max(f64::MIN_POSITIVE) * libm::exp2(finer);
            let steps = Steps { scale, offset, log };
            for last in [u16::from(u8::MAX), u16::MAX].into_iter().filter(|last| steps.are_valid(*last)) {
                for q in [0, q.min(last), last] {
                    prop_assert_eq!(step(steps, steps.value(q), f64::from(last)), Some(f64::from(q)));
                }
            }
        }
    }
}
