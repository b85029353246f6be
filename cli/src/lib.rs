//! The `htex` command as a library: it parses arguments, calls the SDK, and prints. [`run`] is the
//! whole command. The program `htex` and the Python package call it.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
#![forbid(unsafe_code)]

mod assets;
#[cfg(feature = "check")]
mod checking;
mod columns;
mod commands;
mod devices;
mod differences;
#[cfg(feature = "exchange")]
mod explicit_args;
mod failure;
mod findings_format;
mod gains;
mod grid;
mod groups;
#[cfg(feature = "lab")]
mod inputs;
#[cfg(feature = "build")]
mod installed;
mod invocation;
mod keys;
mod located;
mod motions;
#[cfg(not(feature = "schemas"))]
mod no_schemas;
mod output;
mod outputs;
mod playing;
#[cfg(feature = "build")]
mod plugin_registry;
mod plugins;
mod progress;
#[cfg(feature = "check")]
mod project;
mod recording_plot;
mod recordings;
mod report;
#[cfg(feature = "exchange")]
mod scene_sound;
mod scenes;
#[cfg(feature = "schemas")]
mod schemas;
#[cfg(any(feature = "build", feature = "check", feature = "lab"))]
mod shared;
mod signals;
mod signers;
mod wasm_limits;
mod wav;

#[cfg(not(feature = "schemas"))]
use no_schemas as schemas;

use std::ffi::OsString;

use clap::{CommandFactory, FromArgMatches, Parser};
use htex_base::native::folders::relative;
use htex_device_builtin::SOUND;

use commands::Command;
use failure::{Exit, Failure, Result};

/// The output of `htex --version`: the version, and a line each for the commit of the sources, the
/// target and the features of this build. `htex -V` prints only the version.
const LONG_VERSION: &str = concat!(
    env!("CARGO_PKG_VERSION"),
    "\ncommit: ",
    env!("HTEX_COMMIT"),
    "\ntarget: ",
    env!("HTEX_TARGET"),
    "\nfeatures: ",
    env!("HTEX_FEATURES"),
);

/// Fit, inspect, measure and play texture assets for touch.
///
/// `htex fit` turns a recording of a finger sliding over a surface into a `.htex` file of a few
/// kilobytes. The file holds models of the recording's spectrum, and the measured error of each
/// model.
#[derive(Parser)]
#[command(name = "htex", version, long_version = LONG_VERSION, max_term_width = 100, after_help = first_steps())]
struct Cli {
    #[command(subcommand)]
    command: Command,

    /// Print only results and errors: no notes, no warnings, no progress
    #[arg(short, long, global = true, conflicts_with = "verbose")]
    quiet: bool,

    /// Also print how long the command took
    #[arg(short, long, global = true)]
    verbose: bool,
}

/// Returns the command's arguments, with its subcommands in groups.
fn command() -> clap::Command {
    groups::with_groups(Cli::command())
}

fn first_steps() -> String {
    let play = if SOUND.is_built {
        "play it as sound"
    } else {
        "play it (sound needs a build with `--features audio`)"
    };
    format!(
        "\
First steps:
  htex demo out                       try all steps on simulated surfaces
  htex fit rec.csv -o cloth.htex      fit models to your recording
  htex info cloth.htex                show the error of each model
  htex synth cloth.htex -o cloth.wav  play it to a WAV file
  htex play cloth.htex                {play}

Exit status: 0 ok, 1 findings or failure, 2 wrong usage."
    )
}

