use clap::Args;
use htex_device::{Capabilities, Channel, DeviceError, Direction, InputStream, Mapping, Settings};
use serde_json::json;

use crate::devices::OneDeviceArgs;
use crate::failure::{Exit, Result};
use crate::output::{print, print_json, tamed};

use super::list::descriptor_text;

/// Show a device's settings, profiles and capabilities.
///
/// For an output, prints what the device can do with the given settings, e.g. its sample rates and
/// its limit. For an input, prints the sample rate and the channels; for this, the command opens
/// the input, but records no samples.
#[derive(Args)]
pub(crate) struct Info {
    #[command(flatten)]
    device: OneDeviceArgs,

    /// Print JSON
    #[arg(long)]
    json: bool,
}

impl Info {
    pub(crate) fn run(self) -> Result {
        let entry = self.device.load()?;
        let (descriptor, adapter) = (entry.descriptor(), entry.adapter.as_ref());
        let given = self.device.settings.given()?;
        let settings = Settings::resolve(descriptor, self.device.settings.profile(), &given);
        let shown = &tamed(descriptor);
        let (key, value, text, problem) = match descriptor.direction {
            Direction::Output => {
                let can = settings.and_then(|settings| adapter.capabilities(&settings));
                let maps = mapping_text(shown.mapping.as_ref());
                let text = format!("mapping\n{maps}\ncan do\n{}", known_text(&can, can_text));
                ("capabilities", json!(can.as_ref().ok()), text, can.err())
            }
            Direction::Input => {
                let input = settings.and_then(|settings| adapter.open_input(&settings));
                let stream = input.map(|input| input.stream().clone());
                let target = shown.target.as_deref().unwrap_or_default();
                let delivers = known_text(&stream, |stream| stream_text(&tamed(stream)));
                let text = format!("target: {target}\ndelivers\n{delivers}");
                ("stream", json!(stream.as_ref().ok()), text, stream.err())
            }
        };
        if self.json {
            print_json(&json!({ "descriptor": descriptor, "origin": entry.origin.to_string(),
                key: value, "problem": problem.map(|error| error.to_string()) }))?;
        } else {
            print(&format!("{}\n{text}", descriptor_text(shown)))?;
        }
        Ok(Exit::SUCCESS)
    }
}

fn known_text<T>(known: &Result<T, DeviceError>, text: impl Fn(&T) -> String) -> String {
    match known {
        Ok(known) => text(known),
        Err(problem) => format!("  not known, set so: {problem}\n"),
    }
}

fn stream_text(stream: &InputStream) -> String {
    let channel = |channel: &Channel| match &channel.unit[..] {
        "" => channel.name.clone(),
        unit => format!("{} in {unit}", channel.name),
    };
    let channels: Vec<String> = stream.channels.iter().map(channel).collect();
    let (rate_hz, channels) = (stream.rate_hz, channels.join(", "));
    format!("  rate: {rate_hz} Hz\n  channels: {channels}\n")
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
