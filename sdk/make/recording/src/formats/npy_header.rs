//! The header of an NPY file: `{'descr': '<f8', 'fortran_order': False, 'shape': (1000, 3), }`.

use crate::formats::bytes::{Endian, NumberType};

/// Longest header that is read, bytes; NumPy writes 118 bytes for such arrays.
const MAX_HEADER: usize = 4096;

/// What is wrong with an array, and what to do.
#[derive(Debug, thiserror::Error)]
pub(crate) enum NpyError {
    #[error("the file ends in its header or is of an unknown NPY version; copy it again")]
    Start,
    #[error("the header has {0} bytes, more than the limit of {MAX_HEADER}")]
    LongHeader(usize),
    #[error("the file ends at byte {0}, inside its header; copy it again")]
    EndInHeader(usize),
    #[error(
        "the header does not describe a plain array of at most two dimensions; save a (n,) or (n, channels) array"
    )]
    NotPlain,
    #[error("not an NPY file that can be read: its header has no {0}")]
    Header(&'static str),
    #[error("the array's shape is {0:?}; expected (n,) or (n, channels), one row per sample")]
    Shape(Vec<u64>),
    #[error("the array holds records; save a plain float array")]
    Records,
    #[error("the array's type is {0}; expected f4, f8, i2 or i4 (in NumPy: array.astype('f8'))")]
    Type(String),
    #[error("the file ends after {read} of {items} values; copy it again")]
    End { read: u64, items: u64 },
    #[error(transparent)]
    Values(#[from] std::io::Error),
}

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
    pub(crate) fn parse(front: &[u8]) -> Result<Self, NpyError> {
        let (start, text) = text(front)?;
        let (kind, endian) = kind(value(text, "descr")?)?;
        let is_planar = match value(text, "fortran_order")? {
            order if order.starts_with("True") => true,
            order if order.starts_with("False") => false,
            _ => return Err(NpyError::Header("fortran_order of True or False")),
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
fn text(front: &[u8]) -> Result<(usize, &str), NpyError> {
    let (start, length) = match front {
        [_, _, _, _, _, _, 1, _, a, b, ..] => (10, usize::from(u16::from_le_bytes([*a, *b]))),
        [_, _, _, _, _, _, 2 | 3, _, a, b, c, d, ..] => {
            (12, u32::from_le_bytes([*a, *b, *c, *d]) as usize)
        }
        _ => return Err(NpyError::Start),
    };
    if length > MAX_HEADER {
        return Err(NpyError::LongHeader(length));
    }
    let header = front.get(start..start + length).ok_or(NpyError::EndInHeader(front.len()))?;
    let text = std::str::from_utf8(header).map_err(|_| NpyError::Header("text"))?;
    Ok((start, text))
}

/// Returns the dictionary's text from a key's value to the end.
fn value<'a>(dictionary: &'a str, key: &'static str) -> Result<&'a str, NpyError> {
    let quoted = |quote| dictionary.split_once(&format!("{quote}{key}{quote}"));
    let after = quoted('\'').or_else(|| quoted('"'));
    let value = after.and_then(|(_, after)| after.trim_start().strip_prefix(':'));
    value.map(str::trim_start).ok_or(NpyError::Header(key))
}

fn kind(descr: &str) -> Result<(NumberType, Endian), NpyError> {
    if descr.starts_with('[') {
        return Err(NpyError::Records);
    }
    let mut parts = descr.split(['\'', '"']);
    let (Some(""), Some(name)) = (parts.next(), parts.next()) else {
        return Err(NpyError::Header("type of numbers"));
    };
    let endian = match name.as_bytes().first() {
        Some(b'<') => Endian::Little,
        Some(b'>') => Endian::Big,
        _ => return Err(NpyError::Type(htex_base::finding::plain(name).into_owned())),
    };
    let kind = match &name[1..] {
        "f4" => NumberType::F32,
        "f8" => NumberType::F64,
        "i2" => NumberType::I16,
        "i4" => NumberType::I32,
        _ => return Err(NpyError::Type(htex_base::finding::plain(name).into_owned())),
    };
    Ok((kind, endian))
}

/// Parses a shape such as `(1000, 3)`: at most two sizes, whose product cannot overflow.
fn shape(text: &str) -> Result<Vec<u64>, NpyError> {
    let inside = text
        .strip_prefix(['(', '['])
        .and_then(|text| Some(text.split_once([')', ']'])?.0))
        .ok_or(NpyError::NotPlain)?;
    if inside.bytes().filter(u8::is_ascii_digit).count() > 18 {
        return Err(NpyError::NotPlain);
    }
    let sizes = inside.split(',').map(str::trim).filter(|size| !size.is_empty()).map(str::parse);
    sizes.collect::<Result<_, _>>().map_err(|_| NpyError::NotPlain)
}
