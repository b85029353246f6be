//! The table of all recording formats, and the readers of their files.

#[cfg(feature = "lab-files")]
mod arrow;
#[cfg(feature = "lab-files")]
mod arrow_schema;
mod blocks;
mod bytes;
mod cells;
pub(crate) mod csv;
#[cfg(feature = "flac")]
mod flac;
#[cfg(feature = "lab-files")]
mod hdf5;
#[cfg(feature = "matlab")]
mod mat;
#[cfg(feature = "matlab")]
mod mat_element;
mod matrix;
#[cfg(feature = "npy")]
mod npy;
#[cfg(feature = "npy")]
mod npy_header;
mod number;
#[cfg(feature = "lab-files")]
mod parquet;
mod samples;
#[cfg(feature = "lab-files")]
mod shared;
mod table;
#[cfg(feature = "tdms")]
mod tdms;
#[cfg(feature = "tdms")]
mod tdms_directory;
#[cfg(feature = "tdms")]
mod tdms_object;
mod text;
#[cfg(feature = "lab-files")]
mod thrift;
#[cfg(feature = "wav")]
mod wav;

use crate::error::{Fault, ReadProblem};
use crate::input::InputFile;
use crate::options::ReadOptions;
use crate::sheet::{Layout, Sheet};
use crate::value_limit::ValueLimit;

#[derive(Debug)]
#[non_exhaustive]
pub struct Format {
    pub name: &'static str,
    /// File extensions, in lower case. The extension determines the format only if the file has no
    /// known signature.
    pub extensions: &'static [&'static str],
    /// Signatures: byte sequences with their offsets in the file. A file has this format if one of
    /// the signatures matches.
    pub signatures: &'static [(usize, &'static [u8])],
    /// The feature of this crate that enables the format's reader; empty if the reader is always
    /// included.
    pub feature: &'static str,
    open: Option<Open>,
}

type Open = for<'a> fn(InputFile<'a>, ValueLimit) -> Result<Box<dyn Sheet + 'a>, Fault>;

/// The reader of a format, if it was built.
macro_rules! reader {
    ($feature:literal, $open:path) => {{
        #[cfg(feature = $feature)]
        {
            Some(|opened, limit| Ok(Box::new($open(opened, limit)?)))
        }
        #[cfg(not(feature = $feature))]
        {
            None
        }
    }};
}

/// Text: the format of any file that has neither a known signature nor a known extension.
const CSV: Format = Format {
    name: "CSV",
    extensions: &["csv", "tsv", "txt"],
    signatures: &[],
    feature: "",
    open: Some(|opened, limit| Ok(Box::new(csv::Csv::open(opened, limit)?))),
};

/// All formats that can be read, in the order in which their signatures are tried.
pub const FORMATS: &[Format] = &[
    CSV,
    Format {
        name: "WAV",
        extensions: &["wav", "wave"],
        signatures: &[(0, b"RIFF")],
        feature: "wav",
        open: reader!("wav", wav::open),
    },
    Format {
        name: "FLAC",
        extensions: &["flac"],
        signatures: &[(0, b"fLaC")],
        feature: "flac",
        open: reader!("flac", flac::open),
    },
    Format {
        name: "NPY",
        extensions: &["npy"],
        signatures: &[(0, b"\x93NUMPY")],
        feature: "npy",
        open: reader!("npy", npy::open),
    },
    Format {
        name: "MATLAB",
        extensions: &["mat"],
        // Version 1, with either byte order.
        signatures: &[(124, b"\0\x01IM"), (124, b"\x01\0MI")],
        feature: "matlab",
        open: reader!("matlab", mat::Mat::open),
    },
    Format {
        name: "TDMS",
        extensions: &["tdms", "tdms_index"],
        signatures: &[(0, b"TDSm"), (0, b"TDSh")],
        feature: "tdms",
        open: reader!("tdms", tdms::Tdms::open),
    },
    Format {
        name: "Parquet",
        extensions: &["parquet"],
        signatures: &[(0, b"PAR1")],
        feature: "lab-files",
        open: reader!("lab-files", parquet::Parquet::open),
    },
    Format {
        name: "Arrow",
        extensions: &["arrow", "arrows", "feather", "ipc"],
        signatures: &[(0, b"ARROW1"), (0, b"FEA1"), (0, b"\xff\xff\xff\xff")],
        feature: "lab-files",
        open: reader!("lab-files", arrow::Arrow::open),
    },
    Format {
        name: "HDF5 (MATLAB 7.3)",
        extensions: &["hdf5", "h5"],
        // The file may begin with a user block, which has 512 bytes in MATLAB 7.3.
        signatures: &[(0, HDF5_START), (512, HDF5_START), (1024, HDF5_START), (2048, HDF5_START)],
        feature: "lab-files",
        open: reader!("lab-files", hdf5::Hdf5::open),
    },
];

