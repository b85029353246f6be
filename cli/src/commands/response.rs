use std::collections::BTreeSet;
use std::io::BufWriter;
use std::path::PathBuf;

use clap::{Args, ValueEnum};
use htex_author::recording::{
    ColumnMap, MOST_VALUES, ReadError, ReadOptions, ReadProblem, format_names, read_recording,
};
use htex_lab::response::{
    Estimator, Excitation, HitOptions, MeasuredResponse, Piece, Record, ResponseError,
    ResponseOptions, column_map, measure, response_picture,
};
use serde_json::{Value, json};

use crate::exit::Exit;
use crate::failure::Failure;
use crate::located;
use crate::output::{note, print, print_json, warn, write_file};
use crate::outputs::check_outputs;

/// Measure the frequency response of a recording rig or a finger display.
///
/// From recordings of its input and output: hits of an impact hammer (each is one average; double hits, overloads and hits
/// that are cut off are thrown out and listed), or with --continuous a drive such as noise. Writes the CSV that
/// --frf of the commands for recordings and the `response` of a scene's device take.
#[derive(Args)]
pub(crate) struct Response {
    #[arg(help = format!("The recordings, all of one rate: {}", format_names()))]
    #[arg(value_parser = located::RECORDING, required = true)]
    recordings: Vec<PathBuf>,

    /// The force of the hammer, or the drive of the display: a column by name, number (#1) or path, COLUMN:SCALE, or an
    /// expression. Without a scale in the unit of the file
    #[arg(long, value_name = "COLUMN", allow_hyphen_values = true)]
    input: String,

    /// What the rig or the display makes of it: a column as for --input
    #[arg(long, value_name = "COLUMN", allow_hyphen_values = true)]
    output: String,

    /// Names and scales the time column, if it has no known name: time=stamp_ms:0.001
    #[arg(long, value_name = "MAP")]
    map: Option<String>,

    /// Sampling rate; needed where the file does not say (NPY, CSV without a time column)
    #[arg(long, value_name = "HZ")]
    rate: Option<f64>,

    /// Reads the recordings from this time on, s
    #[arg(long, value_name = "S")]
    from: Option<f64>,

    /// Reads the recordings up to this time, s
    #[arg(long, value_name = "S")]
    to: Option<f64>,

    /// Most numbers of a recording that are kept in memory
    #[arg(long, value_name = "N", default_value_t = MOST_VALUES)]
    most_numbers: usize,

    /// h1: for noise in the output; h2: for noise in the input; hv: for noise in both (total least squares)
    #[arg(long, value_enum, default_value = "h1")]
    estimator: EstimatorArg,

    /// Length of the part of the recording that is transformed, s. The response is on a grid of its inverse; multiples of 0.2
    /// put the 5 Hz of texture spectra on it
    #[arg(long, value_name = "S", default_value_t = 1.0)]
    window: f64,

    /// Lowest frequency, Hz
    #[arg(long, value_name = "HZ", default_value_t = 20.0)]
    low: f64,

    /// Highest frequency, Hz; half of the sampling rate if that is lower
    #[arg(long, value_name = "HZ", default_value_t = 1000.0)]
    high: f64,

    /// Magnitude of the input at which its sensor or amplifier is overloaded. Without it, four equal samples in a row at the
    /// highest or lowest value are an overload
    #[arg(long, value_name = "VALUE")]
    input_limit: Option<f64>,

    /// The same for the output
    #[arg(long, value_name = "VALUE")]
    output_limit: Option<f64>,

    /// The input is a drive without pause (noise, a sweep): windows with half overlap and a Hann window
    #[arg(long, conflicts_with_all = ["pre_trigger", "trigger", "double", "force_window", "exponential"])]
    continuous: bool,

    /// Hits: time before the trigger that is part of the window, s; the mean there is removed [default: 0.02]
    #[arg(long, value_name = "S")]
    pre_trigger: Option<f64>,

    /// Hits: level that starts one, relative to the largest input of the recording [default: 0.1]
    #[arg(long, value_name = "PART")]
    trigger: Option<f64>,

    /// Hits: size of a second contact that makes a double hit, relative to the hit [default: 0.1]
    #[arg(long, value_name = "PART")]
    double: Option<f64>,

    /// Hits: time after the trigger at which the input is faded to zero, s; it removes noise between hits
    #[arg(long, value_name = "S")]
    force_window: Option<f64>,

