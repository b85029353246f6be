//! The adapter of analog inputs: its settings, and the channels that they name.

use htex_device::{
    Descriptor, DeviceError, Endpoint, FromScene, Setting, SettingKind, Settings, Source,
    SourceAdapter,
};

use crate::driver::{Driver, Terminals};
use crate::input_stream::InputStream;

/// Most channels of a source.
const MOST_CHANNELS: usize = 256;

/// Analog inputs of National Instruments cards as a source: volts of the card. The driver is loaded at the first use.
pub struct DaqInput {
    descriptor: Descriptor,
}

impl DaqInput {
    /// The adapter.
    pub fn new() -> Self {
        Self {
            descriptor: descriptor(),
        }
    }
}

impl Default for DaqInput {
    fn default() -> Self {
        Self::new()
    }
}

fn descriptor() -> Descriptor {
    let number = |min, max| SettingKind::Number { min, max };
    let terminals = ["default", "rse", "nrse", "diff", "pseudodiff"];
    let terminals = SettingKind::Choice {
        values: terminals.map(str::to_owned).to_vec(),
    };
    Descriptor {
        id: "org.htex.daq".to_owned(),
        name: "NI-DAQmx".to_owned(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        summary: "Analog inputs of a National Instruments card, volts.".to_owned(),
        settings: vec![
            setting(
                "channels",
                SettingKind::Text,
                "Dev1/ai0:5",
                "Analog inputs, as NI MAX names them: Dev1/ai0:5, or a list with commas.",
            ),
            setting(
                "rate_hz",
                number(1.0, 1e7),
                "20000",
                "Frames a second, hertz; 20,000 in the paper.",
            ),
            setting(
                "range_v",
                number(0.001, 100.0),
                "10",
                "Largest voltage of an input, volts either way; the card takes its next range.",
            ),
            setting(
                "terminals",
                terminals,
                "default",
                "Wiring: referenced (rse) or non-referenced single-ended (nrse), differential, pseudodifferential.",
            ),
            setting(
                "buffer_s",
                number(0.1, 60.0),
                "10",
                "Samples that may wait to be read, seconds.",
            ),
            setting(
                "driver",
                SettingKind::Text,
                "",
                "File of the NI-DAQmx library; empty: the one that is installed.",
            ),
        ],
        profiles: Vec::new(),
    }
}

fn setting(name: &str, kind: SettingKind, default: &str, description: &str) -> Setting {
    Setting {
        name: name.to_owned(),
        kind,
        default: Some(default.to_owned()),
        live_default: None,
        from_scene: FromScene::Never,
        description: description.to_owned(),
    }
}

impl SourceAdapter for DaqInput {
    fn descriptor(&self) -> &Descriptor {
        &self.descriptor
    }

    fn target(&self) -> &str {
        "channels"
    }

    /// The analog inputs of all cards that the installed driver knows.
    fn endpoints(&self) -> Result<Vec<Endpoint>, DeviceError> {
        let inputs = Driver::load("")?.inputs();
        let inputs = inputs.map_err(|fault| fault.failed("NI-DAQmx"))?;
        let endpoint = |(name, product)| Endpoint {
            name,
            setting: "channels".to_owned(),
            summary: format!("analog input of NI {product}"),
        };
        Ok(inputs.into_iter().map(endpoint).collect())
    }

    fn open(&self, settings: &Settings) -> Result<Box<dyn Source>, DeviceError> {
        let inputs = Inputs::new(settings)?;
        let driver = Driver::load(&inputs.driver)?;
        inputs.check_connected(driver)?;
        Ok(Box::new(InputStream::open(inputs, driver)?))
    }
}

/// Channels and clock, from the settings.
#[derive(Debug, Clone)]
pub(crate) struct Inputs {
    /// As given, for messages.
    pub(crate) given: String,
    /// Each channel's full name.
    pub(crate) channels: Vec<String>,
    pub(crate) rate_hz: f64,
    pub(crate) range_v: f64,
    pub(crate) terminals: Terminals,
    pub(crate) buffer_s: f64,
    driver: String,
}

impl Inputs {
    fn new(settings: &Settings) -> Result<Self, DeviceError> {
        let given = settings.text("channels");
        Ok(Self {
            given: given.to_owned(),
            channels: expanded(given)?,
            rate_hz: settings.number("rate_hz"),
            range_v: settings.number("range_v"),
            terminals: match settings.text("terminals") {
                "rse" => Terminals::Referenced,
                "nrse" => Terminals::NonReferenced,
                "diff" => Terminals::Differential,
                "pseudodiff" => Terminals::PseudoDifferential,
                _ => Terminals::Default,
            },
            buffer_s: settings.number("buffer_s"),
            driver: settings.text("driver").to_owned(),
        })
    }

    /// Frames of the buffer.
    pub(crate) fn buffer_frames(&self) -> u32 {
        (self.buffer_s * self.rate_hz)
            .ceil()
            .clamp(2.0, f64::from(u32::MAX)) as u32
    }

    fn check_connected(&self, driver: &Driver) -> Result<(), DeviceError> {
        let there = driver.inputs().map_err(|fault| fault.failed(&self.given))?;
        let is_there = |name: &&String| there.iter().any(|(known, _)| known == *name);
        if let Some(missing) = self.channels.iter().find(|name| !is_there(name)) {
            let known: Vec<&str> = there.iter().map(|(name, _)| &name[..]).collect();
            let known = match &known[..] {
                [] => "no card is".to_owned(),
                all => all.join(", ") + " are",
            };
            return Err(DeviceError::Missing(format!(
                "analog input `{missing}` is not connected; {known} (see NI MAX or `nilsdev`)"
            )));
        }
        let card = self.channels[0].split('/').next().unwrap_or_default();
        let rates = driver
            .input_rates(card)
            .map_err(|fault| fault.missing(&self.given))?;
        let (min_hz, max_hz) = (rates.0, rates.1 / self.channels.len() as f64);
        match (min_hz..=max_hz).contains(&self.rate_hz) {
            true => Ok(()),
            false => Err(DeviceError::Rate {
                device: self.given.clone(),
                rate_hz: self.rate_hz,
                rates: format!(
                    "{min_hz} to {max_hz} Hz with {} channels",
                    self.channels.len()
                ),
            }),
        }
    }
}

/// The channels of `Dev1/ai0:2, Dev1/ai5`: each by its full name, all of one card.
fn expanded(text: &str) -> Result<Vec<String>, DeviceError> {
    let refuse = |what: String| DeviceError::Setting {
        name: "channels".to_owned(),
        what: format!(
            "{what}; it looks like Dev1/ai0:5 or Dev1/ai0,Dev1/ai3, all of one card and each once"
        ),
    };
    let mut channels: Vec<String> = Vec::new();
    for part in text.split(',').map(str::trim) {
        let wrong = || refuse(format!("`{part}` names no analog input"));
        let (card, range) = part.split_once("/ai").ok_or_else(wrong)?;
        let (first, last) = range.split_once(':').unwrap_or((range, range));
        let number = |text: &str| text.trim_start_matches("ai").parse::<usize>().ok();
        let (Some(first), Some(last)) = (number(first), number(last)) else {
            return Err(wrong());
        };
        if card.is_empty() || last < first || last - first >= MOST_CHANNELS {
            return Err(wrong());
        }
        channels.extend((first..=last).map(|input| format!("{card}/ai{input}")));
    }
    let card = |name: &str| name.split('/').next().unwrap_or_default().to_owned();
    let other = |(i, name): (usize, &String)| {
        card(name) != card(&channels[0]) || channels[..i].contains(name)
    };
    match channels
        .iter()
        .enumerate()
        .any(|(i, name)| other((i, name)))
        || channels.len() > MOST_CHANNELS
    {
        true => Err(refuse(format!(
            "`{text}` names inputs twice or of several cards"
        ))),
        false => Ok(channels),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_and_lists_are_expanded() {
        let names = |text| expanded(text).unwrap_or_default().join(" ");
        assert_eq!(
            names("Dev1/ai0:2, Dev1/ai5"),
            "Dev1/ai0 Dev1/ai1 Dev1/ai2 Dev1/ai5"
        );
        assert_eq!(names("cDAQ1Mod1/ai3"), "cDAQ1Mod1/ai3");
        for wrong in [
            "",
            "Dev1",
            "Dev1/ao0",
            "/ai0",
            "Dev1/ai2:0",
            "Dev1/ai0:300",
            "Dev1/ai0,Dev1/ai0",
            "Dev1/ai0,Dev2/ai0",
        ] {
            assert!(expanded(wrong).is_err(), "{wrong}");
        }
    }
}
