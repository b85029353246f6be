use std::path::{Path, PathBuf};

use clap::Args;
use htex_base::files::AtFile;
use htex_base::finding::{Findings, Report};
use htex_lab::study::{check_files, read_study};

use crate::commands::validate::show_reports;
use crate::failure::Result;
use crate::scenes::{ChoiceArgs, SceneArgs};

/// Check a study, its assets and its device; exit status 1 if the study cannot be run.
///
/// Each finding has a stable code (`htex explain CODE`), a severity, and a JSON pointer to its
/// place in the study.
#[derive(Args)]
pub(crate) struct Validate {
    /// The study: study.toml
    study: PathBuf,

    /// Print JSON
    #[arg(long)]
    json: bool,

    #[command(flatten)]
    choice: ChoiceArgs,

    #[command(flatten)]
    with: SceneArgs,
}

impl Validate {
    pub(crate) fn run(self) -> Result {
        let checked = self.check(&self.study);
        show_reports(
            std::iter::once(checked.map(|report| (self.study.as_path(), report))),
            self.json,
            None,
        )
    }

    fn check(&self, path: &Path) -> Result<Report> {
        let bytes = std::fs::read(path).reading(path)?;
        let mut findings = Findings::default();
        let study = read_study(&bytes, &mut findings);
        let mut findings = findings.into_list();
        if let Some(study) = study {
            let rehearsal = self.choice.to_override(None, true)?;
            let loader = self.with.loader()?;
            check_files(&study, path, &loader.around(), &rehearsal, &mut findings)?;
        }
        Ok(Report::new(findings))
    }
}