    /// Hits: time constant of an exponential window on both channels, s; for responses that outlast the window. It raises
    /// their damping by its inverse
    #[arg(long, value_name = "S")]
    exponential: Option<f64>,

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

#[derive(Clone, Copy, ValueEnum)]
enum EstimatorArg {
    H1,
    H2,
    Hv,
}

impl Response {
    pub(crate) fn run(self) -> Result<Exit, Failure> {
        let outputs = [&self.csv, &self.svg].into_iter().flatten();
        let inputs = self.recordings.iter().map(PathBuf::as_path);
        check_outputs(outputs.map(PathBuf::as_path), inputs)?;
        let (records, remarks) = self.read()?;
        let measured = measure(&records, &self.options())?;
        if let Some(csv) = &self.csv {
            let response = measured.setup_response();
            let write = |file: &mut std::fs::File| response.write_csv(&mut BufWriter::new(file));
            htex_format::replace_file(csv, write).map_err(|error| Failure::write(csv, error))?;
        }
        if let Some(svg) = &self.svg {
            let picture = response_picture(&measured, &self.title());
            write_file(svg, picture.as_bytes())?;
        }
        if self.json {
            print_json(&self.summary(&measured, &remarks)?)?;
        } else {
            note(&remarks);
            warn(&measured.warnings);
            print(&text(&measured))?;
        }
        Ok(Exit::SUCCESS)
    }

    /// The records, and what was noticed while reading them, each once.
    fn read(&self) -> Result<(Vec<Record>, Vec<String>), Failure> {
        let others = self
            .map
            .as_deref()
            .map(str::parse::<ColumnMap>)
            .transpose()?;
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
            remarks.extend(findings.map(|finding| format!("{}: {finding}", recording.source)));
            records.push(Record::from_recording(recording)?);
        }
        Ok((records, remarks.into_iter().collect()))
    }

    fn options(&self) -> ResponseOptions {
        let estimator = match self.estimator {
            EstimatorArg::H1 => Estimator::H1,
            EstimatorArg::H2 => Estimator::H2,
            EstimatorArg::Hv => Estimator::Hv,
        };
        let excitation = match self.continuous {
            true => Excitation::Continuous,
            false => Excitation::Hits(self.hit_options()),
        };
        ResponseOptions::default()
            .with_excitation(excitation)
            .with_estimator(estimator)
            .with_window_s(self.window)
            .with_band_hz(self.low, self.high)
            .with_limits(self.input_limit, self.output_limit)
    }

    fn hit_options(&self) -> HitOptions {
        let usual = HitOptions::default();
        let (trigger, double) = (usual.trigger, usual.double);
        let pre_trigger_s = self.pre_trigger.unwrap_or(usual.pre_trigger_s);
        usual
            .with_pre_trigger_s(pre_trigger_s)
            .with_levels(
                self.trigger.unwrap_or(trigger),
                self.double.unwrap_or(double),
            )
            .with_force_window_s(self.force_window)
            .with_exponential_s(self.exponential)
    }

    fn title(&self) -> String {
        format!("{} over {}", self.output, self.input)
    }

    /// The response, with the settings that it was measured by.
    fn summary(&self, measured: &MeasuredResponse, remarks: &[String]) -> Result<Value, Failure> {
        let failed = |error| Failure::Other(format!("cannot write JSON: {error}"));
        let mut summary = serde_json::to_value(measured).map_err(failed)?;
        summary["input"] = json!(self.input);
        summary["output"] = json!(self.output);
        summary["settings"] = serde_json::to_value(self.options()).map_err(failed)?;
        summary["notes"] = json!(remarks);
        Ok(summary)
    }
}

/// An error of the columns names the flags for them, which differ from those of other commands.
fn read_failure(error: ReadError) -> Failure {
    match error.problem {
        ReadProblem::Columns { .. } => {
            let problem = error.to_string();
            ResponseError::Columns { problem }.into()
        }
        _ => error.into(),
    }
}

/// Most windows of a continuous drive that are listed.
const MOST_LISTED: usize = 40;

/// What was used and thrown out, and the result in a few lines.
fn text(measured: &MeasuredResponse) -> String {
    let is_listed =
        |piece: &&Piece| measured.pieces.len() <= MOST_LISTED || piece.thrown_out.is_some();
    let listed = measured.pieces.iter().filter(is_listed).take(MOST_LISTED);
    let lines: String = listed.map(line).collect();
    let thrown_out = measured.pieces.len() - measured.averages;
    let band = [measured.frequency_hz.first(), measured.frequency_hz.last()];
    let [low_hz, high_hz] = band.map(|hz| hz.copied().unwrap_or_default());
    format!(
        "{lines}{} used, {thrown_out} thrown out\n\
         {} of windows of {} s: {low_hz} to {high_hz} Hz in steps of {} Hz\n{}{}",
        measured.averages,
        measured.estimator,
        measured.window_s,
        measured.resolution_hz,
        largest(measured),
        least_coherence(measured),
    )
}

fn line(piece: &Piece) -> String {
    let result = match &piece.thrown_out {
        None => "used".to_owned(),
        Some(reason) => format!("thrown out: {reason}"),
    };
    format!(
        "{:>10.4} s  peak {:>10.4}  {}  {result}\n",
        piece.time_s, piece.peak, piece.file
    )
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
