use std::collections::BTreeSet;
use std::fmt::{Display, Formatter};
use std::io::BufWriter;
use std::path::PathBuf;

use clap::Args;
use htex_author::recording::{
    ColumnMap, MOST_VALUES, ReadError, ReadOptions, ReadProblem, format_names, read_recording,
};
use htex_base::finding::Notice;
use htex_lab::LabError;
use htex_lab::response::{
    MeasuredResponse, Piece, Record, ResponseSettings, column_map, measure, response_picture,
};
use serde::ser::Error;
use serde::{Serialize, Serializer};
use serde_json::json;

use crate::failure::{Failure, Result};
use crate::located;
use crate::output::{OutputFile, note, show, warn, write_file};
use crate::outputs::check_outputs;

/// Measure the response of a rig or display
///
/// Measures the frequency response of a recording rig or a finger display.
///
/// htex computes the response from recordings of the input and the output. By default, the input is
/// an impact hammer, and htex averages over the hits. It discards double hits, overloaded hits and
/// incomplete hits, and lists the discarded hits. Give --continuous if the input is a continuous
/// drive such as noise.
///
/// With --csv, htex writes the response to a CSV file. To correct recordings for the response of a
/// rig, name this file after --frf in commands such as `htex fit`. To correct playback for the
/// response of a display, name this file in a scene, as the `response` of the device.
#[derive(Args)]
pub(crate) struct Response {
    #[arg(help = format!("The recordings, all of one rate: {}", format_names()))]
    #[arg(value_parser = located::RECORDING, required = true)]
    recordings: Vec<PathBuf>,

    /// Column with the force of the hammer or the drive of the display: COLUMN, COLUMN:SCALE, or an
    /// expression of columns (fx1+fx2). COLUMN is a name, a number (#1) or a path in the file
    /// (/run1/fx). Without SCALE, the values are in the file's own unit
    #[arg(long, value_name = "COLUMN", allow_hyphen_values = true)]
    input: String,

    /// Column with the output of the rig or the display, written as for --input
    #[arg(long, value_name = "COLUMN", allow_hyphen_values = true)]
    output: String,

    /// Name of the time column and its scale to seconds, e.g. time=stamp_ms:0.001; needed if htex
    /// does not recognise the time column by its name
    #[arg(long, value_name = "MAP")]
    map: Option<String>,

    /// Sample rate, Hz; needed if the file does not state it (NPY, CSV without a time column)
    #[arg(long, value_name = "HZ")]
    rate: Option<f64>,

    /// Read the recordings from this time on, s
    #[arg(long, value_name = "S")]
    from: Option<f64>,

    /// Read the recordings up to this time, s
    #[arg(long, value_name = "S")]
    to: Option<f64>,

    /// Largest number of values of one recording that htex keeps in memory
    #[arg(long, value_name = "N", default_value_t = MOST_VALUES)]
    most_numbers: usize,

    #[command(flatten)]
    settings: ResponseSettings,

    /// Where to write the response: CSV with columns frequency_hz,magnitude,phase_rad
    #[arg(short = 'o', long = "csv", value_name = "CSV", value_parser = located::OUTPUT)]
    csv: Option<PathBuf>,

    /// Draw magnitude, phase and coherence as an SVG picture
    #[arg(long, value_name = "SVG", value_parser = located::OUTPUT)]
    svg: Option<PathBuf>,

    /// Print JSON instead of text
    #[arg(long)]
    json: bool,
}

impl Response {
    pub(crate) fn run(self) -> Result {
        let outputs = [&self.csv, &self.svg].into_iter().flatten();
        let inputs = self.recordings.iter().map(PathBuf::as_path);
        check_outputs(outputs.map(PathBuf::as_path), inputs)?;
        let (records, remarks) = self.read()?;
        let measured = measure(&records, &self.settings)?;
        if let Some(csv) = &self.csv {
            let response = measured.setup_response();
            let write = |file: &mut std::fs::File| response.write_csv(&mut BufWriter::new(file));
            OutputFile::Named(csv).replace(write)?;
        }
        if let Some(svg) = &self.svg {
            let picture = response_picture(&measured, &self.title());
            write_file(svg, picture.as_bytes())?;
        }
        if !self.json {
            note(&remarks);
            warn(&measured.warnings);
        }
        show(&ResponseReport { args: &self, measured, remarks }, self.json)
    }