const HDF5_START: &[u8] = b"\x89HDF\r\n\x1a\n";

impl Format {
    /// Detects the format of a file by its signature, or else by its extension; the default is
    /// text.
    fn detect(opened: &InputFile<'_>) -> &'static Self {
        let extension = opened.path.extension().map(|e| e.to_ascii_lowercase());
        let extension = extension.as_ref().and_then(|extension| extension.to_str());
        let is_signed = |format: &&Self| format.is_signed(&opened.front);
        let is_named = |format: &&Self| extension.is_some_and(|e| format.extensions.contains(&e));
        let mut formats = FORMATS.iter();
        let signed = formats.find(is_signed);
        signed.or_else(|| FORMATS.iter().find(is_named)).unwrap_or(&CSV)
    }

    fn is_signed(&self, front: &[u8]) -> bool {
        let mut signatures = self.signatures.iter();
        signatures.any(|(at, bytes)| front.get(*at..).is_some_and(|all| all.starts_with(bytes)))
    }

    /// Returns whether this build can read the format.
    #[must_use]
    pub fn is_built(&self) -> bool {
        self.open.is_some()
    }
}

/// Returns the names of all formats as a text such as `CSV, WAV, FLAC`.
#[must_use]
pub fn format_names() -> String {
    let names: Vec<&str> = FORMATS.iter().map(|format| format.name).collect();
    names.join(", ")
}

/// Opens a file of any format and refuses options that do not apply to it.
pub(crate) fn open<'a>(
    opened: InputFile<'a>,
    options: &ReadOptions,
) -> Result<Box<dyn Sheet + 'a>, Fault> {
    let format = Format::detect(&opened);
    let reader = format.open.ok_or_else(|| not_built(format.feature))?;
    let sheet = reader(opened, options.value_limit())?;
    check(&*sheet, options)?;
    Ok(sheet)
}

fn not_built(feature: &'static str) -> ReadProblem {
    let of_feature = FORMATS.iter().filter(|format| format.feature == feature);
    let names: Vec<&str> = of_feature.map(|format| format.name).collect();
    let formats = match &names[..] {
        [before @ .., last] if !before.is_empty() => format!("{} and {last}", before.join(", ")),
        names => names.concat(),
    };
    ReadProblem::NotBuilt { formats, feature }
}

/// Returns the text of a problem in a file that states the sizes of its parts. An error of reading
/// can also mean that the file ends too early.
#[cfg(any(feature = "lab-files", feature = "tdms"))]
fn damage(problem: &ReadProblem) -> String {
    match problem {
        ReadProblem::Io(error) => {
            format!("the file ends or cannot be read here: {error}; copy it again")
        }
        other => other.to_string(),
    }
}

fn check(sheet: &dyn Sheet, options: &ReadOptions) -> Result<(), Fault> {
    let refuse = |option, problem| Err(ReadProblem::Option { option, problem }.into());
    let own_hz = match sheet.layout() {
        Layout::Text if options.scale.is_some() => {
            let problem = "a scale is for files of samples; scale a CSV's columns in the column map, as in lateral=COLUMN:SCALE";
            return refuse("scale", problem.to_owned());
        }
        Layout::Channels { .. } if options.scale.is_some() && options.map.is_some() => {
            let problem = "a column map and a scale are given; put the scale into the map, as in lateral=#1:SCALE";
            return refuse("scale", problem.to_owned());
        }
        Layout::Channels { .. } => sheet.rate_hz(&[])?,
        Layout::Text | Layout::Named => None,
    };
    match (own_hz, options.rate_hz) {
        (Some(own), Some(given)) if own != given => refuse(
            "rate_hz",
            format!(
                "the file has {own} Hz, the given sample rate is {given} Hz; leave it out or correct the file's header"
            ),
        ),
        _ => Ok(()),
    }
}
