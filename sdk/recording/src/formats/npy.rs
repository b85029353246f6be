//! NumPy arrays: `(n,)` or `(n, channels)` of f4, f8, i2 or i4.

use std::io::{BufReader, ErrorKind, Read};

use npyz::{DType, NpyFile, TypeChar};

use crate::ReadError;
use crate::formats::samples::{Order, Samples, channel_names};
use crate::input::Opened;
use crate::value_limit::ValueLimit;

/// Problem of an array, and what to do.
#[derive(Debug, thiserror::Error)]
enum NpyError {
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
    #[error("not an NPY file that can be read: {0}")]
    Header(String),
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

/// Longest header, bytes; NumPy writes 118 for such arrays.
const MAX_HEADER: usize = 4096;
/// Most channels: an array with its axes exchanged has one for each sample.
const MAX_CHANNELS: u64 = 256;

/// Opens an NPY file, whose values are then read one by one.
pub(crate) fn open(opened: Opened<'_>, limit: ValueLimit) -> Result<Samples<'_>, ReadError> {
    let file = opened.file.clone();
    check_header(&opened.front).map_err(|problem| broken(&file, problem))?;
    let npy = NpyFile::new(BufReader::new(opened.stream())).map_err(|error| {
        // The parser's messages have a picture of the position below the first line.
        let text = error.to_string();
        let first = htex_format::plain(text.lines().next().unwrap_or_default().trim_end());
        broken(&file, NpyError::Header(first.into_owned()))
    })?;
    let (rows, width) = shape(npy.shape()).map_err(|problem| broken(&file, problem))?;
    let order = match npy.order() {
        npyz::Order::C => Order::Interleaved,
        npyz::Order::Fortran => Order::Planar(rows),
    };
    let columns = channel_names(&file, width);
    let in_file = file.clone();
    let (values, are_integers) = values(npy).map_err(|problem| broken(&file, problem))?;
    Ok(Samples {
        columns,
        rate_hz: None,
        are_integers,
        frames: Some(rows),
        limit,
        order,
        samples: Box::new(
            values.map(move |value| value.map_err(|problem| broken(&in_file, problem))),
        ),
    })
}

/// Refuses headers that would make the parser recurse, overflow or allocate without bound.
fn check_header(bytes: &[u8]) -> Result<(), NpyError> {
    let (start, length) = match bytes {
        [_, _, _, _, _, _, 1, _, a, b, ..] => (10, usize::from(u16::from_le_bytes([*a, *b]))),
        [_, _, _, _, _, _, 2 | 3, _, a, b, c, d, ..] => {
            (12, u32::from_le_bytes([*a, *b, *c, *d]) as usize)
        }
        _ => {
            return Err(NpyError::Start);
        }
    };
    if length > MAX_HEADER {
        return Err(NpyError::LongHeader(length));
    }
    let Some(header) = bytes.get(start..start + length) else {
        return Err(NpyError::EndInHeader(bytes.len()));
    };
    let brackets = header.iter().filter(|byte| b"([{".contains(byte)).count();
    let digits = header.iter().filter(|byte| byte.is_ascii_digit()).count();
    if brackets > 4 || digits > 18 {
        return Err(NpyError::NotPlain);
    }
    Ok(())
}

/// Returns the rows and columns of an array.
fn shape(shape: &[u64]) -> Result<(u64, usize), NpyError> {
    match shape {
        [rows] => Ok((*rows, 1)),
        [rows, columns @ 1..=MAX_CHANNELS] => Ok((*rows, *columns as usize)),
        _ => Err(NpyError::Shape(shape.to_vec())),
    }
}

type Values<'a> = Box<dyn Iterator<Item = Result<f64, NpyError>> + 'a>;

/// Returns the values in the order of the file, with integers as fractions of full scale, and whether they are integers.
fn values<'a>(npy: NpyFile<impl Read + 'a>) -> Result<(Values<'a>, bool), NpyError> {
    let DType::Plain(kind) = npy.dtype() else {
        return Err(NpyError::Records);
    };
    match (kind.type_char(), kind.size_field()) {
        (TypeChar::Float, 4) => Ok((converted(npy, |x: f32| x.into())?, false)),
        (TypeChar::Float, 8) => Ok((converted(npy, |x: f64| x)?, false)),
        (TypeChar::Int, 2) => Ok((converted(npy, |x: i16| f64::from(x) / 32_768.0)?, true)),
        (TypeChar::Int, 4) => Ok((
            converted(npy, |x: i32| f64::from(x) / 2_147_483_648.0)?,
            true,
        )),
        _ => Err(NpyError::Type(kind.to_string())),
    }
}

/// Returns the values as `f64`; a file that is too short is an error after its last value.
fn converted<'a, T: npyz::Deserialize + 'a>(
    npy: NpyFile<impl Read + 'a>,
    to_f64: impl Fn(T) -> f64 + 'a,
) -> Result<Values<'a>, NpyError> {
    let items = npy.len();
    let mut values = npy
        .data::<T>()
        .map_err(|error| NpyError::Type(error.to_string()))?;
    let value = move |read: u64| match values.next() {
        Some(Ok(value)) => Ok(to_f64(value)),
        Some(Err(error)) if error.kind() != ErrorKind::UnexpectedEof => Err(error.into()),
        _ => Err(NpyError::End { read, items }),
    };
    Ok(Box::new((0..items).map(value)))
}

fn broken(file: &str, problem: NpyError) -> ReadError {
    ReadError::Npy {
        file: file.to_owned(),
        problem: problem.to_string(),
    }
}
