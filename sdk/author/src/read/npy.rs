//! Recordings as NumPy arrays: `(n,)` or `(n, 1..=3)` of f4, f8, i2 or i4.

use npyz::{DType, NpyFile, Order, TypeChar};

use super::{ReadError, ReadOptions, assumption, from_channels, refuse_map};
use crate::recording::Recording;

/// Longest header text, bytes; NumPy writes 118 for such arrays.
const MAX_HEADER: usize = 4096;

/// Reads an NPY's bytes; `file` is its name.
pub(crate) fn read(
    file: &str,
    bytes: &[u8],
    options: &ReadOptions,
) -> Result<Recording, ReadError> {
    refuse_map(file, options)?;
    let Some(rate_hz) = options.rate_hz else {
        return Err(ReadError::NoRate {
            file: file.to_owned(),
        });
    };
    check_header(bytes).map_err(|problem| broken(file, problem))?;
    let npy = NpyFile::new(bytes).map_err(|error| {
        // Its parser draws a picture of the place below the first line.
        let text = error.to_string();
        let first = htex_format::plain(text.lines().next().unwrap_or_default().trim_end());
        broken(file, format!("not an NPY file that can be read: {first}"))
    })?;
    let (rows, columns) = shape(npy.shape()).map_err(|problem| broken(file, problem))?;
    let order = npy.order();
    let (values, is_integer) = values(npy).map_err(|problem| broken(file, problem))?;
    let mut recording = from_channels(
        file,
        rate_hz,
        channels(&values, rows, columns, order),
        options,
    )?;
    if options.scale.is_none() {
        recording
            .warnings
            .push(assumption(is_integer, options.quantity));
    }
    Ok(recording)
}

/// Keeps from the header's parser what would make it recurse, overflow or allocate without bound.
fn check_header(bytes: &[u8]) -> Result<(), String> {
    let (start, length) = match bytes {
        [_, _, _, _, _, _, 1, _, a, b, ..] => (10, usize::from(u16::from_le_bytes([*a, *b]))),
        [_, _, _, _, _, _, 2 | 3, _, a, b, c, d, ..] => {
            (12, u32::from_le_bytes([*a, *b, *c, *d]) as usize)
        }
        _ => {
            return Err(
                "the file ends in its header or is of an unknown NPY version; copy it again".into(),
            );
        }
    };
    if length > MAX_HEADER {
        return Err(format!(
            "the header says it is {length} bytes long, more than the limit of {MAX_HEADER}"
        ));
    }
    let Some(header) = bytes.get(start..start + length) else {
        return Err(format!(
            "the file ends at byte {}, inside its header; copy it again",
            bytes.len()
        ));
    };
    let brackets = header.iter().filter(|byte| b"([{".contains(byte)).count();
    let digits = header.iter().filter(|byte| byte.is_ascii_digit()).count();
    if brackets > 4 || digits > 18 {
        return Err("the header describes no plain array of at most two dimensions; save a (n,) or (n, 1..3) array".into());
    }
    Ok(())
}

fn shape(shape: &[u64]) -> Result<(usize, usize), String> {
    let (rows, columns) = match shape {
        [rows] => (*rows, 1),
        [rows, columns @ 1..=3] => (*rows, *columns),
        _ => {
            return Err(format!(
                "the array's shape is {shape:?}; (n,) or (n, 1..3) is expected, one row a sample"
            ));
        }
    };
    let rows =
        usize::try_from(rows).map_err(|_| format!("{rows} rows are more than fit in memory"))?;
    Ok((rows, columns as usize))
}

/// All values in the order stored, integers as fractions of full scale; true for integers.
fn values(npy: NpyFile<&[u8]>) -> Result<(Vec<f64>, bool), String> {
    let DType::Plain(kind) = npy.dtype() else {
        return Err("the array holds records; save a plain float array".into());
    };
    match (kind.type_char(), kind.size_field()) {
        (TypeChar::Float, 4) => Ok((collect::<f32>(npy, 4, f64::from)?, false)),
        (TypeChar::Float, 8) => Ok((collect::<f64>(npy, 8, |value| value)?, false)),
        (TypeChar::Int, 2) => Ok((
            collect::<i16>(npy, 2, |value| f64::from(value) / 32_768.0)?,
            true,
        )),
        (TypeChar::Int, 4) => Ok((
            collect::<i32>(npy, 4, |value| f64::from(value) / 2_147_483_648.0)?,
            true,
        )),
        _ => Err(format!(
            "the array holds {kind}; f4, f8, i2 or i4 is expected (in NumPy: array.astype('f8'))"
        )),
    }
}

/// Reads `npy.len()` items, after seeing that the file holds them.
fn collect<T: npyz::Deserialize>(
    npy: NpyFile<&[u8]>,
    item_bytes: u64,
    to_f64: impl Fn(T) -> f64,
) -> Result<Vec<f64>, String> {
    let items = npy.len();
    let header = npy.header().clone();
    let data = npy.into_inner();
    let held = data.len() as u64 / item_bytes;
    if held < items {
        return Err(format!(
            "the file ends after {held} of {items} values; copy it again"
        ));
    }
    let reader = NpyFile::with_header(header, data)
        .data::<T>()
        .map_err(|error| error.to_string())?;
    reader
        .map(|item| item.map(&to_f64).map_err(|error| error.to_string()))
        .collect()
}

fn channels(values: &[f64], rows: usize, columns: usize, order: Order) -> Vec<Vec<f64>> {
    let at = |row: usize, column: usize| match order {
        Order::C => values[row * columns + column],
        Order::Fortran => values[column * rows + row],
    };
    (0..columns)
        .map(|column| (0..rows).map(|row| at(row, column)).collect())
        .collect()
}

fn broken(file: &str, problem: String) -> ReadError {
    ReadError::Npy {
        file: file.to_owned(),
        problem,
    }
}
