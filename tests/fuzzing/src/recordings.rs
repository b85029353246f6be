//! Recordings, as CSV, WAV and NPY.

use std::path::Path;

use htex_author::recording::{
    ColumnMap, ReadError, ReadOptions, ReadProblem, preview, recording_from_bytes, trace_from_bytes,
};
use htex_author::{
    Averaging, Exploration, Recording, SegmentChoice, SpectrumOptions, Take, TextureSpectrum,
    recording_findings, segment_take,
};
use htex_scene::Trace;

use crate::promise::{finite, sentence};

/// Largest number of samples from which a spectrum is computed.
const MOST: usize = 100_000;

/// Reads a CSV file as a recording, and as a motion.
pub fn csv(input: &[u8]) -> bool {
    let followed = match trace_from_bytes("fuzzed.csv", input) {
        Ok(columns) => {
            follow(&Trace::new(columns));
            true
        }
        Err(error) => refused(&error),
    };
    recording("fuzzed.csv", input, 100.0) || followed
}

/// A WAV file, whose header states a rate.
pub fn wav(input: &[u8]) -> bool {
    recording("fuzzed.wav", input, 2000.0)
}

/// An NPY file, which states no rate, at 1 kHz.
pub fn npy(input: &[u8]) -> bool {
    recording("fuzzed.npy", input, 1000.0)
}

/// Reads a recording, at this rate if it states none, and computes its spectrum.
fn recording(name: &str, input: &[u8], rate_hz: f64) -> bool {
    recording_with(name, input, &ReadOptions::default(), rate_hz)
}

/// Previews a file, as is done before it is read: the map of its columns must be valid.
fn previewed(name: &str, input: &[u8], options: &ReadOptions) {
    match preview(Path::new(name), input, options) {
        Ok(found) if found.map.is_empty() => {}
        Ok(found) => {
            let map = found.map.parse::<ColumnMap>();
            assert!(map.is_ok(), "{map:?}");
        }
        Err(error) => {
            refused(&error);
        }
    }
}

/// The same with options.
pub(crate) fn recording_with(
    name: &str,
    input: &[u8],
    options: &ReadOptions,
    rate_hz: f64,
) -> bool {
    let read = |options: &ReadOptions| recording_from_bytes(Path::new(name), input, options);
    previewed(name, input, options);
    let mut result = read(options);
    let has_no_rate = |error: &ReadError| matches!(error.problem, ReadProblem::NoRate);
    if result.as_ref().is_err_and(has_no_rate) {
        result = read(&options.clone().with_rate_hz(rate_hz));
    }
    match result {
        Ok(recording) => {
            take_spectra(&recording);
            true
        }
        Err(error) => refused(&error),
    }
}

pub(crate) fn refused(error: &ReadError) -> bool {
    sentence(error);
    false
}

fn take_spectra(recording: &Recording) {
    recording.warnings.iter().for_each(sentence);
    let signals = recording.axes.iter().chain(&recording.normal_n);
    for signal in signals.chain(&recording.speed_mm_s) {
        assert_eq!(signal.len(), recording.samples());
        finite("signal", signal.iter().copied());
    }
    if recording.samples() > MOST {
        return;
    }
    recording_findings(recording).iter().for_each(sentence);
    for segments in [SegmentChoice::Auto, SegmentChoice::Sweeps, SegmentChoice::Windows] {
        let options = SpectrumOptions::default().with_segments(segments);
        let take = Take { recording: recording.clone(), given: Exploration::default() };
        let parts = match segment_take(&take, &options, false) {
            Ok(reading) => {
                reading.warnings.iter().chain(&reading.notes).for_each(sentence);
                finite("speed", reading.motion.speed_mm_s);
                finite("force", reading.motion.force_n);
                [reading.spectra]
            }
            Err(error) => {
                sentence(&error);
                continue;
            }
        };
        for averaging in [Averaging::Magnitude, Averaging::Rms, Averaging::Complex] {
            match TextureSpectrum::average(&parts, averaging) {
                Ok(spectrum) => {
                    finite("magnitude", spectrum.magnitude);
                    finite("repeatability", spectrum.repeatability.map(|of| of.band_rms_db));
                    finite("signal", spectrum.signal);
                }
                Err(error) => sentence(&error),
            }
        }
    }
}

/// Reads a trace along its length, and beyond both ends.
fn follow(trace: &Trace) {
    trace.warnings.iter().for_each(sentence);
    let duration_s = trace.duration_s();
    for step in -1..=17 {
        let point = trace.point_at(duration_s * f64::from(step) / 16.0);
        finite("place", [point.x_mm, point.y_mm]);
        finite("speed", [point.speed_mm_s, point.vx_mm_s, point.vy_mm_s]);
        finite("force", [point.force_n]);
        assert!(point.speed_mm_s >= 0.0 && point.force_n >= 0.0, "{point:?}");
    }
}
