//! Files as laboratories store them, written by SciPy, h5py, npTDMS, pyarrow and soundfile
//! (`lab/make.py`). They are compared with the numbers that these libraries read back
//! (`lab/expected.json`).

use crate::common::files;

use std::fs;
use std::mem;
use std::path::{Path, PathBuf};

use files::{has_warning, mapped, read};
use htex_recording::Recording;
use htex_recording::{ReadOptions, read_recording, recording_from_bytes};
use serde_json::Value;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/lab")
}

/// A file, with the columns that a library reads from it.
struct Case {
    name: String,
    rate_hz: Option<f64>,
    columns: Vec<(String, Vec<f64>)>,
}

/// The files that this build can read.
fn cases() -> Vec<Case> {
    let text = fs::read_to_string(folder().join("expected.json")).unwrap();
    let all: Value = serde_json::from_str(&text).unwrap();
    let case = |(name, entry): (&String, &Value)| Case {
        name: name.clone(),
        rate_hz: entry["rate_hz"].as_f64(),
        columns: entry["columns"]
            .as_object()
            .unwrap()
            .iter()
            .map(|(name, values)| {
                let values = values.as_array().unwrap();
                (name.clone(), values.iter().map(|x| x.as_f64().unwrap()).collect())
            })
            .collect(),
    };
    let all = all.as_object().unwrap().iter().map(case);
    all.filter(|case| cfg!(feature = "lab-files") || !is_heavy(&case.name)).collect()
}

/// Whether a file can be read only with the feature `lab-files`.
fn is_heavy(name: &str) -> bool {
    let kinds = [".h5", "version73.mat", ".parquet", ".feather", ".arrow", ".arrows"];
    kinds.iter().any(|end| name.ends_with(end))
}

fn read_lab(name: &str, options: &ReadOptions) -> Result<Recording, String> {
    let split = |mut read: Recording| (mem::take(&mut read.file).blake3(), read);
    let from_file =
        read_recording(&folder().join(name), options).map(split).map_err(|error| error.to_string());
    let bytes = fs::read(folder().join(name)).unwrap();
    let from_bytes = recording_from_bytes(Path::new(name), &bytes, options)
        .map(split)
        .map_err(|error| error.to_string());
    assert_eq!(from_file, from_bytes, "{name}");
    from_file.map(|(_, recording)| recording)
}

#[test]
fn every_column_is_what_its_library_reads() {
    let cases = cases();
    assert!(cases.len() >= 11);
    for case in &cases {
        for (column, expected) in &case.columns {
            let options =
                mapped(&format!("lateral=\"{column}\":1"), Some(case.rate_hz.unwrap_or(100.0)));
            let recording = read_lab(&case.name, &options);
            let recording =
                recording.unwrap_or_else(|error| panic!("{} {column}: {error}", case.name));
            assert_eq!(&recording.axes[0], expected, "{} {column}", case.name);
        }
    }
}

#[test]
fn a_recording_is_that_of_the_csv_with_the_same_numbers() {
    for case in cases() {
        // An expression over the file's first column and another column of the same length.
        let (first, values) = &case.columns[0];
        let mut others = case.columns.iter().skip(1);
        let (second, other) =
            others.find(|(_, other)| other.len() == values.len()).unwrap_or(&case.columns[0]);
        let rows = values.iter().zip(other).map(|(a, b)| format!("{a:e},{b:e}\n"));
        let csv = format!("one,two\n{}", rows.collect::<String>());
        let map = |one: &str, two: &str| {
            format!("lateral=\"{one}\"*2-\"{two}\"/4,normal=0.4+0*\"{two}\",speed=80")
        };
        let rate_hz = case.rate_hz.unwrap_or(2000.0);
        let expected = read("c.csv", csv, &mapped(&map("one", "two"), Some(rate_hz))).unwrap();
        let given = (!case.name.ends_with("tdms")).then_some(rate_hz);
        let found = read_lab(&case.name, &mapped(&map(first, second), given)).unwrap();
        let without_file = |mut recording: Recording| {
            recording.source = String::new();
            recording.file = Default::default();
            recording.warnings.retain(|warning| !warning.starts_with("Column"));
            recording
        };
        assert_eq!(without_file(found), without_file(expected), "{}", case.name);
    }
}

#[test]
fn names_units_and_rates_are_those_of_the_file() {
    let plain = read_lab("segments.tdms", &ReadOptions::default()).unwrap();
    assert_eq!((plain.rate_hz, plain.samples()), (2000.0, 96));
    assert!(plain.normal_n.is_some() && has_warning(&plain, "\"Run 1/fz\" (normal) has no unit"));
    for (name, map, words) in [
        ("segments.tdms", "lateral=fx_n,normal=it's/raw:1", "its samples are 0.001 s apart"),
        ("segments.tdms", "lateral=fy", "the columns are: Run 1/fx_n, Run 1/fz, Run 2/it's/raw"),
        ("plain.mat", "lateral=note", "the columns are: t, fx_n, fz_n, counts, run.forces#1"),
        (
            "plain.mat",
            "lateral=run.deep.x:1,normal=f:1",
            "several columns have the name \"f\", such as runs(1).f and runs(2).f",
        ),
    ] {
        let error = read_lab(name, &mapped(map, None)).unwrap_err();
        assert!(error.contains(words), "{map}: {error}");
    }
    let nested = read_lab("compressed.mat", &mapped("lateral=run.deep.x:1", None)).unwrap();
    assert_eq!(nested.rate_hz, 2000.0, "run.fs applies to run.deep.x");
    let by_name = read_lab("compressed.mat", &ReadOptions::default()).unwrap();
    assert_eq!((by_name.rate_hz, by_name.warnings.len()), (2000.0, 2), "{:?}", by_name.warnings);
}

