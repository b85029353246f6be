//! The header of an NPY file: `{'descr': '<f8', 'fortran_order': False, 'shape': (1000, 3), }`.

use crate::error::ReadProblem;
use crate::formats::bytes::{Endian, NumberType};

/// Longest header that is read, bytes; NumPy writes 118 bytes for such arrays.
const MAX_HEADER: usize = 4096;

/// What an NPY header states.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Header {
    /// Number of bytes before the values.
    pub(crate) bytes: usize,
    pub(crate) kind: NumberType,
    pub(crate) endian: Endian,
    /// Whether the values of a column are next to each other.
    pub(crate) is_planar: bool,
    pub(crate) shape: Vec<u64>,
}

impl Header {
    /// Parses the header from the first bytes of a file, which must contain all of it.
    pub(crate) fn parse(front: &[u8]) -> Result<Self, ReadProblem> {
        let (start, text) = text(front)?;
        let (kind, endian) = kind(value(text, "descr")?)?;
        let is_planar = match value(text, "fortran_order")? {
            order if order.starts_with("True") => true,
            order if order.starts_with("False") => false,
            _ => return Err(lacks("fortran_order of True or False")),
        };
        Ok(Self {
            bytes: start + text.len(),
            kind,
            endian,
            is_planar,
            shape: shape(value(text, "shape")?)?,
        })
    }
}

/// Returns the header's dictionary, and the byte at which the dictionary begins.
fn text(front: &[u8]) -> Result<(usize, &str), ReadProblem> {
    let (start, length) = match front {
        [_, _, _, _, _, _, 1, _, a, b, ..] => (10, usize::from(u16::from_le_bytes([*a, *b]))),
        [_, _, _, _, _, _, 2 | 3, _, a, b, c, d, ..] => {
            (12, u32::from_le_bytes([*a, *b, *c, *d]) as usize)
        }
        _ => {
            return Err(ReadProblem::invalid(
                "the file ends in its header or is of an unknown NPY version; copy it again",
            ));
        }
    };
    if length > MAX_HEADER {
        return Err(ReadProblem::Invalid(format!(
            "the header has {length} bytes, more than the limit of {MAX_HEADER}"
        )));
    }
    let header = front.get(start..start + length).ok_or_else(|| {
        let end = front.len();
        ReadProblem::Invalid(format!(
            "the file ends at byte {end}, inside its header; copy it again"
        ))
    })?;
    let text = std::str::from_utf8(header).map_err(|_| lacks("text"))?;
    Ok((start, text))
}

/// Returns the dictionary's text from a key's value to the end.
fn value<'a>(dictionary: &'a str, key: &'static str) -> Result<&'a str, ReadProblem> {
    let quoted = |quote| dictionary.split_once(&format!("{quote}{key}{quote}"));
    let after = quoted('\'').or_else(|| quoted('"'));
    let value = after.and_then(|(_, after)| after.trim_start().strip_prefix(':'));
    value.map(str::trim_start).ok_or_else(|| lacks(key))
}

/// Returns the problem of a header that has no entry `what`.
fn lacks(what: &str) -> ReadProblem {
    ReadProblem::Invalid(format!("not an NPY file that can be read: its header has no {what}"))
}

fn kind(descr: &str) -> Result<(NumberType, Endian), ReadProblem> {
    if descr.starts_with('[') {
        return Err(ReadProblem::invalid("the array holds records; save a plain float array"));
    }
    let mut parts = descr.split(['\'', '"']);
    let (Some(""), Some(name)) = (parts.next(), parts.next()) else {
        return Err(lacks("type of numbers"));
    };
    let unread = || {
        let name = htex_base::finding::plain(name);
        ReadProblem::Invalid(format!(
            "the array's type is {name}; expected f4, f8, i2 or i4 (in NumPy: array.astype('f8'))"
        ))
    };
    let endian = match name.as_bytes().first() {
        Some(b'<') => Endian::Little,
        Some(b'>') => Endian::Big,
        _ => return Err(unread()),
    };
    let kind = match &name[1..] {
        "f4" => NumberType::F32,
        "f8" => NumberType::F64,
        "i2" => NumberType::I16,
        "i4" => NumberType::I32,
        _ => return Err(unread()),
    };
    Ok((kind, endian))
}

/// Parses a shape such as `(1000, 3)`: at most two sizes, whose product cannot overflow.
fn shape(text: &str) -> Result<Vec<u64>, ReadProblem> {
    let not_plain = || {
        ReadProblem::invalid(
            "the header does not describe a plain array of at most two dimensions; save a (n,) or (n, channels) array",
        )
    };
    let inside = text
        .strip_prefix(['(', '['])
        .and_then(|text| Some(text.split_once([')', ']'])?.0))
        .ok_or_else(not_plain)?;
    if inside.bytes().filter(u8::is_ascii_digit).count() > 18 {
        return Err(not_plain());
    }
    let sizes = inside.split(',').map(str::trim).filter(|size| !size.is_empty()).map(str::parse);
    sizes.collect::<Result<_, _>>().map_err(|_| not_plain())
}
