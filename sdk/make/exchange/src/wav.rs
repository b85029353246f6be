//! Writes WAV files that drive a voice coil or an amplifier: one channel of 32-bit floats between
//! -1 and 1.

use std::io::Cursor;

use hound::{SampleFormat, WavReader, WavSpec, WavWriter};
use htex_format::Rights;

use crate::error::Fault;

pub(crate) fn to_bytes(samples: &[f64], rate_hz: u32, rights: &Rights) -> Result<Vec<u8>, Fault> {
    let spec = WavSpec {
        channels: 1,
        sample_rate: rate_hz,
        bits_per_sample: 32,
        sample_format: SampleFormat::Float,
    };
    let failed = |error: hound::Error| Fault::whole(error.to_string());
    let mut bytes = Cursor::new(Vec::new());
    let mut wav = WavWriter::new(&mut bytes, spec).map_err(failed)?;
    for sample in samples {
        wav.write_sample(*sample as f32).map_err(failed)?;
    }
    wav.finalize().map_err(failed)?;
    let added = rights.add_to_wav(&mut bytes);
    added.map_err(|error| Fault::whole(error.to_string()))?;
    Ok(bytes.into_inner())
}

/// Reads a file that [`to_bytes`] wrote.
pub(crate) fn from_bytes(bytes: &[u8]) -> Result<Vec<f64>, Fault> {
    let failed = |error: hound::Error| Fault::whole(error.to_string());
    let reader = WavReader::new(bytes).map_err(failed)?;
    let samples = reader.into_samples::<f32>();
    samples.map(|sample| sample.map(f64::from).map_err(failed)).collect()
}
