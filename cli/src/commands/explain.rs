use clap::Args;
use htex_base::finding::Rule;

use crate::failure::{Exit, Failure, Result, with_hint};
use crate::output::print;

/// All rules of this program, grouped by subject.
const TABLES: &[&[Rule]] = &[
    htex_format::RULES,
    htex_format::library::RULES,
    htex_scene::RULES,
    htex_author::findings::RULES,
    #[cfg(feature = "build")]
    htex_build::RULES,
    #[cfg(feature = "lab")]
    htex_lab::study::RULES,
];

pub(crate) fn rules() -> impl Iterator<Item = &'static Rule> {
    TABLES.iter().copied().flatten()
}

/// Explain the code of a finding
///
/// A finding is an error, a warning or a note about a file, e.g. from `htex validate`. The command
/// prints what the finding means and what to do about it.
#[derive(Args)]
pub(crate) struct Explain {
    /// The code of the finding, as `htex validate` prints it. Without a code, the command lists all
    /// codes
    code: Option<String>,
}

impl Explain {
    pub(crate) fn run(self) -> Result {
        let Some(code) = self.code else {
            let lines = rules().map(|rule| format!("{:36} {}\n", rule.code, rule.summary));
            print(&lines.collect::<String>())?;
            return Ok(Exit::SUCCESS);
        };
        let code = code.to_uppercase();
        let unknown = || Failure::Usage(format!("no code `{code}`; `htex explain` lists them all"));
        let rule = rules().find(|rule| rule.code == code).ok_or_else(unknown)?;
        print(&format!(
            "{}: {}\n\n{}\n\nWhat to do: {}\n",
            rule.code,
            rule.summary,
            with_hint(rule.explanation, rule.checked_by),
            with_hint(rule.fix, rule.hint)
        ))?;
        Ok(Exit::SUCCESS)
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn every_code_is_that_of_one_rule() {
        let codes: BTreeSet<&str> = rules().map(|rule| rule.code).collect();
        assert_eq!(codes.len(), rules().count());
    }
}
