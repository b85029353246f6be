//! The elements of a MATLAB version 5 file.

use std::io::{self, Read};

use crate::error::ReadProblem;
use crate::formats::bytes::{ByteReader, NumberType};

/// Deepest allowed nesting of structs.
pub(crate) const MOST_DEEP: usize = 16;
/// Longest name, and longest list of a struct's field names, bytes.
pub(crate) const MOST_NAME: u32 = 1 << 10;
pub(crate) const MOST_NAMES: u32 = 1 << 20;
/// Largest decompressed size of all variables, bytes.
pub(crate) const MOST_BYTES: u64 = 4 << 30;

/// Types of elements.
pub(crate) const INT8: u32 = 1;
pub(crate) const INT32: u32 = 5;
pub(crate) const UINT32: u32 = 6;
pub(crate) const MATRIX: u32 = 14;
pub(crate) const COMPRESSED: u32 = 15;

/// The tag of an element.
pub(crate) struct Tag {
    pub(crate) kind: u32,
    pub(crate) bytes: u32,
    /// Bytes between the end of the data and the next tag.
    padding: u32,
}

impl Tag {
    pub(crate) fn read(inside: &mut ByteReader<impl Read>) -> io::Result<Self> {
        let word = inside.u32()?;
        // Data of up to four bytes may be stored inside the eight bytes of the tag.
        // The size is in the upper half of the word in either byte order.
        let short = word >> 16;
        if short != 0 {
            return Ok(Self {
                kind: word & 0xffff,
                bytes: short,
                padding: 4_u32.saturating_sub(short),
            });
        }
        let bytes = inside.u32()?;
        Ok(Self { kind: word, bytes, padding: bytes.wrapping_neg() % 8 })
    }

    fn length(&self) -> u64 {
        u64::from(self.bytes) + u64::from(self.padding)
    }
}

/// Reads an element that holds 32-bit numbers.
pub(crate) fn words(
    inside: &mut ByteReader<impl Read>,
    kind: u32,
    most: u32,
    expected: &'static str,
) -> Result<Vec<u32>, ReadProblem> {
    let tag = Tag::read(inside)?;
    if tag.kind != kind || tag.bytes > most || tag.bytes % 4 != 0 {
        return Err(unexpected(tag.kind, expected));
    }
    let words = (0..tag.bytes / 4).map(|_| inside.u32()).collect::<Result<_, _>>()?;
    inside.skip(tag.padding.into())?;
    Ok(words)
}

/// Reads an element that holds text.
pub(crate) fn text(
    inside: &mut ByteReader<impl Read>,
    most: u32,
    expected: &'static str,
) -> Result<Vec<u8>, ReadProblem> {
    let tag = Tag::read(inside)?;
    if tag.kind != INT8 || tag.bytes > most {
        return Err(unexpected(tag.kind, expected));
    }
    let mut text = inside.vec(tag.length())?;
    text.truncate(tag.bytes as usize);
    Ok(text)
}

pub(crate) fn up_to_nul(bytes: &[u8]) -> String {
    let name = bytes.split(|byte| *byte == 0).next().unwrap_or_default();
    String::from_utf8_lossy(name).into_owned()
}

pub(crate) fn number_type(kind: u32) -> Option<NumberType> {
    Some(match kind {
        1 => NumberType::I8,
        2 => NumberType::U8,
        3 => NumberType::I16,
        4 => NumberType::U16,
        5 => NumberType::I32,
        6 => NumberType::U32,
        7 => NumberType::F32,
        9 => NumberType::F64,
        12 => NumberType::I64,
        13 => NumberType::U64,
        _ => return None,
    })
}

pub(crate) fn unexpected(kind: u32, expected: &str) -> ReadProblem {
    ReadProblem::Invalid(format!("type {kind} is not {expected} of a MATLAB 5 file; save it again"))
}
