use clap::Args;
use htex_device::{Note, Registry};
use serde_json::json;

use crate::adapters::{listed_json, listed_text};
use crate::devices::DeviceArgs;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::output::{print, print_json};
use crate::sources::{SourceArgs, source_json};

/// List all devices and sources: their adapters, what is connected, and what was found but is not used.
///
/// Search order: --device-file, --device-dir, the folders in HTEX_DEVICE_PATH, the
/// user's folder, built in; for sources --source-file, --source-dir, HTEX_SOURCE_PATH and so on. Of two
/// adapters with one id the earlier is used.
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

impl List {
    pub(crate) fn run(self) -> Result<Exit, Failure> {
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

fn texts<A: htex_device::AdapterKind + ?Sized>(all: &Registry<A>) -> impl Iterator<Item = String> {
    all.notes().iter().map(Note::to_string)
}
