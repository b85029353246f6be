use clap::Args;
use htex_device::{Note, Registry};
use serde_json::json;

use crate::adapters::{listed_json, listed_text};
use crate::devices::DeviceArgs;
use crate::failure::{Exit, Failure};
use crate::invocation;
use crate::output::{print, print_json};
use crate::sources::{SourceArgs, source_json};

/// List all devices and sources: their adapters, what is connected, and what was found but is not
/// used.
///
/// Search order: --device-file, --device-dir, the folders in HTEX_DEVICE_PATH, the user's folder,
/// built in; for sources --source-file, --source-dir, HTEX_SOURCE_PATH and so on. If two adapters
/// have the same id, the first one found is used.
#[derive(Args)]
pub(crate) struct List {
    #[command(flatten)]
    devices: DeviceArgs,

    #[command(flatten)]
    sources: SourceArgs,

    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// The environment variable that sets how much the OpenXR loader prints. Without it, the loader
/// prints its own errors on a machine without a runtime.
const LOADER_PRINTS: &str = "XR_LOADER_DEBUG";

impl List {
    pub(crate) fn run(self) -> Result<Exit, Failure> {
        match listed_quietly() {
            Some(exit) => Ok(exit),
            None => self.list(),
        }
    }

    fn list(&self) -> Result<Exit, Failure> {
        let devices = self.devices.devices_quietly()?;
        let sources = self.sources.sources_quietly()?;
        if self.json {
            let notes = texts(&devices).chain(texts(&sources));
            print_json(&json!({
                "devices": devices.all().iter().map(listed_json).collect::<Vec<_>>(),
                "sources": sources.all().iter().map(source_json).collect::<Vec<_>>(),
                "notes": notes.collect::<Vec<_>>(),
            }))?;
        } else {
            print(&(listed_text(&devices) + &listed_text(&sources)))?;
        }
        Ok(Exit::SUCCESS)
    }
}

/// Lists in a second process in which the OpenXR loader prints nothing, because a process cannot
/// safely change its own environment. `None` if the user has set what it prints, or in the second
/// process.
fn listed_quietly() -> Option<Exit> {
    if std::env::var_os(LOADER_PRINTS).is_some() {
        return None;
    }
    let mut command = invocation::program().ok()?.command();
    command.args(invocation::arguments()).env(LOADER_PRINTS, "none");
    Some(match command.status().ok()?.code() {
        Some(0) => Exit::SUCCESS,
        Some(code) if code == i32::from(Exit::USAGE.code()) => Exit::USAGE,
        // Also for a process that was ended by a signal, which has no exit code.
        _ => Exit::FAILURE,
    })
}

fn texts<A: htex_device::AdapterKind + ?Sized>(all: &Registry<A>) -> impl Iterator<Item = String> {
    all.notes().iter().map(Note::to_string)
}
