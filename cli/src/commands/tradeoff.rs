use std::fmt::{Display, Formatter};
use std::path::{Path, PathBuf};

use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use htex_author::recording::format_names;
use htex_author::simulate::{SimulationOptions, Surface, simulate};
use htex_author::tradeoff::{
    ErrorAxis, Journal, Model, Point, Request, Subject, csv, errors, others, page, sweep,
};
use htex_author::{AuthorError, Exploration, Take};
use htex_base::files::{AtFile, OwnFolder};
use htex_format::{By, Measure};
use htex_host::{LoadedModel, Registry};
use serde::Serialize;

use crate::columns::{Column, cells, headings};
use crate::failure::{Failure, Result};
use crate::invocation::{command_line, tool};
use crate::located;
use crate::output::{OutputFile, show, shown, warn, write_file};
use crate::outputs::check_outputs;
use crate::plugins::{PluginArgs, way};
use crate::progress::bar;
use crate::recordings::RecordingArgs;

/// Measure models' accuracy, size and time
///
/// Fits models to your recordings with many settings, i.e. combinations of the models' options. For
/// each setting, measures the error, the size in bytes and the computing time.
///
/// The command measures each setting on each recording, and computes the medians over all
/// recordings. It writes a page that shows each setting as a point, and writes the same points to a
/// CSV and a JSON file next to the page. To continue an interrupted run, give the same command
/// again.
#[derive(Args)]
pub(crate) struct Tradeoff {
    #[arg(help = format!("Recordings: {}", format_names()))]
    #[arg(required_unless_present = "simulated")]
    recordings: Vec<PathBuf>,

    /// Also measure on the five simulated surfaces of `htex demo`
    #[arg(long)]
    simulated: bool,

    /// Models by short name or id, comma-separated [default: the models that `htex fit` fits by
    /// default]
    #[arg(long, value_delimiter = ',', value_name = "ID,…")]
    only: Vec<String>,

    /// Finish sooner: vary only one option at a time, over its lowest, middle and highest value,
    /// and measure each computing time with fewer runs
    #[arg(long)]
    quick: bool,

    /// The error to show in the pictures, and to minimise in the search for the best settings
    /// (fronts and knees)
    ///
    /// held-out: htex fits a model to every second block of a recording, and plays the model. It
    /// then compares the played samples with the other blocks, in third octaves. A held-out error
    /// of 1 means that the model differs from the recording as much as a second recording of the
    /// same surface does. The other errors compare a model with the recording to which the model
    /// was fitted [default: held-out; third-octave if a recording is too short]
    #[arg(long, value_parser = error_axis())]
    error: Option<ErrorAxis>,

    /// The page to write. The command writes the points to a .csv and a .json file with the same
    /// name
    #[arg(short, long, value_name = "HTML", value_parser = located::LOCAL_OUTPUT)]
    output: PathBuf,

    #[command(flatten)]
    plugins: PluginArgs,

    #[command(flatten)]
    reading: RecordingArgs,

    /// Print JSON instead of a table
    #[arg(long)]
    json: bool,
}

/// Parses an error by the first word of its name, e.g. `third-octave`.
fn error_axis() -> impl TypedValueParser<Value = ErrorAxis> {
    let name = |error: ErrorAxis| error.name().split(' ').next().unwrap_or_default();
    let by_name = move |given: String| ErrorAxis::ALL.into_iter().find(|e| name(*e) == given);
    PossibleValuesParser::new(ErrorAxis::ALL.map(name))
        .map(move |given| by_name(given).unwrap_or_default())
}

impl Tradeoff {
    pub(crate) fn run(self) -> Result {
        let [csv_file, json_file, part_file] =
            ["csv", "json", "part"].map(|e| self.output.with_extension(e));
        if [&csv_file, &json_file, &part_file].contains(&&self.output) {
            return Err(Failure::Usage(format!(
                "-o {}: points go beside it under that name; name a .html file",
                shown(&self.output)
            )));
        }
        let files = self.recordings.iter().chain(self.plugins.files()).map(PathBuf::as_path);
        check_outputs(
            [&*self.output, &csv_file, &json_file, &part_file],
            files.chain(self.reading.inputs()),
        )?;
        let request = Request {
            models: self.models()?,
            quick: self.quick,
            error: self.error,
            // If this path is unknown, any build of this program continues the journal.
            program: std::env::current_exe().unwrap_or_default(),
        };
        let subjects = self.subjects()?;
        let mut journal = Journal::new(&part_file);
        let bar = bar(1);
        let swept = sweep(&subjects, &request, &mut journal, &|done, all, what| {
            bar.set_length(all);
            bar.set_position(done);
            bar.set_message(what.to_owned());
        })?;
        bar.finish_and_clear();
        let tradeoff = htex_author::tradeoff::Tradeoff::new(&tool(), &subjects, swept);
        let json = serde_json::to_vec(&tradeoff)?;
        // This command chose the names of these files, so no link is followed.
        for (file, bytes) in [(&csv_file, csv(&tradeoff).as_bytes()), (&json_file, &json[..])] {
            let (own, name) = OwnFolder::of_file(file).writing(file)?;
            OutputFile::Inside(&own, &name).write(bytes)?;
        }
        write_file(&self.output, page(&tradeoff, &command_line()).as_bytes())?;
        // The journal is discarded last. So if a file cannot be written, the next run can continue
        // from the journal.
        journal.discard()?;
        if !self.json {
            warn(&tradeoff.warnings);
        }
        show(&TradeoffReport { tradeoff, output: &self.output }, self.json)
    }

