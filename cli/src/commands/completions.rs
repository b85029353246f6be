use clap::Args;
use clap_complete::Shell;

use crate::failure::{Exit, Result};
use crate::output::write_bytes;

/// Print a shell completion script
///
/// For bash, source the script, or save the script as
/// ~/.local/share/bash-completion/completions/htex. For zsh, save the script as _htex in a folder
/// of fpath. For fish, save the script as ~/.config/fish/completions/htex.fish. For PowerShell,
/// append the script to $PROFILE.
#[derive(Args)]
pub(crate) struct Completions {
    /// The shell for which to print the script
    #[arg(value_enum)]
    shell: Shell,
}

impl Completions {
    pub(crate) fn run(self) -> Result {
        // Generated in memory: `generate` panics if it cannot write, e.g. to a closed pipe.
        let mut script = Vec::new();
        clap_complete::generate(self.shell, &mut crate::command(), "htex", &mut script);
        write_bytes(&script)?;
        Ok(Exit::SUCCESS)
    }
}
