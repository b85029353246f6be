use std::ffi::OsString;

use clap::Args;

use crate::exit::Exit;
use crate::failure::Failure;

/// A subcommand that is implemented in the `htex` command of the Python package.
#[derive(Args)]
#[command(disable_help_flag = true)]
pub(crate) struct Elsewhere {
    #[arg(hide = true, trailing_var_arg = true, allow_hyphen_values = true)]
    arguments: Vec<OsString>,
}

impl Elsewhere {
    pub(crate) fn run(self) -> Result<Exit, Failure> {
        let sentence = "this program has no statistics; `pip install htex[lab]` brings a command `htex` that has them, with the same arguments";
        // They are parsed only so that any arguments lead to this sentence.
        drop(self.arguments);
        Err(Failure::Usage(sentence.to_owned()))
    }
}
