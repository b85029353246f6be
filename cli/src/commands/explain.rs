use clap::Args;

use crate::exit::Exit;
use crate::failure::Failure;
use crate::hints::with_hint;
use crate::output::print;
use crate::rules::rules;

/// Explain the code of a finding
///
/// Prints what it means and what to do.
#[derive(Args)]
pub(crate) struct Explain {
    /// The code, as `htex validate` prints it; without a code, all codes are listed
    code: Option<String>,
}

impl Explain {
    pub(crate) fn run(self) -> Result<Exit, Failure> {
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
