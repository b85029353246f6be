//! The parts of a TDMS object: its path, the layout of its values and its attributes.

use std::io::Read;

use crate::error::ReadProblem;
use crate::formats::bytes::{ByteReader, NumberType};

/// Longest text that is read, bytes.
const MOST_TEXT: u32 = 64 << 10;
pub(crate) const MOST_CHANNELS: usize = 65_536;

/// A channel's values in a chunk.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Layout {
    /// `None` for values that are not numbers, such as texts and times.
    pub(crate) kind: Option<NumberType>,
    pub(crate) values: u64,
    pub(crate) bytes: u64,
}

/// Reads the type and number of a channel's values in a chunk.
pub(crate) fn layout(reader: &mut ByteReader<impl Read>) -> Result<Layout, ReadProblem> {
    let (kind, dimension, values) = (reader.u32()?, reader.u32()?, reader.u64()?);
    if dimension != 1 {
        return Err(ReadProblem::invalid(
            "a channel has more than one dimension; the file is damaged, copy it again",
        ));
    }
    let number = number_type(kind);
    let size = match (number, kind) {
        (Some(number), _) => number.size() as u64,
        (None, 0x20) => {
            let bytes = reader.u64()?;
            return Ok(Layout { kind: None, values, bytes });
        }
        (None, 0) => 0,
        (None, 0x21) => 1,
        (None, 0x0008_000c) => 8,
        (None, 0x44 | 0x0010_000d) => 16,
        _ => {
            return Err(ReadProblem::invalid(
                "a channel has extended or fixed-point numbers; save it as DBL",
            ));
        }
    };
    let bytes = values.checked_mul(size).ok_or_else(|| {
        ReadProblem::invalid("a channel has too many values; the file is damaged, copy it again")
    })?;
    Ok(Layout { kind: number, values, bytes })
}

/// Skips the index of raw DAQmx data.
pub(crate) fn daqmx_index(reader: &mut ByteReader<impl Read>) -> Result<(), ReadProblem> {
    reader.skip(16)?;
    let scalers = reader.u32()?;
    reader.skip(20 * u64::from(scalers))?;
    let widths = reader.u32()?;
    Ok(reader.skip(4 * u64::from(widths))?)
}

/// Reads an attribute's value; `None` if it is not a number.
pub(crate) fn attribute(reader: &mut ByteReader<impl Read>) -> Result<Option<f64>, ReadProblem> {
    let kind = reader.u32()?;
    if let Some(number) = number_type(kind) {
        let mut value = f64::NAN;
        reader.values(number, 1, |_, read| value = read)?;
        return Ok(Some(value));
    }
    match kind {
        0 => {}
        0x20 => drop(text(reader)?),
        0x21 => reader.skip(1)?,
        // A complex number of two 32-bit floats.
        0x0008_000c => reader.skip(8)?,
        // A time, and a complex number of two 64-bit floats.
        0x44 | 0x0010_000d => reader.skip(16)?,
        other => {
            return Err(ReadProblem::Invalid(format!(
                "an attribute has the unknown type {other:#x}; export the file again"
            )));
        }
    }
    Ok(None)
}

fn number_type(kind: u32) -> Option<NumberType> {
    Some(match kind {
        1 => NumberType::I8,
        2 => NumberType::I16,
        3 => NumberType::I32,
        4 => NumberType::I64,
        5 => NumberType::U8,
        6 => NumberType::U16,
        7 => NumberType::U32,
        8 => NumberType::U64,
        9 | 0x19 => NumberType::F32,
        10 | 0x1a => NumberType::F64,
        _ => return None,
    })
}

pub(crate) fn text(reader: &mut ByteReader<impl Read>) -> Result<String, ReadProblem> {
    let length = reader.u32()?;
    if length > MOST_TEXT {
        return Err(ReadProblem::Invalid(format!(
            "a text of {length} bytes; the file is damaged, copy it again"
        )));
    }
    let bytes = reader.vec(length.into())?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

/// Returns the parts of a path such as `/'Group'/'Channel'`. In a name, a quote is written twice.
pub(crate) fn parts(path: &str) -> Option<Vec<String>> {
    let mut parts = Vec::new();
    let mut rest = path;
    while !rest.is_empty() && rest != "/" {
        let mut own = String::new();
        rest = rest.strip_prefix("/'")?;
        loop {
            let quote = rest.find('\'')?;
            own.push_str(&rest[..quote]);
            rest = &rest[quote + 1..];
            match rest.strip_prefix('\'') {
                Some(behind) => {
                    own.push('\'');
                    rest = behind;
                }
                None => break,
            }
        }
        parts.push(own);
    }
    Some(parts)
}
