use clap::Args;
use htex_format::{RULES, Rule, explain};

use crate::exit::Exit;
use crate::failure::Failure;
use crate::flags::{of_check, of_code, with};
use crate::output::print;

/// Explain a finding's code: what it means and what to do.
#[derive(Args)]
pub(crate) struct Explain {
    /// The code, as `htex validate` prints it; without one, all codes are listed
    code: Option<String>,
}

/// The rules for experiments, where this program has them.
fn lab_rules() -> impl Iterator<Item = &'static Rule> {
    #[cfg(feature = "lab")]
    let all: &[Rule] = htex_lab::study::RULES;
    #[cfg(not(feature = "lab"))]
    let all: &[Rule] = &[];
    all.iter()
}

impl Explain {
    pub(crate) fn run(self) -> Result<Exit, Failure> {
        let Some(code) = self.code else {
            let lines = RULES
                .iter()
                .chain(htex_library::RULES)
                .chain(htex_scene::RULES)
                .chain(htex_author::findings::RULES)
                .chain(lab_rules())
                .map(|rule| format!("{:36} {}\n", rule.code, rule.summary));
            print(&lines.collect::<String>())?;
            return Ok(Exit::SUCCESS);
        };
        let code = code.to_uppercase();
        let rule = explain(&code)
            .or_else(|| htex_library::explain(&code))
            .or_else(|| htex_scene::explain(&code))
            .or_else(|| htex_author::findings::explain(&code))
            .or_else(|| lab_rules().find(|rule| rule.code == code));
        let rule = rule.ok_or_else(|| {
            Failure::Usage(format!("no code `{code}`; `htex explain` lists them all"))
        })?;
        print(&format!(
            "{}: {}\n\n{}\n\nWhat to do: {}\n",
            rule.code,
            rule.summary,
            with(rule.explanation, of_check(rule.code)),
            with(rule.fix, of_code(rule.code))
        ))?;
        Ok(Exit::SUCCESS)
    }
}
