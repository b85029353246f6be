use std::fmt::{Display, Formatter};
use std::path::{Path, PathBuf};

use clap::Args;
use htex_lab::study::Plan as Planned;
use serde::Serialize;

use super::open;
use crate::failure::Result;
use crate::located;
use crate::output::{show, shown, write_file};
use crate::outputs::check_outputs;

/// Write the order of the trials of every participant.
///
/// The order depends only on the study and its seed, and is the same on every machine.
/// `htex study run` follows this order.
#[derive(Args)]
pub(crate) struct Plan {
    /// The study: study.toml
    study: PathBuf,

    /// Write the plan to this file, as JSON
    #[arg(short, long, value_name = "JSON", value_parser = located::OUTPUT)]
    output: Option<PathBuf>,

    /// Print the plan as JSON
    #[arg(long)]
    json: bool,
}

impl Plan {
    pub(crate) fn run(self) -> Result {
        let study = open(&self.study)?;
        let plan = Planned::new(&study);
        if let Some(file) = &self.output {
            check_outputs([file.as_path()], [self.study.as_path()])?;
            let text = serde_json::to_string_pretty(&plan)?;
            write_file(file, (text + "\n").as_bytes())?;
        }
        show(
            &PlanReport { plan, output: self.output.as_deref(), trial_s: study.trial_s },
            self.json,
        )
    }
}

/// A plan, in the form in which the command prints it.
#[derive(Serialize)]
#[serde(transparent)]
struct PlanReport<'a> {
    plan: Planned,
    #[serde(skip)]
    output: Option<&'a Path>,
    #[serde(skip)]
    trial_s: f64,
}

impl Display for PlanReport<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let Some(first) = self.plan.participants.first() else {
            return Ok(());
        };
        let trials = first.training.len() + first.trials.len();
        writeln!(
            f,
            "{} participants; each: {} trials of training, {} gains to match, {} trials of testing; {:.0} min of trials",
            self.plan.participants.len(),
            first.training.len(),
            first.gain.len(),
            first.trials.len(),
            trials as f64 * self.trial_s / 60.0
        )?;
        match self.output {
            Some(file) => writeln!(f, "written to {}", shown(file)),
            None => writeln!(f, "the orders: -o plan.json, or --json"),
        }
    }
}
