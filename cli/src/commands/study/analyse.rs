use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

use clap::Args;
use htex_format::{Report, Severity};
use htex_lab::analyse::{Analysis, Checked, Incomplete, Invalid, Ratings, Spectra, analyse};

use crate::exit::Exit;
use crate::failure::Failure;
use crate::located;
use crate::models::tool;
use crate::output::{note, print, print_json, warn, write_file};
use crate::outputs::check_outputs;
use crate::shown::shown;

/// Analyse the ratings of a study, and what was felt.
///
/// Cell means; normality; repeated-measures ANOVA with sphericity and its corrections; Friedman; paired comparisons with Bonferroni's and
/// Holm's corrections, overall and by texture. With --spectra: correlation of felt with recorded spectra, and regression of ratings on
/// differences of energy in 1 to 20 bands. What the data do not allow is named in the notes. Each number has its method beside it.
#[derive(Args)]
pub(crate) struct Analyse {
    /// Ratings: a CSV with the columns participant, texture, model, repetition, rating
    #[arg(long, value_name = "CSV", value_parser = located::RECORDING)]
    ratings: PathBuf,

    /// Felt spectra: a CSV with the columns participant, texture, model, and magnitudes at 20, 25, ..., 1000; lines of the model
    /// `recorded` have the spectra of the real textures
    #[arg(long, value_name = "CSV", value_parser = located::RECORDING)]
    spectra: Option<PathBuf>,

    /// Leave out participants who have not rated every model in every texture, with a warning
    #[arg(long)]
    leave_out_incomplete: bool,

    /// The scale of the ratings, MIN-MAX such as 0-6: ratings outside are errors
    #[arg(long, value_name = "MIN-MAX", value_parser = scale, allow_hyphen_values = true)]
    scale: Option<RangeInclusive<f64>>,

    /// Folder of the results: report.html, analysis.json and tables as CSV
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,

    /// Print JSON (its JSON Schema: `htex schema study-analysis`)
    #[arg(long)]
    json: bool,
}

impl Analyse {
    pub(crate) fn run(self) -> Result<Exit, Failure> {
        let incomplete = match self.leave_out_incomplete {
            true => Incomplete::LeaveOut,
            false => Incomplete::Refuse,
        };
        let bytes = read(&self.ratings)?;
        let ratings = match Ratings::read_on_scale(&bytes, incomplete, self.scale.as_ref()) {
            Ok(ratings) => told(&self.ratings, ratings),
            Err(invalid) => return self.refuse(&self.ratings, invalid),
        };
        let mut spectra = None;
        if let Some(file) = &self.spectra {
            match Spectra::read(&read(file)?, &ratings) {
                Ok(read) => spectra = Some(told(file, read)),
                Err(invalid) => return self.refuse(file, invalid),
            }
        }
        let analysis = analyse(&ratings, spectra.as_ref(), &tool());
        if let Some(folder) = &self.output {
            self.write(folder, &analysis)?;
        }
        if self.json {
            print_json(&analysis)?;
        } else {
            print(&analysis.to_text())?;
        }
        Ok(Exit::SUCCESS)
    }

    /// Reports a table that cannot be analysed.
    fn refuse(&self, file: &Path, invalid: Invalid) -> Result<Exit, Failure> {
        let Invalid { findings } = invalid;
        if !self.json {
            let file = shown(file);
            return Err(Failure::Findings {
                file,
                cannot: "this table cannot be analysed",
                findings,
            });
        }
        let valid = false;
        let report = Report { valid, findings };
        print_json(&report.of_file(&shown(file)))?;
        Ok(Exit::FAILURE)
    }

    /// Writes the report, the tables and the JSON.
    fn write(&self, folder: &Path, analysis: &Analysis) -> Result<(), Failure> {
        let json = serde_json::to_string_pretty(analysis);
        let json = json.map_err(|error| Failure::Other(format!("cannot write JSON: {error}")))?;
        let mut files = vec![("report.html", analysis.to_html(&self.command(folder)))];
        files.push(("analysis.json", json + "\n"));
        files.extend(analysis.to_csv());
        let paths: Vec<PathBuf> = files.iter().map(|(name, _)| folder.join(name)).collect();
        let inputs = std::iter::once(&self.ratings).chain(&self.spectra);
        check_outputs(
            paths.iter().map(PathBuf::as_path),
            inputs.map(PathBuf::as_path),
        )?;
        std::fs::create_dir_all(folder).map_err(|error| Failure::write(folder, error))?;
        for (path, (_, text)) in paths.iter().zip(&files) {
            write_file(path, text.as_bytes())?;
        }
        Ok(())
    }

    /// The command that makes the report again.
    fn command(&self, folder: &Path) -> String {
        let mut words = format!("htex study analyse --ratings {}", shown(&self.ratings));
        if let Some(spectra) = &self.spectra {
            words += &format!(" --spectra {}", shown(spectra));
        }
        if self.leave_out_incomplete {
            words += " --leave-out-incomplete";
        }
        if let Some(scale) = &self.scale {
            words += &format!(" --scale {}-{}", scale.start(), scale.end());
        }
        words + &format!(" -o {}", shown(folder))
    }
}

/// Reads `0-6`; the lower end may be negative.
fn scale(text: &str) -> Result<RangeInclusive<f64>, String> {
    let dash = text.char_indices().skip(1).find(|(_, c)| *c == '-');
    let ends = dash.and_then(|(at, _)| {
        let ends = (text[..at].parse::<f64>(), text[at + 1..].parse::<f64>());
        Some((ends.0.ok()?, ends.1.ok()?))
    });
    let ends = ends.filter(|(low, high)| low < high && low.is_finite() && high.is_finite());
    let (low, high) =
        ends.ok_or_else(|| "it looks like 0-6: the lowest and the highest rating".to_owned())?;
    Ok(low..=high)
}

fn read(file: &Path) -> Result<Vec<u8>, Failure> {
    std::fs::read(file).map_err(|error| Failure::read(file, error))
}

/// Prints the findings of a table, and returns it.
fn told<T>(file: &Path, checked: Checked<T>) -> T {
    let line = |severity: Severity| {
        let of = checked
            .findings
            .iter()
            .filter(move |finding| finding.severity == severity);
        of.map(|finding| format!("{}: {finding}", shown(file)))
            .collect::<Vec<_>>()
    };
    warn(&line(Severity::Warning));
    note(&line(Severity::Info));
    checked.table
}
