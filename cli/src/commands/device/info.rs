use clap::Args;
use htex_device::{Capabilities, Mapping};
use serde_json::json;

use crate::adapters::descriptor_text;
use crate::devices::{DeviceArgs, SettingArgs};
use crate::failure::{Exit, Failure};
use crate::output::{print, print_json, tamed};

/// Show a device's settings and profiles, what it makes of the samples, and its capabilities with
/// these settings.
#[derive(Args)]
pub(crate) struct Info {
    /// The device, by short name, id or library file
    #[arg(value_name = "FILE|ID")]
    device: String,

    #[command(flatten)]
    devices: DeviceArgs,

    #[command(flatten)]
    settings: SettingArgs,

    /// Print JSON
    #[arg(long)]
    json: bool,
}

impl Info {
    pub(crate) fn run(self) -> Result<Exit, Failure> {
        let known = self.devices.named(&self.device)?;
        let descriptor = known.descriptor();
        let resolved = self.settings.resolve(known.adapter.as_ref());
        let capabilities = resolved.and_then(|s| Ok(known.adapter.capabilities(&s)?));
        if self.json {
            let (can, problem) = match capabilities {
                Ok(capabilities) => (Some(capabilities), None),
                Err(problem) => (None, Some(problem.to_string())),
            };
            let origin = known.origin.to_string();
            print_json(&json!({ "descriptor": descriptor, "origin": origin,
                "capabilities": can, "problem": problem }))?;
        } else {
            let can = match capabilities {
                Ok(capabilities) => can_text(&capabilities),
                Err(problem) => format!("  not known, set so: {problem}\n"),
            };
            let descriptor = tamed(descriptor);
            let maps = mapping_text(descriptor.mapping.as_ref());
            print(&format!("{}\nmapping\n{maps}\ncan do\n{can}", descriptor_text(&descriptor)))?;
        }
        Ok(Exit::SUCCESS)
    }
}

/// Describes how the device transforms the samples.
fn mapping_text(mapping: Option<&Mapping>) -> String {
    match mapping {
        Some(Mapping { plays, loses }) => format!("  plays: {plays}\n  lost: {loses}\n"),
        None => "  plays: the samples\n".to_owned(),
    }
}

fn can_text(can: &Capabilities) -> String {
    let unit = can.quantity.unit();
    let with_unit = |number: Option<f64>, unit: &str, none: &str| match number {
        Some(number) => format!("{number} {unit}"),
        None => none.to_owned(),
    };
    let quantity = serde_json::to_value(can.quantity).unwrap_or_default();
    let clock = if can.paced { "a clock takes the samples" } else { "as fast as samples are made" };
    format!(
        "  quantity: {}, {unit}\n  rates: {}; best {} Hz\n  limit: {}\n  step: {}\n  carrier: {}\n  \
         pace: {clock}\n  block: {} frames\n",
        quantity.as_str().unwrap_or_default(),
        can.rates,
        can.default_rate_hz,
        with_unit(can.limit, unit, "none"),
        with_unit(can.step, unit, "none, floats"),
        with_unit(can.carrier_hz, "Hz", "none"),
        can.block_frames,
    )
}
