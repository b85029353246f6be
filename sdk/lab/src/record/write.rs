//! Writes the files of a take: the recording, the tracker's rows, and a JSON file that describes
//! the take.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use htex_base::files::{AtFile, OwnFolder};
use htex_format::Quantity;
use serde_json::{Value, json};

use crate::error::LabError;
use crate::record::data::{TakeData, TakeHeader};
use crate::record::files::{self, Format, Outcome};
use crate::record::judge::Verdict;

/// The files that were written for a take.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct TakeFiles {
    pub(crate) recording: PathBuf,
    /// Arguments with which `htex fit` reads the recording.
    pub(crate) fit: Vec<String>,
}

/// Writes a take into a folder that the user named. Each file is written under a temporary name and
/// then renamed.
///
/// # Errors
/// [`LabError::File`].
pub(crate) fn write_take(
    folder: &Path,
    data: &TakeData,
    outcome: Outcome,
    verdict: &Verdict,
) -> Result<TakeFiles, LabError> {
    let stem = files::stem(&data.header.name, data.header.number);
    let own = OwnFolder::private(folder);
    write_signals(&own, outcome.folder(), &stem, data, &|fit| {
        json!({
            "outcome": outcome,
            "take": data.header,
            "frames": data.frames(),
            "recorded_s": data.recorded_s(),
            "verdict": verdict,
            "fit": fit,
        })
    })
}

/// Writes a recording, the tracker's rows and the JSON into the folder `inside`, which lies in the
/// user's folder. Each file is written under a temporary name and then renamed. `beside` gets the
/// arguments with which `htex fit` reads the recording, and returns the JSON.
///
/// # Errors
/// [`LabError::File`].
pub(crate) fn write_signals(
    own: &OwnFolder,
    inside: &Path,
    stem: &str,
    data: &TakeData,
    beside: &dyn Fn(&[String]) -> Value,
) -> Result<TakeFiles, LabError> {
    let header = &data.header;
    let name = inside.join(format!("{stem}.{}", header.format.extension()));
    let recording = own.path().join(&name);
    let put = |inside: &Path, write: &dyn Fn(&mut File) -> io::Result<()>| {
        own.replace(inside, write).writing(own.path().join(inside))
    };
    let mut fit = vec![recording.display().to_string()];
    fit.extend(flags(header));
    if !data.tracker.is_empty() && data.tracker[0].len() > 1 {
        let tracker = inside.join("tracker").join(format!("{stem}.csv"));
        put(&tracker, &|file| tracker_csv(data, file))?;
        let tracker = own.path().join(&tracker);
        fit.extend(["--tracker".to_owned(), tracker.display().to_string()]);
    }
    let beside = serde_json::to_string_pretty(&beside(&fit)).unwrap_or_default() + "\n";
    put(&name, &|file| match header.format {
        Format::Csv => csv(data, file),
        Format::Npy => npy(data, file),
        Format::Wav => wav(data, file),
    })?;
    // The JSON is written last, so that it never describes a recording that does not exist.
    put(&inside.join(format!("{stem}.json")), &|file| file.write_all(beside.as_bytes()))?;
    Ok(TakeFiles { recording, fit })
}

/// Returns the flags of `htex fit` that state what the file format itself does not state.
fn flags(header: &TakeHeader) -> Vec<String> {
    let mut flags = Vec::new();
    let (map, rate_hz) = reading(header);
    if header.quantity != Quantity::LateralForce {
        let name = header.quantity.name().replace('_', "-");
        flags.extend(["--quantity".to_owned(), name]);
    }
    flags.extend(map.into_iter().flat_map(|map| ["--map".to_owned(), map]));
    flags.extend(rate_hz.into_iter().flat_map(|hz| ["--rate".to_owned(), hz.to_string()]));
    flags
}

/// Returns the map and the sample rate that a reader needs because the format does not state them.
pub(crate) fn reading(header: &TakeHeader) -> (Option<String>, Option<f64>) {
    if header.format == Format::Csv {
        return (None, None);
    }
    let rate_hz = (header.format == Format::Npy).then_some(header.rate_hz);
    (Some(column_map(header)), rate_hz)
}

/// Returns the roles of the columns, for a format without column names.
fn column_map(header: &TakeHeader) -> String {
    let signals = header.signals.iter().enumerate();
    let map: Vec<String> = signals.map(|(at, (role, _))| format!("{role}=#{}:1", at + 1)).collect();
    map.join(",")
}

/// Returns a column name that tells `htex fit` the role and the unit.
fn column(role: &str, unit: &str, quantity: Quantity) -> String {
    let base = match quantity {
        Quantity::Acceleration => "accel",
        Quantity::Velocity => "vel",
        Quantity::Displacement => "disp",
        Quantity::LateralForce | Quantity::NormalForce => "signal",
    };
    format!("{}_{}", role.replace("signal", base), unit.replace('/', "_"))
}

fn csv(data: &TakeData, file: &mut File) -> io::Result<()> {
    let mut out = BufWriter::new(file);
    write!(out, "time_s")?;
    for (role, unit) in &data.header.signals {
        write!(out, ",{}", column(role, unit, data.header.quantity))?;
    }
    writeln!(out)?;
    for row in 0..data.frames() {
        write!(out, "{}", row as f64 / data.header.rate_hz)?;
        for values in &data.signals {
            write!(out, ",{}", values[row])?;
        }
        writeln!(out)?;
    }
    out.flush()
}

fn tracker_csv(data: &TakeData, file: &mut File) -> io::Result<()> {
    let mut out = BufWriter::new(file);
    write!(out, "time_s")?;
    for (role, unit) in &data.header.tracker {
        write!(out, ",{role}_{}", unit.replace('/', "_"))?;
    }
    writeln!(out)?;
    for row in 0..data.tracker[0].len() {
        let cells: Vec<String> = data.tracker.iter().map(|c| c[row].to_string()).collect();
        writeln!(out, "{}", cells.join(","))?;
    }
    out.flush()
}

/// Writes format version 1.0. The first 10 bytes and the header together must have a length that is
/// a multiple of 64.
fn npy(data: &TakeData, file: &mut File) -> io::Result<()> {
    let shape = (data.frames(), data.signals.len());
    let header = format!(
        "{{'descr': '<f8', 'fortran_order': False, 'shape': ({}, {}), }}",
        shape.0, shape.1
    );
    let length = (10 + header.len() + 1).next_multiple_of(64) - 10;
    let mut out = BufWriter::new(file);
    out.write_all(b"\x93NUMPY\x01\x00")?;
    out.write_all(&(length as u16).to_le_bytes())?;
    writeln!(out, "{header:<width$}", width = length - 1)?;
    for row in 0..shape.0 {
        for values in &data.signals {
            out.write_all(&values[row].to_le_bytes())?;
        }
    }
    out.flush()
}

fn wav(data: &TakeData, file: &mut File) -> io::Result<()> {
    let spec = hound::WavSpec {
        channels: data.signals.len() as u16,
        sample_rate: data.header.rate_hz as u32,
        bits_per_sample: 32,
        sample_format: hound::SampleFormat::Float,
    };
    let mut writer = hound::WavWriter::new(BufWriter::new(file), spec).map_err(io::Error::other)?;
    for row in 0..data.frames() {
        for values in &data.signals {
            writer.write_sample(values[row] as f32).map_err(io::Error::other)?;
        }
    }
    writer.finalize().map_err(io::Error::other)
}
