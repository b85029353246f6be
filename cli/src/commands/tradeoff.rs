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
use htex_host::{LoadedModel, Origin, Registry};

use crate::columns::{Column, cells, headings};
use crate::exit::Exit;
use crate::failure::Failure;
use crate::invocation;
use crate::located;
use crate::models::tool;
use crate::output::{Written, print, print_json, warn, write_file};
use crate::outputs::check_outputs;
use crate::plugins::PluginArgs;
use crate::progress::bar;
use crate::recordings::RecordingArgs;
use crate::shown::shown;

/// Measure accuracy against bytes and time
///
/// Sweeps models and their options over your recordings.
///
/// Measures each recording and the medians over all. Writes a page with pictures, and the same
/// points as CSV and JSON next to it. An interrupted sweep continues when the same command is given
/// again.
#[derive(Args)]
pub(crate) struct Tradeoff {
    #[arg(help = format!("Recordings: {}", format_names()))]
    #[arg(required_unless_present = "simulated")]
    recordings: Vec<PathBuf>,

    /// Also measure on the five simulated surfaces of `htex demo`
    #[arg(long)]
    simulated: bool,

    /// Models by short name or id, comma-separated [default: all]
    #[arg(long, value_delimiter = ',', value_name = "ID,…")]
    only: Vec<String>,

    /// Vary one option at a time, only at its ends and middle, with fewer timing runs
    #[arg(long)]
    quick: bool,

    /// The error that pictures, fronts and knees use
    ///
    /// held-out: fit to the odd blocks of a recording, play, and compare with the even blocks in
    /// third octaves, where 1 is as good as a second recording. The other errors compare with the
    /// data of the fit [default: held-out; third-octave if a recording is too short]
    #[arg(long, value_parser = error_axis())]
    error: Option<ErrorAxis>,

    /// The page to write; the points are written next to it as .csv and .json
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

/// Parses an error by the first words of its name, e.g. `third-octave`.
fn error_axis() -> impl TypedValueParser<Value = ErrorAxis> {
    let name = |error: ErrorAxis| error.name().split(' ').next().unwrap_or_default();
    let named = move |given: String| ErrorAxis::ALL.into_iter().find(|e| name(*e) == given);
    PossibleValuesParser::new(ErrorAxis::ALL.map(name))
        .map(move |given| named(given).unwrap_or_default())
}

impl Tradeoff {
    pub(crate) fn run(self) -> Result<Exit, Failure> {
        let [csv_file, json_file, part_file] =
            ["csv", "json", "part"].map(|e| self.output.with_extension(e));
        if [&csv_file, &json_file, &part_file].contains(&&self.output) {
            let output = shown(&self.output);
            let sentence =
                format!("-o {output}: points go beside it under that name; name a .html file");
            return Err(Failure::Usage(sentence));
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
            // If the path is unknown, a journal is continued by every build.
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
        // Their names are ours, so no link is followed.
        for (file, bytes) in [(&csv_file, csv(&tradeoff).as_bytes()), (&json_file, &json[..])] {
            let (own, name) = OwnFolder::of_file(file).writing(file)?;
            Written::Inside(&own, &name).write(bytes)?;
        }
        write_file(&self.output, page(&tradeoff, &command()).as_bytes())?;
        // Last: if a file cannot be written, the next run still continues from the journal.
        journal.discard()?;
        if self.json {
            print_json(&tradeoff)?;
        } else {
            warn(&tradeoff.warnings);
            print(&to_text(&tradeoff, &self.output))?;
        }
        Ok(Exit::SUCCESS)
    }

    /// Returns the requested models, each with all the ways in which it was found.
    fn models(&self) -> Result<Vec<Model>, Failure> {
        let registry = self.plugins.registry_quietly()?;
        let mut models: Vec<Model> = Vec::new();
        for model in self.named(&registry)? {
            let mut found: Vec<&LoadedModel> = registry.all(model.id()).collect();
            found.sort_by_key(|model| way(model.origin()).0);
            let ways = found.into_iter().map(|m| (way(m.origin()).1.to_owned(), m.clone()));
            let mut ways: Vec<(String, LoadedModel)> = ways.collect();
            // They are sorted by way, so equal ways are neighbours. The one that was found first
            // stays.
            ways.dedup_by(|b, a| a.0 == b.0);
            models.push(Model { ways });
        }
        Ok(models)
    }

    fn named<'a>(&self, registry: &'a Registry) -> Result<Vec<&'a LoadedModel>, Failure> {
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

    fn subjects(&self) -> Result<Vec<Subject>, Failure> {
        let mut takes = self.reading.read(&self.recordings)?;
        if self.simulated {
            takes.extend(simulated()?);
        }
        let options = self.reading.spectrum_options()?;
        let mut subjects: Vec<Subject> = Vec::new();
        for take in &takes {
            let mut subject = Subject::new(take, &options, self.reading.strict())?;
            // Several folders contain files of the same name.
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
fn simulated() -> Result<Vec<Take>, Failure> {
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

/// Returns the order and the name of a way to load a model.
fn way(origin: &Origin) -> (u8, &'static str) {
    match origin {
        Origin::Builtin => (0, "built in"),
        Origin::Native(_) => (1, "native"),
        _ => (2, "wasm"),
    }
}

/// Returns the command as the user gave it.
fn command() -> String {
    let arguments =
        invocation::arguments().into_iter().map(|argument| argument.to_string_lossy().into_owned());
    let quoted = arguments.map(|a| if a.contains([' ', '\'']) { format!("{a:?}") } else { a });
    ["htex".to_owned()].into_iter().chain(quoted).collect::<Vec<_>>().join(" ")
}

fn to_text(tradeoff: &htex_author::tradeoff::Tradeoff, output: &Path) -> String {
    let points = tradeoff.summary();
    let name = points.first().map_or("", |p| &p.recording);
    let column = |measure| Column::new(measure, By::Magnitude);
    let has_column = |m: &Measure| m.row().column.is_some();
    let errors: Vec<Column> = errors().filter(has_column).map(column).collect();
    let others: Vec<Column> = others().filter(has_column).map(column).collect();
    let mut text = format!(
        "{name}: the front against bytes, by {}\n  bytes  held out{}  below threshold{}  ns/sample  setting\n",
        tradeoff.error,
        headings(&errors),
        headings(&others),
    );
    let mut front: Vec<&Point> = points.into_iter().filter(|p| p.on_front).collect();
    front.sort_by_key(|p| p.bytes);
    for p in front {
        let of = |column: Column| Some(p.get(By::Magnitude, column.measure()));
        text += &format!(
            "  {:>5}  {:>8.2}{}  {:>13.0} %{}  {:>9.1}  {}\n",
            p.bytes,
            p.held_out_error.unwrap_or(f64::NAN),
            cells(&errors, of),
            100.0 * p.shares.below_threshold,
            cells(&others, of),
            p.ns_per_sample,
            p.name()
        );
    }
    for against in ["bytes", "time"] {
        text += &format!("\nknees against {against}\n");
        for knee in tradeoff.knees.iter().filter(|k| k.recording == name && k.against == against) {
            text += &format!("  {}: {}\n", knee.of, knee.words);
        }
    }
    text + &format!("\nThe report, with the pictures: {}\n", shown(output))
}
