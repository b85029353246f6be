//! Reader of NumPy arrays (NPY): numbers or records. An array of numbers has the shape `(n,)` or
//! `(n, channels)`, and the type f4, f8, i2 or i4. An array of records has the shape `(n,)`, and
//! its fields have these types.

use std::io::{BufReader, ErrorKind, Read, copy, sink};

use crate::error::{Fault, ReadProblem};
use crate::formats::bytes::NumberType;
use crate::formats::npy_header::Header;
use crate::formats::samples::{Order, Samples, channel_names};
use crate::input::InputFile;
use crate::sheet::{Columns, Layout};
use crate::value_limit::ValueLimit;

/// Largest number of channels or fields. An array with exchanged axes would have one channel for each sample.
const MAX_CHANNELS: u64 = 256;

/// Opens an NPY file. Its values are read one by one later.
pub(crate) fn open(opened: InputFile<'_>, limit: ValueLimit) -> Result<Samples<'_>, Fault> {
    let header = Header::parse(&opened.front)?;
    let (rows, width) = shape(&header)?;
    let mut bytes = BufReader::new(opened.stream());
    copy(&mut bytes.by_ref().take(header.bytes as u64), &mut sink())?;
    let (columns, layout) = match &header.names {
        Some(names) => (Columns::new(names.iter().cloned(), None), Layout::Named),
        None => {
            let are_integers = header.types.iter().any(|(kind, _)| full_scale(*kind).is_some());
            (channel_names(width), Layout::Channels { are_integers })
        }
    };
    Ok(Samples {
        columns,
        rate_hz: None,
        layout,
        frames: Some(rows),
        limit,
        order: if header.is_planar && header.names.is_none() {
            Order::Planar(rows)
        } else {
            Order::Interleaved
        },
        samples: Box::new(
            values(bytes, header, rows.saturating_mul(width as u64))
                .map(|value| value.map_err(Fault::from)),
        ),
    })
}

/// Returns the number of rows and columns of an array, or of records and fields.
fn shape(header: &Header) -> Result<(u64, usize), ReadProblem> {
    let shape = &header.shape[..];
    match (shape, &header.names) {
        ([rows], _) if header.types.len() as u64 <= MAX_CHANNELS => Ok((*rows, header.types.len())),
        ([rows, columns @ 1..=MAX_CHANNELS], None) => Ok((*rows, *columns as usize)),
        _ => Err(ReadProblem::Invalid(format!(
            "the array's shape is {shape:?}; expected (n,) or (n, channels), one row per sample"
        ))),
    }
}

/// Returns the values in the order of the file. Integers of a plain array are fractions of full
/// scale; those of records are the numbers themselves. If the file is too short, an error follows
/// its last value.
fn values(
    mut bytes: impl Read,
    header: Header,
    items: u64,
) -> impl Iterator<Item = Result<f64, ReadProblem>> {
    let is_plain = header.names.is_none();
    let types = header.types.into_iter().map(move |(kind, endian)| {
        let scale = full_scale(kind).filter(|_| is_plain).unwrap_or(1.0);
        (kind, endian, scale)
    });
    let types: Vec<_> = types.collect();
    let mut next = 0;
    let mut buffer = [0; 8];
    (0..items).map(move |read| {
        let (kind, endian, full_scale) = types[next];
        next = if next + 1 == types.len() { 0 } else { next + 1 };
        let value = &mut buffer[..kind.size()];
        match bytes.read_exact(value) {
            Ok(()) => Ok(kind.value(value, endian) / full_scale),
            Err(error) if error.kind() != ErrorKind::UnexpectedEof => {
                Err(ReadProblem::invalid(error))
            }
            Err(_) => Err(ReadProblem::Invalid(format!(
                "the file ends after {read} of {items} values; copy it again"
            ))),
        }
    })
}

/// Returns the full-scale value of an integer type; `None` for floats.
fn full_scale(kind: NumberType) -> Option<f64> {
    match kind {
        NumberType::I16 => Some(32_768.0),
        NumberType::I32 => Some(2_147_483_648.0),
        _ => None,
    }
}
