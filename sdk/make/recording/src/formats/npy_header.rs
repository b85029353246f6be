//! The header of an NPY file: `{'descr': '<f8', 'fortran_order': False, 'shape': (1000, 3), }` for
//! numbers, or `{'descr': [('time_s', '<f8'), ('fx_n', '<f4')], …}` for records.

use std::borrow::Cow;

use crate::error::ReadProblem;
use crate::formats::bytes::{Endian, NumberType};

/// Longest header that is read, bytes; NumPy writes 118 bytes for plain arrays.
const MAX_HEADER: usize = 16 << 10;
/// Text that says what can be read instead of other records.
const PLAIN: &str = "save fields of the types f4, f8, i2 or i4, or a plain float array";

/// What an NPY header states.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Header {
    /// Number of bytes before the values.
    pub(crate) bytes: usize,
    /// For records, the types of the fields, in their order. For a plain array, the type of its
    /// values.
    pub(crate) types: Vec<(NumberType, Endian)>,
    /// Names of the fields of a record; `None` for a plain array.
    pub(crate) names: Option<Vec<String>>,
    /// Whether the values of a column are next to each other.
    pub(crate) is_planar: bool,
    pub(crate) shape: Vec<u64>,
}

impl Header {
    /// Parses the header from the first bytes of a file, which must contain all of it.
    pub(crate) fn parse(front: &[u8]) -> Result<Self, ReadProblem> {
        let (bytes, text) = text(front)?;
        let described = value(&text, "descr")?;
        // A field may have the same name as one of the other keys, so these keys are searched for
        // only after the fields.
        let (types, names, rest) = match described.strip_prefix('[') {
            Some(fields) => {
                let (fields, rest) = records(fields)?;
                let (names, types) = fields.into_iter().unzip();
                (types, Some(names), rest)
            }
            None => (vec![kind(described)?], None, &text[..]),
        };
        let is_planar = match value(rest, "fortran_order")? {
            order if order.starts_with("True") => true,
            order if order.starts_with("False") => false,
            _ => return Err(lacks("fortran_order of True or False")),
        };
        Ok(Self { bytes, types, names, is_planar, shape: shape(value(rest, "shape")?)? })
    }
}

/// Returns the number of bytes before the values, and the header's dictionary.
fn text(front: &[u8]) -> Result<(usize, Cow<'_, str>), ReadProblem> {
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
    // Latin-1 up to version 2.
    let text = if front.get(6).is_some_and(|version| *version < 3) && !header.is_ascii() {
        Cow::Owned(header.iter().copied().map(char::from).collect())
    } else {
        Cow::Borrowed(std::str::from_utf8(header).map_err(|_| lacks("text"))?)
    };
    Ok((start + length, text))
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

/// The name and the type of a field of a record.
type Field = (String, (NumberType, Endian));

/// Parses the fields of a record, after the `[` of their list. Returns them, and the text after
/// their list.
fn records(mut rest: &str) -> Result<(Vec<Field>, &str), ReadProblem> {
    let other = || ReadProblem::Invalid(format!("the array holds other records; {PLAIN}"));
    let mut fields = Vec::new();
    loop {
        rest = rest.trim_start_matches([' ', ',']);
        if let Some(rest) = rest.strip_prefix(']') {
            return if fields.is_empty() { Err(other()) } else { Ok((fields, rest)) };
        }
        let field = rest.strip_prefix('(').ok_or_else(other)?;
        let (name, field) = quoted(field).ok_or_else(other)?;
        let descr = field.trim_start_matches([' ', ',']);
        let (_, field) = quoted(descr).ok_or_else(other)?;
        // A third element would be the shape of an array in the field, and is refused.
        let field = field.trim_start_matches([' ', ',']).strip_prefix(')').ok_or_else(other)?;
        fields.push((name.to_owned(), kind(descr)?));
        rest = field;
    }
}

/// Splits a quoted text without escapes from what follows.
fn quoted(text: &str) -> Option<(&str, &str)> {
    let quote = text.chars().next().filter(|quote| matches!(quote, '\'' | '"'))?;
    let (inside, rest) = text[1..].split_once(quote)?;
    (!inside.contains('\\')).then_some((inside, rest))
}

fn kind(descr: &str) -> Result<(NumberType, Endian), ReadProblem> {
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
