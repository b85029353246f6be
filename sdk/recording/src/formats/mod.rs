//! The kind of a file, and its reader.

#[cfg(feature = "lab-files")]
mod arrow;
#[cfg(feature = "lab-files")]
mod arrow_schema;
pub(crate) mod blocks;
mod bytes;
mod csv;
mod flac;
#[cfg(feature = "lab-files")]
mod hdf5;
mod mat;
mod mat_element;
mod matrix;
mod npy;
mod number;
#[cfg(feature = "lab-files")]
mod parquet;
pub(crate) mod samples;
#[cfg(feature = "lab-files")]
mod shared;
pub(crate) mod table;
mod tdms;
mod tdms_directory;
mod tdms_object;
pub(crate) mod text;
#[cfg(feature = "lab-files")]
mod thrift;
mod wav;

use std::path::Path;

use crate::formats::blocks::Blocks;
use crate::formats::csv::Csv;
use crate::formats::mat::Mat;
use crate::formats::samples::Samples;
use crate::formats::tdms::Tdms;
use crate::input::Opened;
use crate::sheet::Sheet;
use crate::{ReadError, ReadOptions};

/// A kind of file that is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Csv,
    Wav,
    Flac,
    Npy,
    Mat,
    Tdms,
    Parquet,
    Arrow,
    Hdf5,
}

impl Kind {
    /// Detects the kind of file by its signature, else by its extension; the default is text.
    pub(crate) fn of(path: &Path, front: &[u8]) -> Self {
        by_signature(front)
            .or_else(|| by_extension(path))
            .unwrap_or(Self::Csv)
    }
}

fn by_signature(front: &[u8]) -> Option<Kind> {
    // Version 1 and the byte order.
    if let Some(b"\0\x01IM" | b"\x01\0MI") = front.get(124..128) {
        return Some(Kind::Mat);
    }
    // A block of the user may precede the file, of 512 bytes in those of MATLAB 7.3.
    let is_hdf5 = |at: &usize| {
        front
            .get(*at..)
            .is_some_and(|bytes| bytes.starts_with(b"\x89HDF\r\n\x1a\n"))
    };
    if [0, 512, 1024, 2048].iter().any(is_hdf5) {
        return Some(Kind::Hdf5);
    }
    let kinds: [(&[u8], Kind); 9] = [
        (b"RIFF", Kind::Wav),
        (b"fLaC", Kind::Flac),
        (b"\x93NUMPY", Kind::Npy),
        (b"TDSm", Kind::Tdms),
        (b"TDSh", Kind::Tdms),
        (b"PAR1", Kind::Parquet),
        (b"ARROW1", Kind::Arrow),
        (b"FEA1", Kind::Arrow),
        (b"\xff\xff\xff\xff", Kind::Arrow),
    ];
    let found = kinds
        .iter()
        .find(|(signature, _)| front.starts_with(signature));
    found.map(|(_, kind)| *kind)
}

fn by_extension(path: &Path) -> Option<Kind> {
    let extension = path.extension()?.to_ascii_lowercase();
    Some(match extension.to_str()? {
        "wav" | "wave" => Kind::Wav,
        "flac" => Kind::Flac,
        "npy" => Kind::Npy,
        "mat" => Kind::Mat,
        "tdms" | "tdms_index" => Kind::Tdms,
        "parquet" => Kind::Parquet,
        "arrow" | "arrows" | "feather" | "ipc" => Kind::Arrow,
        "h5" | "hdf5" => Kind::Hdf5,
        _ => return None,
    })
}

/// Calls a function with the columns of a file.
pub(crate) fn with_sheet<T>(
    opened: Opened<'_>,
    options: &ReadOptions,
    read: impl FnOnce(&mut dyn Sheet) -> Result<T, ReadError>,
) -> Result<T, ReadError> {
    let (file, limit) = (opened.file.clone(), options.value_limit());
    match Kind::of(&opened.path, &opened.front) {
        Kind::Csv => {
            let mut blocks = Blocks::new(&file, opened.stream(), limit);
            let head = blocks.head()?;
            read(&mut Csv::new(&file, &head, blocks, options)?)
        }
        Kind::Wav => read(&mut sheet(wav::open(opened, limit)?, options)?),
        Kind::Flac => read(&mut sheet(flac::open(opened, limit)?, options)?),
        Kind::Mat => read(&mut Mat::open(opened, limit)?),
        Kind::Tdms => read(&mut Tdms::open(opened, limit)?),
        #[cfg(feature = "lab-files")]
        Kind::Parquet => read(&mut crate::formats::parquet::Parquet::open(opened, limit)?),
        #[cfg(feature = "lab-files")]
        Kind::Arrow => read(&mut crate::formats::arrow::Arrow::open(opened, limit)?),
        #[cfg(feature = "lab-files")]
        Kind::Hdf5 => read(&mut crate::formats::hdf5::Hdf5::open(opened, limit)?),
        #[cfg(not(feature = "lab-files"))]
        Kind::Parquet | Kind::Arrow | Kind::Hdf5 => Err(ReadError::NotBuilt { file }),
        Kind::Npy => read(&mut sheet(npy::open(opened, limit)?, options)?),
    }
}

/// Returns samples as columns, for a map.
fn sheet<'a>(samples: Samples<'a>, options: &ReadOptions) -> Result<Samples<'a>, ReadError> {
    if options.scale.is_some() {
        return Err(ReadError::Option {
            file: samples.file().to_owned(),
            option: "scale",
            problem: "a column map and a scale are given; put the scale into the map, as in lateral=#1:SCALE".into(),
        });
    }
    samples.check_rate(options.rate_hz)?;
    Ok(samples)
}
