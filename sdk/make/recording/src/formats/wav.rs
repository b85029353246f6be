//! Reader of WAV: integer or float samples of any number of channels.

use std::io::BufReader;

use hound::{SampleFormat, WavReader};

use crate::error::{Fault, ReadProblem};
use crate::formats::samples::{Order, Samples, channel_names};
use crate::input::InputFile;
use crate::sheet::Layout;
use crate::value_limit::ValueLimit;

/// Opens a WAV file. Its samples are read one by one later.
pub(crate) fn open(opened: InputFile<'_>, limit: ValueLimit) -> Result<Samples<'_>, Fault> {
    let reader = WavReader::new(BufReader::new(opened.stream()))
        .map_err(|error| broken(format!("not a readable WAV file: {error}")))?;
    let spec = reader.spec();
    let width = usize::from(spec.channels);
    if width == 0 {
        return Err(broken("the header says 0 channels; export it again".into()));
    }
    let are_integers = spec.sample_format == SampleFormat::Int;
    let frames = reader.len() / u32::from(spec.channels);
    let columns = channel_names(width);
    let placed = move |(position, sample): (usize, hound::Result<f64>)| {
        sample.map_err(|error| {
            let frame = position / width;
            let problem = format!(
                "the file ends or breaks at sample {frame} (counted from 0): {error}; copy it again"
            );
            broken(problem)
        })
    };
    Ok(Samples {
        columns,
        rate_hz: Some(f64::from(spec.sample_rate)),
        layout: Layout::Channels { are_integers },
        frames: Some(frames.into()),
        limit,
        order: Order::Interleaved,
        samples: if are_integers {
            // Samples are signed, so one bit is the sign.
            let full_scale = libm::exp2(f64::from(spec.bits_per_sample) - 1.0);
            let samples = reader.into_samples::<i32>();
            let fractions = samples.map(move |s| s.map(|s| f64::from(s) / full_scale));
            Box::new(fractions.enumerate().map(placed))
        } else {
            let samples = reader.into_samples::<f32>();
            Box::new(samples.map(|s| s.map(f64::from)).enumerate().map(placed))
        },
    })
}

fn broken(problem: String) -> Fault {
    ReadProblem::Invalid(problem).into()
}
