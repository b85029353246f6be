use std::num::NonZero;
use std::path::PathBuf;
use std::time::Duration;

use clap::Args;
use htex_check::conformance::{Class, CommandLine, ConformanceError, Options, Part, run};

use crate::failure::{Exit, Failure, Result};
use crate::located;
use crate::output::{print, print_json, write_file};
use crate::shared;
use crate::signals;

/// Largest time limit of a run, seconds: a day.
const MOST_SECONDS: f64 = 86_400.0;

/// Run a reader on the conformance files; exit status 1 if something differs
///
/// Prints a table. The rows of the table are the conformance classes: validator, reader and player.
/// A validator reports every mistake in a file, with the mistake's code and place. A reader accepts
/// valid files and refuses invalid ones. A player computes the numbers with which a texture is
/// played, such as its level. The columns of the table are the kinds of files. Above the table, the
/// command lists each file for which the reader's answer is wrong, and how this answer differs from
/// the correct one.
///
/// Each run of the reader has a time limit and may print at most 16 MiB. When a run ends, htex also
/// ends all processes that the reader started and that still run.
#[derive(Args)]
pub(crate) struct Run {
    /// Command line of the reader. No shell interprets the command line. Put an argument that
    /// contains spaces between quotation marks. {file} stands for the file, {part} for the kind of
    /// file (assets, libraries, …), and {options} for the limits and arguments as JSON. Without
    /// {options}, the few files that need options are left out
    #[arg(long, value_name = "COMMAND", value_parser = command_line)]
    command: CommandLine,

    /// Folder with the conformance files, the folder `spec` of the sources [default:
    /// $HTEX_CONFORMANCE, or ../share/htex/conformance relative to the command]
    #[arg(long, value_name = "DIR")]
    files: Option<PathBuf>,

    /// Kinds of files: assets, libraries, scenes, recordings, baked, playing, comma-separated
    /// [default: all]
    #[arg(long, value_name = "PART,…", value_delimiter = ',')]
    part: Vec<Part>,

    /// Classes to count: validator, reader, player, comma-separated [default: all]
    #[arg(long, value_name = "CLASS,…", value_delimiter = ',')]
    class: Vec<Class>,

    /// Time limit of each run, s
    #[arg(long, default_value_t = 30.0, value_name = "S")]
    timeout: f64,

    /// Number of readers that run at the same time
    #[arg(long, default_value = "1", value_name = "N")]
    jobs: NonZero<u16>,

    /// Also write a badge (SVG) with the number of tests that pass
    #[arg(long, value_name = "FILE", value_parser = located::OUTPUT)]
    badge: Option<PathBuf>,

    /// Print the table and the differences as Markdown
    #[arg(long, conflicts_with = "json")]
    markdown: bool,

    /// Print JSON
    #[arg(long)]
    json: bool,
}

fn command_line(text: &str) -> Result<CommandLine, ConformanceError> {
    text.parse()
}

impl Run {
    pub(crate) fn run(self) -> Result {
        let seconds = self.timeout;
        if !(seconds > 0.0 && seconds <= MOST_SECONDS) {
            let problem = format!("--timeout {seconds}: seconds, more than 0, at most a day");
            return Err(Failure::Usage(problem));
        }
        let mut options = Options::new(shared::conformance(self.files)?);
        options.time_limit = Duration::from_secs_f64(seconds);
        options.jobs = self.jobs.into();
        if !self.part.is_empty() {
            options.parts = self.part;
        }
        if !self.class.is_empty() {
            options.classes = self.class;
        }
        // After a signal, htex first ends the readers, because they are not in this program's
        // process group.
        signals::ask();
        let report = run(&self.command, &options, &signals::interrupted).map_err(failed)?;
        signals::handle()?;
        if let Some(badge) = &self.badge {
            write_file(badge, report.to_badge().as_bytes())?;
        }
        if self.json {
            print_json(&report)?;
        } else if self.markdown {
            print(&report.to_markdown())?;
        } else {
            print(&report.to_string())?;
        }
        Ok(Exit::ok_if(report.passed))
    }
}

fn failed(error: ConformanceError) -> Failure {
    match error {
        ConformanceError::Command { .. } | ConformanceError::Files { .. } => Failure::usage(error),
        other => Failure::other(other),
    }
}
