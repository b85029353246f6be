//! Recordings as WAV: one to three channels, integer or float.

use hound::{SampleFormat, WavReader, WavSpec};

use super::blocks::Blocks;
use super::{ReadError, ReadOptions, assumption, from_channels, refuse_map};
use crate::recording::Recording;

/// Reads a WAV file, sample by sample.
pub(crate) fn read(blocks: Blocks<'_>, options: &ReadOptions) -> Result<Recording, ReadError> {
    let file = blocks.file;
    refuse_map(file, options)?;
    let limit = blocks.limit;
    let reader = WavReader::new(blocks.rest()?)
        .map_err(|error| broken(file, format!("not a readable WAV file: {error}")))?;
    let spec = reader.spec();
    check(file, spec, options)?;
    limit.check(file, reader.len().into())?;
    let channels = match spec.sample_format {
        SampleFormat::Float => collect(
            file,
            spec,
            reader.into_samples::<f32>().map(|s| s.map(f64::from)),
        ),
        SampleFormat::Int => {
            let full_scale = libm::exp2(f64::from(spec.bits_per_sample) - 1.0);
            collect(
                file,
                spec,
                reader
                    .into_samples::<i32>()
                    .map(|s| s.map(|s| f64::from(s) / full_scale)),
            )
        }
    }?;
    let mut recording = from_channels(file, f64::from(spec.sample_rate), channels, options)?;
    if options.scale.is_none() {
        recording.warnings.push(assumption(
            spec.sample_format == SampleFormat::Int,
            options.quantity,
        ));
    }
    Ok(recording)
}

fn check(file: &str, spec: WavSpec, options: &ReadOptions) -> Result<(), ReadError> {
    if !(1..=3).contains(&spec.channels) {
        return Err(broken(
            file,
            format!(
                "{} channels; give 1 (lateral), 2 (lateral x, y), 3 (x, y, normal), or up to 3 axes of a motion",
                spec.channels
            ),
        ));
    }
    let own = f64::from(spec.sample_rate);
    match options.rate_hz {
        Some(rate) if rate != own => Err(ReadError::Option {
            file: file.to_owned(),
            option: "rate_hz",
            problem: format!(
                "the file has {own} Hz, the given sample rate is {rate} Hz; leave it out or correct the file's header"
            ),
        }),
        _ => Ok(()),
    }
}

/// Distributes the interleaved samples to their channels.
fn collect(
    file: &str,
    spec: WavSpec,
    samples: impl Iterator<Item = hound::Result<f64>>,
) -> Result<Vec<Vec<f64>>, ReadError> {
    let count = usize::from(spec.channels);
    let mut channels = vec![Vec::new(); count];
    for (position, sample) in samples.enumerate() {
        let frame = position / count;
        let sample = sample.map_err(|error| {
            broken(file, format!("the file ends or breaks at sample {frame} (counted from 0): {error}; copy it again"))
        })?;
        channels[position % count].push(sample);
    }
    Ok(channels)
}

fn broken(file: &str, problem: String) -> ReadError {
    ReadError::Wav {
        file: file.to_owned(),
        problem,
    }
}
