use std::fmt::{Display, Formatter};
use std::path::PathBuf;

use clap::Args;
use htex_author::recording::format_names;
use htex_author::{Recording, SegmentedTake, TextureSpectrum, segment_take};
use serde::{Serialize, Serializer};
use serde_json::json;

use super::spectrum::write_spectrum;
use crate::failure::Result;
use crate::located;
use crate::output::{note, show, warn, write_file};
use crate::outputs::check_outputs;
use crate::recording_plot::recording_plot;
use crate::recordings::RecordingArgs;

/// Show the texture spectrum of a recording
///
/// htex cuts the recording into segments of 0.2 s and computes the spectrum of each segment, with a
/// Hann window. If the recording has several axes, htex combines their spectra into one spectrum
/// (by the method DFT321). With --frf, htex divides the spectrum by the frequency response of the
/// rig. Finally, htex averages the spectra of all segments. The result has a magnitude every 5 Hz
/// from 20 to 1000 Hz. A sinusoid of amplitude A at one of these frequencies has the magnitude A.
#[derive(Args)]
pub(crate) struct Process {
    #[arg(help = format!("The recording: {}", format_names()))]
    #[arg(value_parser = located::RECORDING)]
    recording: PathBuf,

    #[command(flatten)]
    reading: RecordingArgs,

    /// Draw the recording as an SVG picture that shows the used and the skipped segments
    #[arg(long, value_name = "SVG", value_parser = located::OUTPUT)]
    svg: Option<PathBuf>,

    /// Print JSON instead of CSV
    #[arg(long)]
    json: bool,
}

impl Process {
    pub(crate) fn run(self) -> Result {
        let inputs = [self.recording.as_path()].into_iter().chain(self.reading.inputs());
        check_outputs(self.svg.as_deref(), inputs)?;
        let take = self.reading.read_one(&self.recording)?;
        let options = self.reading.spectrum_options()?;
        let reading = segment_take(&take, &options, self.reading.strict())?;
        let part = std::slice::from_ref(&reading.spectra);
        let spectrum = TextureSpectrum::average(part, options.averaging)?;
        if let Some(svg) = &self.svg {
            let picture = recording_plot(&take.recording, &reading.spectra.segments).to_svg();
            write_file(svg, picture.as_bytes())?;
        }
        if !self.json {
            warn(&reading.warnings);
            note(&reading.notes);
            note(&[seconds_read(&take.recording, &reading)]);
        }
        show(&RecordingSpectrum { recording: &take.recording, reading, spectrum }, self.json)
    }
}

/// Says whether the segments come from sweeps of the finger or from windows at regular times.
fn origin(reading: &SegmentedTake) -> &'static str {
    if reading.spectra.segments.from_sweeps { "sweeps" } else { "windows" }
}

/// Returns the stretches of the recording that are used, each as its start and end in seconds of
/// the file.
fn stretches_s(recording: &Recording, reading: &SegmentedTake) -> Vec<[f64; 2]> {
    let stretches = reading.spectra.segments.stretches().into_iter();
    stretches.map(|part| [part.start, part.end].map(|at| recording.second(at))).collect()
}

/// Describes the number and position of the segments that are used, and the spread of the motion in
/// them.
fn seconds_read(recording: &Recording, reading: &SegmentedTake) -> String {
    let stretches = stretches_s(recording, reading);
    let named: Vec<String> = stretches.iter().map(|[a, b]| format!("{a:.2}-{b:.2}")).collect();
    let count = reading.spectra.segments.starts.len();
    let mut text =
        format!("{count} segments of 0.2 s from {}, s: {}", origin(reading), named.join(", "));
    let spread = &reading.spread;
    for (spread, what, unit) in
        [(spread.speed_mm_s, "speed", "mm/s"), (spread.force_n, "force", "N")]
    {
        if let Some([low, high]) = spread {
            text += &format!("; {what} {low:.4} to {high:.4} {unit}");
        }
    }
    text
}

/// The spectrum of a recording, and the segments from which it was computed.
struct RecordingSpectrum<'a> {
    recording: &'a Recording,
    reading: SegmentedTake,
    spectrum: TextureSpectrum,
}

impl Serialize for RecordingSpectrum<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Self { recording, reading, spectrum } = self;
        let segments = &reading.spectra.segments;
        json!({
            "rate_hz": recording.rate_hz,
            "segments": spectrum.segments,
            "segments_from": origin(reading),
            "segments_off_target": segments.off_target.len(),
            "sweeps": segments.sweeps.len(),
            "sweeps_cut_off": segments.cut_off,
            "read_s": stretches_s(recording, reading),
            "quantity": spectrum.quantity,
            "unit": spectrum.quantity.unit(),
            "frequency_hz": spectrum.frequency_hz,
            "magnitude": spectrum.magnitude,
            "speed_mm_s": reading.motion.speed_mm_s,
            "speed_spread_mm_s": reading.spread.speed_mm_s,
            "force_n": reading.motion.force_n,
            "force_spread_n": reading.spread.force_n,
            "repeatability_rms_db": spectrum.repeatability_rms_db(),
            "simulated": recording.simulated,
            "findings": reading.findings,
            "warnings": reading.warnings,
        })
        .serialize(serializer)
    }
}

impl Display for RecordingSpectrum<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let TextureSpectrum { quantity, frequency_hz, magnitude, .. } = &self.spectrum;
        write_spectrum(f, *quantity, frequency_hz, magnitude)
    }
}
