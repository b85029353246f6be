//! The `htex` command: parses, calls the SDK, prints.
#![forbid(unsafe_code)]

mod assets;
mod checking;
mod commands;
mod devices;
mod failure;
mod flags;
mod gains;
mod guardian;
mod metadata;
mod models;
mod motions;
#[cfg(not(feature = "schemas"))]
mod no_schemas;
mod output;
mod outputs;
mod playing;
mod plugins;
mod progress;
mod recording_plot;
mod recordings;
mod report;
mod scenes;
mod schemas;
mod shown;
mod signals;
mod wasm_limits;
mod wav;

use std::process::ExitCode;

use clap::Parser;

use commands::Command;

/// Texture assets for touch: fit, inspect, measure and play them.
///
/// Turns a recording of a finger sliding over a surface into a `.htex` file of a few hundred bytes,
/// with models of its spectrum and the measured error of each.
#[derive(Parser)]
#[command(name = "htex", version, max_term_width = 100, after_help = first_steps())]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

fn first_steps() -> String {
    let play = if cfg!(feature = "audio") {
        "play it by ear, or on a device"
    } else {
        "play it on a device (--device); by ear only in a build with `--features audio`"
    };
    format!(
        "\
First steps:
  htex demo out                       simulate five surfaces, fit all models, write out/report.html
  htex fit rec.csv -o cloth.htex      fit all models to a recording of yours
  htex info cloth.htex                what the file holds, and how good it is
  htex synth cloth.htex -o cloth.wav  play it to a file
  htex play cloth.htex                {play}

Exit status: 0 ok, 1 findings or failure, 2 wrong usage."
    )
}

fn main() -> ExitCode {
    let command = Cli::parse().command;
    match signals::handle().and_then(|()| command.run()) {
        Ok(code) => code,
        Err(failure) => {
            let lines = failure.to_lines();
            crate::output::tell!("htex: {}", lines.join("\n"));
            failure.exit_code()
        }
    }
}