    /// Returns the requested models, each in all forms that were found (built in, native, WASM).
    fn models(&self) -> Result<Vec<Model>> {
        let registry = self.plugins.registry_quietly()?;
        let mut models: Vec<Model> = Vec::new();
        for model in self.requested(&registry)? {
            let mut found: Vec<&LoadedModel> = registry.all(model.id()).collect();
            found.sort_by_key(|model| way(model.origin()).0);
            let ways = found.into_iter().map(|m| (way(m.origin()).1.to_owned(), m.clone()));
            let mut ways: Vec<(String, LoadedModel)> = ways.collect();
            // The forms are sorted, so equal ones are neighbours. The one that was found first
            // stays.
            ways.dedup_by(|b, a| a.0 == b.0);
            models.push(Model { ways });
        }
        Ok(models)
    }

    fn requested<'a>(&self, registry: &'a Registry) -> Result<Vec<&'a LoadedModel>> {
        if self.only.is_empty() {
            return Ok(registry.by_default().collect());
        }
        let mut models: Vec<&LoadedModel> = Vec::new();
        for name in &self.only {
            let model = registry.find(name)?;
            if !models.iter().any(|m| m.id() == model.id()) {
                models.push(model);
            }
        }
        Ok(models)
    }

    fn subjects(&self) -> Result<Vec<Subject>> {
        let mut takes = self.reading.read(&self.recordings)?;
        if self.simulated {
            takes.extend(simulated()?);
        }
        let options = self.reading.spectrum_options()?;
        let mut subjects: Vec<Subject> = Vec::new();
        for take in &takes {
            let mut subject = Subject::new(take, &options, self.reading.strict())?;
            // Recordings in several folders may have the same file name.
            let same = |s: &&Subject| s.name.split(" #").next() == Some(&subject.name);
            let before = subjects.iter().filter(same).count();
            if before > 0 {
                subject.name += &format!(" #{}", before + 1);
            }
            subjects.push(subject);
        }
        Ok(subjects)
    }
}

/// Simulates the five surfaces as `htex demo` does.
fn simulated() -> Result<Vec<Take>> {
    let take = |surface: Surface| {
        let options = SimulationOptions::new(surface);
        let simulation = simulate(&options).map_err(Failure::other)?;
        let recording = simulation.to_recording(&surface.to_string()).map_err(AuthorError::from)?;
        let given =
            Exploration { speed_mm_s: Some(options.speed_mm_s), force_n: Some(options.force_n) };
        Ok(Take { recording, given })
    };
    Surface::ALL.into_iter().map(take).collect()
}

/// A trade-off, in the form in which the command prints it.
#[derive(Serialize)]
#[serde(transparent)]
struct TradeoffReport<'a> {
    tradeoff: htex_author::tradeoff::Tradeoff,
    #[serde(skip)]
    output: &'a Path,
}

impl Display for TradeoffReport<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let points = self.tradeoff.summary();
        let name = points.first().map_or("", |p| &p.recording);
        let column = |measure| Column::InSample(measure, By::Magnitude);
        let has_column = |m: &Measure| m.row().column.is_some();
        let errors: Vec<Column> = errors().filter(has_column).map(column).collect();
        let others: Vec<Column> = others().filter(has_column).map(column).collect();
        writeln!(
            f,
            "{name}: the front against bytes, by {}\n  bytes  held out{}  below threshold{}  ns/sample  setting",
            self.tradeoff.error,
            headings(&errors),
            headings(&others),
        )?;
        let mut front: Vec<&Point> = points.into_iter().filter(|p| p.on_front).collect();
        front.sort_by_key(|p| p.bytes);
        for p in front {
            let value = |column| match column {
                Column::InSample(measure, by) => Some(p.get(by, measure)),
                Column::HeldOut | Column::HeldOutDb => None,
            };
            writeln!(
                f,
                "  {:>5}  {:>8.2}{}  {:>13.0} %{}  {:>9.1}  {}",
                p.bytes,
                p.held_out_error.unwrap_or(f64::NAN),
                cells(&errors, value),
                100.0 * p.shares.below_threshold,
                cells(&others, value),
                p.ns_per_sample,
                p.name()
            )?;
        }
        for against in ["bytes", "time"] {
            writeln!(f, "\nknees against {against}")?;
            let knees = self.tradeoff.knees.iter();
            for knee in knees.filter(|k| k.recording == name && k.against == against) {
                writeln!(f, "  {}: {}", knee.of, knee.words)?;
            }
        }
        writeln!(f, "\nThe report, with the pictures: {}", shown(self.output))
    }
}
