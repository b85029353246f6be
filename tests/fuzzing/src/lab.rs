//! Recordings in laboratory formats, and column maps.

use htex_author::recording::{ColumnMap, ReadOptions};

use crate::recordings::{recording_with, refused};

/// Maps that read the columns of any file by number.
const MAPS: &[&str] = &["lateral=#1:1", "lateral_x=#1*2-#2/4,lateral_y=#2:1,normal=#3:1"];

/// A FLAC file, whose header states a rate.
pub fn flac(input: &[u8]) -> bool {
    any_map("fuzzed.flac", input)
}

/// A MATLAB file, version 5.
pub fn mat(input: &[u8]) -> bool {
    any_map("fuzzed.mat", input)
}

/// A TDMS file from LabVIEW.
pub fn tdms(input: &[u8]) -> bool {
    any_map("fuzzed.tdms", input)
}

pub fn parquet(input: &[u8]) -> bool {
    any_map("fuzzed.parquet", input)
}

/// An Arrow IPC file or stream.
pub fn arrow(input: &[u8]) -> bool {
    any_map("fuzzed.arrow", input)
}

/// An HDF5 file, or a MATLAB file of version 7.3.
pub fn hdf5(input: &[u8]) -> bool {
    any_map("fuzzed.h5", input)
}

/// A column map on the first line, followed by its CSV.
pub fn column_map(input: &[u8]) -> bool {
    let line_end = input.iter().position(|byte| *byte == b'\n');
    let (map, rest) = input.split_at(line_end.unwrap_or(input.len()));
    match String::from_utf8_lossy(map).parse::<ColumnMap>() {
        Ok(map) => {
            let options = ReadOptions::default().with_map(map);
            recording_with("fuzzed.csv", rest, &options, 1000.0)
        }
        Err(error) => refused(&error),
    }
}

/// Reads a recording by its column names, and by each map.
fn any_map(name: &str, input: &[u8]) -> bool {
    let mut options = vec![ReadOptions::default()];
    for map in MAPS {
        let map = map.parse::<ColumnMap>().expect("a valid map");
        options.push(ReadOptions::default().with_map(map));
    }
    let read = |options: &ReadOptions| recording_with(name, input, options, 1000.0);
    options.iter().filter(|options| read(options)).count() > 0
}
