//! Writers of test files.

use std::fs;
use std::path::PathBuf;

use htex_recording::Recording;
use htex_recording::{ColumnMap, ReadOptions, read_recording};
use tempfile::TempDir;

pub struct Folder(TempDir);

impl Folder {
    pub fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub fn put(&self, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
        let path = self.0.path().join(name);
        fs::write(&path, bytes).unwrap();
        path
    }
}

pub fn at(rate_hz: f64) -> ReadOptions {
    ReadOptions::default().with_rate_hz(rate_hz)
}

pub fn mapped(map: &str, rate_hz: Option<f64>) -> ReadOptions {
    ReadOptions::default().with_rate_hz(rate_hz).with_map(map.parse::<ColumnMap>().unwrap())
}

pub fn read(
    name: &str,
    bytes: impl AsRef<[u8]>,
    options: &ReadOptions,
) -> Result<Recording, String> {
    let folder = Folder::new();
    read_recording(&folder.put(name, bytes), options).map_err(|error| error.to_string())
}

pub fn has_warning(recording: &Recording, words: &str) -> bool {
    recording.warnings.iter().any(|warning| warning.contains(words))
}

pub fn wav(spec: hound::WavSpec, samples: &[f64]) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    let mut writer = hound::WavWriter::new(&mut bytes, spec).unwrap();
    for sample in samples {
        match spec.sample_format {
            hound::SampleFormat::Float => writer.write_sample(*sample as f32).unwrap(),
            hound::SampleFormat::Int => {
                let full_scale = 2_f64.powi(i32::from(spec.bits_per_sample) - 1);
                writer.write_sample((sample * full_scale) as i32).unwrap();
            }
        }
    }
    writer.finalize().unwrap();
    bytes.into_inner()
}

pub fn spec(channels: u16, bits_per_sample: u16) -> hound::WavSpec {
    let sample_format =
        if bits_per_sample == 32 { hound::SampleFormat::Float } else { hound::SampleFormat::Int };
    hound::WavSpec { channels, sample_rate: 44_100, bits_per_sample, sample_format }
}

pub fn npy(header: &str, data: &[u8]) -> Vec<u8> {
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    bytes.extend(data);
    bytes
}

pub fn npy_header(kind: &str, fortran: &str, shape: &str) -> String {
    format!("{{'descr': '{kind}', 'fortran_order': {fortran}, 'shape': {shape}, }}\n")
}
