use clap::Args;
use clap_complete::Shell;

use crate::failure::{Exit, Result};
use crate::output::write_bytes;

/// Print a shell completion script
///
/// bash: source it, or keep it as htex in ~/.local/share/bash-completion/completions. zsh: as _htex
/// in a folder of fpath. fish: as htex.fish in ~/.config/fish/completions. PowerShell: at the end
/// of $PROFILE.
#[derive(Args)]
pub(crate) struct Completions {
    /// The shell
    #[arg(value_enum)]
    shell: Shell,
}

impl Completions {
    pub(crate) fn run(self) -> Result {
        // Not to standard output: `generate` panics if it cannot write, e.g. to a closed pipe.
        let mut script = Vec::new();
        clap_complete::generate(self.shell, &mut crate::command(), "htex", &mut script);
        write_bytes(&script)?;
        Ok(Exit::SUCCESS)
    }
}
