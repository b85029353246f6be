use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;
use htex_author::{TextureSpectrum, exploration, segment_spectra};
use serde_json::json;

use crate::failure::Failure;
use crate::output::{print, print_json, warn};
use crate::recordings::RecordingArgs;

/// Show the texture spectrum of a recording.
///
/// Segments of 0.2 s, Hann-windowed, two axes folded into one (DFT321), divided by the setup's
/// response if there is one, averaged, 20 to 1000 Hz in steps of 5 Hz. A sinusoid of A newtons on
/// that grid reads A.
#[derive(Args)]
pub(crate) struct Process {
    /// The recording: CSV, WAV or NPY
    recording: PathBuf,

    #[command(flatten)]
    reading: RecordingArgs,

    /// Print JSON instead of CSV
    #[arg(long)]
    json: bool,
}

impl Process {
    pub(crate) fn run(self) -> Result<ExitCode, Failure> {
        let take = self.reading.read_one(&self.recording)?;
        let options = self.reading.spectrum_options()?;
        let mut warnings = take.recording.warnings.clone();
        let part = segment_spectra(&take.recording, &options)?;
        warnings.extend(part.warnings.iter().cloned());
        let strict = self.reading.strict();
        let segments = &part.segments;
        let found = exploration(&take.recording, segments, take.given, strict, &mut warnings)?;
        let from_sweeps = segments.from_sweeps;
        let spectrum = TextureSpectrum::average(&[part], options.averaging)?;
        if self.json {
            print_json(&json!({
                "rate_hz": take.recording.rate_hz,
                "segments": spectrum.segments,
                "segments_from": if from_sweeps { "sweeps" } else { "windows" },
                "frequency_hz": spectrum.frequency_hz,
                "magnitude_n": spectrum.magnitude_n,
                "speed_mm_s": found.speed_mm_s,
                "force_n": found.force_n,
                "repeatability_rms_db": spectrum.repeatability_rms_db,
                "simulated": take.recording.simulated,
                "warnings": warnings,
            }))?;
        } else {
            warn(&warnings);
            let rows = spectrum.frequency_hz.iter().zip(&spectrum.magnitude_n);
            let rows: String = rows.map(|(f, m)| format!("{f},{m:.9}\n")).collect();
            print(&format!("frequency_hz,magnitude_n\n{rows}"))?;
        }
        Ok(ExitCode::SUCCESS)
    }
}
