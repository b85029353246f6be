//! Parsed arguments, with the names of the arguments that the user gave. Defaults and environment
//! variables do not count as given.

use clap::parser::ValueSource;
use clap::{ArgMatches, Args, Command, Error, FromArgMatches};

use crate::failure::Result;

/// Parsed arguments, with the names of the arguments that the user gave.
pub(crate) struct ExplicitArgs<T> {
    pub(crate) values: T,
    /// The names of the given arguments as keywords, e.g. `full_scale` for `--full-scale`.
    pub(crate) settings: Vec<String>,
}

impl<T: Args> ExplicitArgs<T> {
    fn settings_of(matches: &ArgMatches) -> Vec<String> {
        // `command` has only the arguments of `T`. The parsed command may have more.
        let command = T::augment_args(Command::new("explicit"));
        let given = command.get_arguments().filter(|argument| {
            let source = matches.value_source(argument.get_id().as_str());
            source == Some(ValueSource::CommandLine)
        });
        let long = given.filter_map(|argument| argument.get_long());
        long.map(|long| long.replace('-', "_")).collect()
    }
}

impl<T: Args> FromArgMatches for ExplicitArgs<T> {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, Error> {
        Ok(Self { settings: Self::settings_of(matches), values: T::from_arg_matches(matches)? })
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), Error> {
        self.settings = Self::settings_of(matches);
        self.values.update_from_arg_matches(matches)
    }
}

impl<T: Args> Args for ExplicitArgs<T> {
    fn augment_args(command: Command) -> Command {
        T::augment_args(command)
    }

    fn augment_args_for_update(command: Command) -> Command {
        T::augment_args_for_update(command)
    }
}