#[test]
fn the_limit_of_numbers_applies_to_used_columns() {
    for (name, map, used) in [
        ("pcm16.wav", "lateral=#2:1", 96),
        ("pcm16.flac", "lateral=#1+#4", 192),
        ("segments.tdms", "lateral=fx_n,normal=fz:1", 192),
        ("compressed.mat", "lateral=run.forces#2:1,normal=fz_n,time=t", 288),
    ] {
        let limited = |most: usize| {
            let options =
                mapped(map, None).with_rate_hz((name == "compressed.mat").then_some(2000.0));
            read_lab(name, &options.with_most_values(most))
        };
        assert_eq!(limited(used).map(|recording| recording.samples()), Ok(96), "{name}");
        let refused = limited(used - 1).unwrap_err();
        assert!(refused.contains(&format!("more than {} numbers", used - 1)), "{refused}");
    }
}

#[test]
fn damaged_files_are_refused_with_their_place() {
    let bytes = |name: &str| fs::read(folder().join(name)).unwrap();
    let with = |name: &str, at: usize, byte: u8| {
        let mut bytes = bytes(name);
        bytes[at] = byte;
        bytes
    };
    let cut = |name: &str, length: usize| bytes(name)[..length].to_vec();
    for (name, bytes, words) in [
        ("a.mat", with("plain.mat", 126, b'X'), "byte 126: this is no MATLAB 5 header"),
        (
            "a.mat",
            cut("plain.mat", 900),
            "byte 136: a size in the file is wrong (816 bytes where 764 are left)",
        ),
        (
            "a.mat",
            with("compressed.mat", 150, 0xff),
            "byte 136: the file ends or cannot be decompressed here",
        ),
        (
            "a.tdms",
            cut("segments.tdms", 600),
            "segment at byte 0: a segment of 877 bytes begins where 572 are left",
        ),
        (
            "a.tdms",
            with("segments.tdms", 905, b'X'),
            "segment at byte 905: a segment begins with [58, 44, 53, 6d] instead of TDSm",
        ),
        ("a.tdms", with("segments.tdms", 3, b'h'), "give the .tdms file beside it"),
        (
            "a.flac",
            cut("pcm24.flac", 500),
            "sample 0 (counted from 0): the file ends or breaks here",
        ),
        ("a.wav", cut("extensible_float.wav", 1000), "the file ends or breaks at sample 73"),
    ] {
        let error = recording_from_bytes(Path::new(name), &bytes, &ReadOptions::default())
            .unwrap_err()
            .to_string();
        assert!(error.contains(words), "{name}: {error}");
    }
}

#[cfg(feature = "lab-files")]
#[test]
fn what_is_not_read_is_named() {
    for (name, map, words) in [
        ("zstd.parquet", "lateral=fx_n", "zstd.parquet, t_s: it is compressed by ZSTD"),
        ("zstd.feather", "lateral=fx_n", "zstd.feather, t_s: it is compressed by ZSTD"),
        ("split.parquet", "lateral=fx_n", "BYTE_STREAM_SPLIT is not read"),
        (
            "null.parquet",
            "lateral=fx_n",
            "null.parquet, row 2, column \"fx_n\": it is not a number, or empty",
        ),
        (
            "null.feather",
            "lateral=fx_n",
            "null.feather, row 2, column \"fx_n\": it is not a number, or empty",
        ),
        ("plain.arrow", "lateral=surface:1", "plain.arrow, surface: its type is Utf8"),
        ("earliest.h5", "lateral=/run1/fy", "/run1/fx_n, /run1/fz, /run2/deep/forces#1"),
    ] {
        let error = read_lab(name, &mapped(map, Some(2000.0))).unwrap_err();
        assert!(error.contains(words), "{map}: {error}");
    }
}

#[cfg(not(feature = "lab-files"))]
#[test]
fn files_of_readers_that_were_not_built_are_named() {
    for name in [
        "plain.parquet",
        "plain.arrow",
        "stream.arrows",
        "lz4.feather",
        "latest.h5",
        "version73.mat",
    ] {
        let error = read_lab(name, &ReadOptions::default()).unwrap_err();
        assert!(error.contains("build with the feature lab-files"), "{error}");
    }
}

#[test]
fn damage_never_panics() {
    let mut random = 88172645463325252_u64;
    let mut next = move |below: usize| {
        random ^= random << 13;
        random ^= random >> 7;
        random ^= random << 17;
        (random % below as u64) as usize
    };
    for case in cases() {
        let whole = fs::read(folder().join(&case.name)).unwrap();
        let options = [
            ReadOptions::default().with_rate_hz(Some(case.rate_hz.unwrap_or(100.0))),
            mapped(
                &format!("lateral=\"{}\":1", case.columns[0].0),
                Some(case.rate_hz.unwrap_or(100.0)),
            ),
        ];
        for round in 0..400 {
            let mut bytes = whole.clone();
            match round % 4 {
                0 => bytes.truncate(next(whole.len())),
                1 => bytes.splice(next(whole.len())..whole.len(), []).for_each(drop),
                _ => {
                    for _ in 0..=round % 5 {
                        let at = next(bytes.len());
                        bytes[at] = [0, 1, 0x7f, 0x80, 0xff, bytes[at] ^ (1 << next(8))][next(6)];
                    }
                }
            }
            for options in &options {
                let read = recording_from_bytes(Path::new(&case.name), &bytes, options);
                if let Err(error) = read {
                    let text = error.to_string();
                    assert!(text.starts_with(&case.name) && !text.ends_with('\n'), "{text}");
                }
            }
        }
    }
}