    /// Reads the records. Also returns the notices about them, without duplicates.
    fn read(&self) -> Result<(Vec<Record>, Vec<Notice>)> {
        let others = self.map.as_deref().map(str::parse::<ColumnMap>).transpose()?;
        let map = column_map(&self.input, &self.output, others.as_ref())?;
        let options = ReadOptions::default()
            .with_rate_hz(self.rate)
            .with_map(map)
            .with_from_s(self.from)
            .with_to_s(self.to)
            .with_most_values(self.most_numbers);
        let mut remarks = BTreeSet::new();
        let mut records = Vec::with_capacity(self.recordings.len());
        for file in &self.recordings {
            let recording = read_recording(file, &options).map_err(read_failure)?;
            remarks.extend(recording.warnings.iter().cloned());
            let findings = recording.clock_findings.iter();
            remarks.extend(findings.map(|finding| {
                Notice::new(format!("{}: {finding}", recording.source), finding.hint)
            }));
            records.push(Record::from_recording(recording)?);
        }
        Ok((records, remarks.into_iter().collect()))
    }

    fn title(&self) -> String {
        format!("{} over {}", self.output, self.input)
    }
}

/// A measured response, and the settings of the measurement.
struct ResponseReport<'a> {
    args: &'a Response,
    measured: MeasuredResponse,
    remarks: Vec<Notice>,
}

impl Serialize for ResponseReport<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Self { args, measured, remarks } = self;
        // Converted to a map, because a map lists its keys in alphabetical order.
        let mut summary = serde_json::to_value(measured).map_err(S::Error::custom)?;
        // Indexing inserts a key. It cannot panic, because a struct is always a JSON object.
        summary["input"] = json!(args.input);
        summary["output"] = json!(args.output);
        summary["settings"] = args.settings.resolved();
        summary["notes"] = json!(remarks);
        summary.serialize(serializer)
    }
}

/// Converts an error about columns so that it names the flags of this command. Other commands have
/// other flags for columns.
fn read_failure(error: ReadError) -> Failure {
    match error.problem {
        ReadProblem::Columns { .. } => {
            let problem = error.to_string();
            LabError::Columns { problem }.into()
        }
        _ => error.into(),
    }
}

/// Maximum number of windows of a continuous drive that are listed.
const MOST_LISTED: usize = 40;

impl Display for ResponseReport<'_> {
    /// Summarises in a few lines what was used, what was discarded, and the result.
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let MeasuredResponse { pieces, averages, frequency_hz, .. } = &self.measured;
        let is_listed = |piece: &&Piece| pieces.len() <= MOST_LISTED || piece.thrown_out.is_some();
        for piece in pieces.iter().filter(is_listed).take(MOST_LISTED) {
            f.write_str(&line(piece))?;
        }
        let thrown_out = pieces.len() - averages;
        let [low_hz, high_hz] =
            [frequency_hz.first(), frequency_hz.last()].map(|hz| hz.copied().unwrap_or_default());
        write!(
            f,
            "{averages} used, {thrown_out} thrown out\n\
             {} of windows of {} s: {low_hz} to {high_hz} Hz in steps of {} Hz\n{}{}",
            self.measured.estimator,
            self.measured.window_s,
            self.measured.resolution_hz,
            largest(&self.measured),
            least_coherence(&self.measured),
        )
    }
}

fn line(piece: &Piece) -> String {
    let result = match &piece.thrown_out {
        None => "used".to_owned(),
        Some(reason) => format!("thrown out: {reason}"),
    };
    format!("{:>10.4} s  peak {:>10.4}  {}  {result}\n", piece.time_s, piece.peak, piece.file)
}

fn largest(measured: &MeasuredResponse) -> String {
    match &measured.peak {
        None => "the magnitude is largest at an edge of the band\n".to_owned(),
        Some(peak) => format!(
            "largest magnitude {:.5} ({:.2} dB) at {:.2} Hz, between the points of the grid by a parabola in 1/magnitude²\n",
            peak.magnitude, peak.magnitude_db, peak.frequency_hz
        ),
    }
}

fn least_coherence(measured: &MeasuredResponse) -> String {
    let both = measured.coherence.iter().zip(&measured.frequency_hz);
    let least = both.min_by(|(a, _), (b, _)| a.total_cmp(b));
    let least =
        least.map(|(coherence, hz)| format!("lowest coherence {coherence:.4}, at {hz} Hz\n"));
    least.unwrap_or_default()
}
