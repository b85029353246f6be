use std::path::PathBuf;

use clap::Args;
use htex_lab::study::Plan as Planned;

use super::open;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::located;
use crate::output::{print, print_json, write_file};
use crate::outputs::check_outputs;
use crate::shown::shown;

/// Write the order of every participant.
///
/// The order depends only on the study: the same seed gives the same order on every machine.
/// `htex study run` follows it.
#[derive(Args)]
pub(super) struct Plan {
    /// The study: study.toml
    study: PathBuf,

    /// Write the plan as JSON
    #[arg(short, long, value_name = "JSON", value_parser = located::OUTPUT)]
    output: Option<PathBuf>,

    /// Print the plan as JSON
    #[arg(long)]
    json: bool,
}

impl Plan {
    pub(super) fn run(self) -> Result<Exit, Failure> {
        let study = open(&self.study)?;
        let plan = Planned::new(&study);
        if let Some(file) = &self.output {
            check_outputs([file.as_path()], [self.study.as_path()])?;
            let text = serde_json::to_string_pretty(&plan)?;
            write_file(file, (text + "\n").as_bytes())?;
        }
        if self.json {
            print_json(&plan)?;
        } else {
            print(&self.text(&plan, study.trial_s))?;
        }
        Ok(Exit::SUCCESS)
    }

    fn text(&self, plan: &Planned, trial_s: f64) -> String {
        let Some(first) = plan.participants.first() else {
            return String::new();
        };
        let trials = first.training.len() + first.trials.len();
        let mut text = format!(
            "{} participants; each: {} trials of training, {} gains to match, {} trials of testing; {:.0} min of trials\n",
            plan.participants.len(),
            first.training.len(),
            first.gain.len(),
            first.trials.len(),
            trials as f64 * trial_s / 60.0
        );
        match &self.output {
            Some(file) => text += &format!("written to {}\n", shown(file)),
            None => text += "the orders: -o plan.json, or --json\n",
        }
        text
    }
}
