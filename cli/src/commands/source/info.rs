use clap::Args;
use htex_device::{DeviceError, KnownSource, Settings, SourceStream};
use serde_json::json;

use crate::adapters::descriptor_text;
use crate::devices::SettingArgs;
use crate::failure::{Exit, Failure};
use crate::output::{print, print_json, tamed};
use crate::sources::{SourceArgs, source_json};

/// Show a source's settings and profiles, what is connected, and its rate and channels with these
/// settings.
///
/// The source is opened to read its rate and channels. It does not sample.
#[derive(Args)]
pub(crate) struct Info {
    /// The source, by short name, id or library file
    #[arg(value_name = "FILE|ID")]
    source: String,

    #[command(flatten)]
    sources: SourceArgs,

    #[command(flatten)]
    settings: SettingArgs,

    /// Print JSON
    #[arg(long)]
    json: bool,
}

impl Info {
    pub(crate) fn run(self) -> Result<Exit, Failure> {
        let known = self.sources.named(&self.source)?;
        let given = self.settings.given()?;
        let settings = Settings::resolve(known.descriptor(), self.settings.profile(), &given);
        let stream = settings.and_then(|settings| stream(&known, &settings));
        if self.json {
            let (stream, problem) = match stream {
                Ok(stream) => (Some(stream), None),
                Err(problem) => (None, Some(problem.to_string())),
            };
            print_json(&json!({ "source": source_json(&known), "stream": stream,
                "problem": problem }))?;
        } else {
            let delivers = match stream {
                Ok(stream) => stream_text(&tamed(&stream)),
                Err(problem) => format!("  not known, set so: {problem}\n"),
            };
            let target = known.adapter.target();
            let descriptor = descriptor_text(&tamed(known.descriptor()));
            print(&format!("{descriptor}\ntarget: {target}\ndelivers\n{delivers}"))?;
        }
        Ok(Exit::SUCCESS)
    }
}

fn stream(known: &KnownSource, settings: &Settings) -> Result<SourceStream, DeviceError> {
    let source = known.adapter.open(settings)?;
    Ok(SourceStream { rate_hz: source.rate_hz(), channels: source.channels().to_vec() })
}

fn stream_text(stream: &SourceStream) -> String {
    let channel = |channel: &htex_device::Channel| match &channel.unit[..] {
        "" => channel.name.clone(),
        unit => format!("{} in {unit}", channel.name),
    };
    let channels: Vec<String> = stream.channels.iter().map(channel).collect();
    let (rate_hz, channels) = (stream.rate_hz, channels.join(", "));
    format!("  rate: {rate_hz} Hz\n  channels: {channels}\n")
}
