use clap::Args;
use htex_device::{Devices, KnownDevice};
use htex_format::plain;
use serde_json::{Value, json};

use crate::devices::DeviceArgs;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::output::{print, print_json, tamed};

/// List all devices: their adapters, what is connected, and what was found but is not used.
///
/// Search order: --device-file, --device-dir, the folders in HTEX_DEVICE_PATH, the
/// user's folder, built in. Of two adapters with one id the earlier is used.
#[derive(Args)]
pub(crate) struct List {
    #[command(flatten)]
    devices: DeviceArgs,

    /// Print JSON
    #[arg(long)]
    json: bool,
}

impl List {
    pub(crate) fn run(self) -> Result<Exit, Failure> {
        let devices = self.devices.devices_quietly()?;
        if self.json {
            print_json(&json(&devices))?;
        } else {
            print(&text(&devices))?;
        }
        Ok(Exit::SUCCESS)
    }
}

fn json(devices: &Devices) -> Value {
    let all: Vec<Value> = devices.all().iter().map(device_json).collect();
    let notes: Vec<String> = devices.notes().iter().map(ToString::to_string).collect();
    json!({ "devices": all, "notes": notes })
}

/// A missing driver is reported beside the adapter and is not an error.
fn device_json(known: &KnownDevice) -> Value {
    let descriptor = known.descriptor();
    let (endpoints, problem) = match known.adapter.endpoints() {
        Ok(endpoints) => (endpoints, None),
        Err(error) => (Vec::new(), Some(error.to_string())),
    };
    let mut device = json!({
        "id": descriptor.id,
        "name": descriptor.name,
        "version": descriptor.version,
        "summary": descriptor.summary,
        "origin": known.origin.to_string(),
        "settings": descriptor.settings,
        "profiles": descriptor.profiles,
        "endpoints": endpoints,
    });
    if let (Some(problem), Some(device)) = (problem, device.as_object_mut()) {
        device.insert("problem".to_owned(), problem.into());
    }
    device
}

fn text(devices: &Devices) -> String {
    let mut text: String = devices.all().iter().map(device_text).collect();
    for note in devices.notes() {
        text += &format!("note: {}\n", plain(&note.to_string()));
    }
    text
}

fn device_text(known: &KnownDevice) -> String {
    let descriptor = &tamed(known.descriptor());
    let (name, version) = (descriptor.short_name(), &descriptor.version);
    let mut text = format!(
        "  {name:8} {version:8} {:20} {}\n",
        descriptor.id, known.origin
    );
    text += &format!("           {}\n", descriptor.summary);
    match known.adapter.endpoints() {
        Ok(endpoints) => {
            for there in endpoints.iter().map(tamed) {
                let choice = format!("{}={}", there.setting, there.name);
                text += &format!("           {choice}  {}\n", there.summary);
            }
        }
        Err(error) => text += &format!("           not usable here: {error}\n"),
    }
    text
}
