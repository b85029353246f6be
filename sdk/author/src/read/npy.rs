//! Recordings as NumPy arrays: `(n,)` or `(n, 1..=3)` of f4, f8, i2 or i4.

use std::io::{ErrorKind, Read};

use npyz::{DType, NpyFile, Order, TypeChar};

use super::blocks::Blocks;
use super::{ReadError, ReadOptions, assumption, from_channels, refuse_map};
use crate::recording::Recording;

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
        "the header does not describe a plain array of at most two dimensions; save a (n,) or (n, 1..3) array"
    )]
    NotPlain,
    #[error("not an NPY file that can be read: {0}")]
    Header(String),
    #[error("the array's shape is {0:?}; expected (n,) or (n, 1..3), one row per sample")]
    Shape(Vec<u64>),
    #[error("{0} rows are more than fit in memory")]
    Rows(u64),
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

/// Reads an NPY file, value by value.
pub(crate) fn read(mut blocks: Blocks<'_>, options: &ReadOptions) -> Result<Recording, ReadError> {
    let file = blocks.file;
    refuse_map(file, options)?;
    let Some(rate_hz) = options.rate_hz else {
        return Err(ReadError::NoRate {
            file: file.to_owned(),
        });
    };
    check_header(blocks.front()?).map_err(|problem| broken(file, problem))?;
    let limit = blocks.limit;
    let npy = NpyFile::new(blocks.rest()?).map_err(|error| {
        // The parser's messages have a picture of the position below the first line.
        let text = error.to_string();
        let first = htex_format::plain(text.lines().next().unwrap_or_default().trim_end());
        broken(file, NpyError::Header(first.into_owned()))
    })?;
    let shape = shape(npy.shape()).map_err(|problem| broken(file, problem))?;
    limit.check(file, npy.len())?;
    let (channels, is_integer) = channels(npy, shape).map_err(|problem| broken(file, problem))?;
    let mut recording = from_channels(file, rate_hz, channels, options)?;
    if options.scale.is_none() {
        recording
            .warnings
            .push(assumption(is_integer, options.quantity));
    }
    Ok(recording)
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

/// Rows and columns of an array.
type Shape = (usize, usize);

fn shape(shape: &[u64]) -> Result<Shape, NpyError> {
    let (rows, columns) = match shape {
        [rows] => (*rows, 1),
        [rows, columns @ 1..=3] => (*rows, *columns),
        _ => {
            return Err(NpyError::Shape(shape.to_vec()));
        }
    };
    let rows = usize::try_from(rows).map_err(|_| NpyError::Rows(rows))?;
    Ok((rows, columns as usize))
}

/// Returns the columns, with integers as fractions of full scale, and whether the values are integers.
fn channels(npy: NpyFile<impl Read>, shape: Shape) -> Result<(Vec<Vec<f64>>, bool), NpyError> {
    let DType::Plain(kind) = npy.dtype() else {
        return Err(NpyError::Records);
    };
    match (kind.type_char(), kind.size_field()) {
        (TypeChar::Float, 4) => Ok((deal(npy, shape, |x: f32| x.into())?, false)),
        (TypeChar::Float, 8) => Ok((deal(npy, shape, |x: f64| x)?, false)),
        (TypeChar::Int, 2) => Ok((deal(npy, shape, |x: i16| f64::from(x) / 32_768.0)?, true)),
        (TypeChar::Int, 4) => Ok((
            deal(npy, shape, |x: i32| f64::from(x) / 2_147_483_648.0)?,
            true,
        )),
        _ => Err(NpyError::Type(kind.to_string())),
    }
}

/// Distributes the values to their columns.
fn deal<T: npyz::Deserialize>(
    npy: NpyFile<impl Read>,
    (rows, columns): Shape,
    to_f64: impl Fn(T) -> f64,
) -> Result<Vec<Vec<f64>>, NpyError> {
    let (order, items) = (npy.order(), npy.len());
    let mut values = npy
        .data::<T>()
        .map_err(|error| NpyError::Type(error.to_string()))?;
    let mut dealt = vec![Vec::new(); columns];
    let mut next = |held: u64| match values.next() {
        Some(Ok(value)) => Ok(to_f64(value)),
        Some(Err(error)) if error.kind() != ErrorKind::UnexpectedEof => Err(error.into()),
        _ => Err(NpyError::End { read: held, items }),
    };
    let mut held = 0;
    match order {
        Order::C => {
            for _ in 0..rows {
                for column in &mut dealt {
                    column.push(next(held)?);
                    held += 1;
                }
            }
        }
        Order::Fortran => {
            for column in &mut dealt {
                for _ in 0..rows {
                    column.push(next(held)?);
                    held += 1;
                }
            }
        }
    }
    Ok(dealt)
}

fn broken(file: &str, problem: NpyError) -> ReadError {
    ReadError::Npy {
        file: file.to_owned(),
        problem: problem.to_string(),
    }
}