/// Runs the command and returns its exit status: 0 ok, 1 findings or failure, 2 wrong usage.
///
/// `arguments` begin with the program's name, as in [`std::env::args_os`]. `program` is what starts
/// this command again in another process: a program file, followed by the arguments that come
/// before the command's own, e.g. `python -m htex`. The command starts itself again to check a
/// model or a device, and to hold the output of a display. If `program` is empty, these uses fail
/// with an error.
///
/// The first call installs a Ctrl-C handler for the rest of the process. Only one call may run at a
/// time.
///
/// ```
/// let program = vec![std::env::current_exe()?.into_os_string()];
/// assert_eq!(htex_cli::run(["htex".into(), "--version".into()], program), 0);
/// # Ok::<(), std::io::Error>(())
/// ```
pub fn run(arguments: impl IntoIterator<Item = OsString>, program: Vec<OsString>) -> u8 {
    let arguments: Vec<OsString> = arguments.into_iter().collect();
    let shown = arguments.iter().skip(1).cloned().map(located::without_secrets);
    invocation::set(shown.collect(), program);
    let code = parse_and_run(arguments);
    // A static is never dropped, so its temporary folder has to be removed here.
    located::clear();
    code
}

/// Checks whether the command accepts these arguments, which begin with the program's name. Does
/// not run the command. Tests use this function to check command lines in the documentation.
///
/// ```
/// assert!(htex_cli::check_usage(["htex", "info", "a.htex"].map(Into::into)).is_ok());
/// assert!(htex_cli::check_usage(["htex", "info", "--no-such-flag"].map(Into::into)).is_err());
/// ```
///
/// # Errors
/// Returns the error message that the command would print.
pub fn check_usage(
    arguments: impl IntoIterator<Item = OsString>,
) -> std::result::Result<(), String> {
    match parse(arguments) {
        Err(error) if error.use_stderr() => Err(error.to_string()),
        _ => Ok(()),
    }
}

/// Returns the arguments, and the key that must have signed the textures.
fn parse(
    arguments: impl IntoIterator<Item = OsString>,
) -> Result<(Cli, Option<String>), clap::Error> {
    let mut command = command();
    let matches = command.try_get_matches_from_mut(arguments)?;
    located::check_paths(&command, &matches)?;
    let cli = Cli::from_arg_matches(&matches).map_err(|error| error.format(&mut command))?;
    Ok((cli, signers::given(&matches).cloned()))
}

fn parse_and_run(arguments: Vec<OsString>) -> u8 {
    let began = std::time::Instant::now();
    let (Cli { command, quiet, verbose }, key) = match parse(arguments) {
        Ok(parsed) => parsed,
        Err(error) => {
            // A closed standard output or standard error is not an error of the command.
            let _ = error.print();
            return u8::try_from(error.exit_code()).unwrap_or(Exit::USAGE.code());
        }
    };
    progress::set_quiet(quiet);
    let code = match run_command(command, key.as_deref()) {
        Ok(exit) => exit.code(),
        Err(failure) => {
            let lines = failure.to_lines();
            crate::output::tell!("htex: {}", lines.join("\n"));
            failure.exit().code()
        }
    };
    if verbose {
        crate::output::tell!("note: it took {:.3} s", began.elapsed().as_secs_f64());
    }
    // This function is called last, because it waits until the display's output can no longer have
    // a voltage.
    playing::stay_until_zero();
    code
}

/// Downloads the inputs of a command, runs it, and uploads its outputs.
/// `key` must have signed the textures, if it is given.
fn run_command(command: Command, key: Option<&str>) -> Result {
    // This also resets the meaning of signals, because an earlier command in this process may have
    // changed it.
    signals::handle()?;
    check_folders()?;
    located::download(key)?;
    let exit = command.run()?;
    // The command may have called `signals::ask`. From here on nothing checks for signals, so they
    // end the program again.
    signals::handle()?;
    located::upload()?;
    Ok(exit)
}

/// Refuses a relative path in an environment variable of htex (`HTEX_…`). Only warns about a
/// relative path in a variable that other programs also read, because the XDG base directory
/// specification says to ignore such a path.
fn check_folders() -> Result<()> {
    let mut ignored = Vec::new();
    for (variable, path) in relative() {
        let path = output::shown(&path);
        let problem = format!("{variable} is {path}, which is no absolute path");
        if variable.starts_with("HTEX_") {
            return Err(Failure::Usage(format!(
                "{problem}; give one that begins with / (on Windows with a drive)"
            )));
        }
        ignored.push(format!("{problem}; it is ignored, and the usual folder is used"));
    }
    output::warn(&ignored);
    Ok(())
}
