//! The channels and the clock of an input, read from its settings.

use htex_device::{DeviceError, Settings};

use crate::daq::driver::{Driver, Terminals};

/// Maximum number of channels of an input.
const MOST_CHANNELS: usize = 256;

/// Channels and clock, read from the settings.
#[derive(Debug, Clone)]
pub(crate) struct Inputs {
    /// The channels as the user wrote them, for messages.
    pub(crate) given: String,
    /// The full name of each channel.
    pub(crate) channels: Vec<String>,
    pub(crate) rate_hz: f64,
    pub(crate) range_v: f64,
    pub(crate) terminals: Terminals,
    pub(crate) buffer_s: f64,
    pub(crate) driver: String,
}

impl Inputs {
    pub(crate) fn new(settings: &Settings) -> Result<Self, DeviceError> {
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

    pub(crate) fn buffer_frames(&self) -> u32 {
        (self.buffer_s * self.rate_hz).ceil().clamp(2.0, f64::from(u32::MAX)) as u32
    }

    pub(crate) fn check_connected(&self, driver: &Driver) -> Result<(), DeviceError> {
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
        let rates = driver.input_rates(card).map_err(|fault| fault.missing(&self.given))?;
        // All inputs of a card share its converter, so each gets a part of the converter's rate.
        let (min_hz, max_hz) = (rates.0, rates.1 / self.channels.len() as f64);
        if (min_hz..=max_hz).contains(&self.rate_hz) {
            Ok(())
        } else {
            Err(DeviceError::Rate {
                device: self.given.clone(),
                rate_hz: self.rate_hz,
                rates: format!("{min_hz} to {max_hz} Hz with {} channels", self.channels.len()),
            })
        }
    }
}

/// Expands a list such as `Dev1/ai0:2, Dev1/ai5` to the full name of each channel. All channels
/// must belong to one card.
fn expanded(text: &str) -> Result<Vec<String>, DeviceError> {
    let refuse = |what: String| {
        let form = "it looks like Dev1/ai0:5 or Dev1/ai0,Dev1/ai3, all of one card and each once";
        DeviceError::setting("channels", format!("{what}; {form}"))
    };
    let mut channels: Vec<String> = Vec::new();
    for part in text.split(',').map(str::trim) {
        let wrong = || refuse(format!("`{part}` names no analog input"));
        let (card, range) = part.split_once("/ai").ok_or_else(wrong)?;
        let (first, last) = range.split_once(':').unwrap_or((range, range));
        // The last number of a range may repeat the prefix, as in `ai0:ai5`.
        let number = |text: &str| text.trim_start_matches("ai").parse::<usize>().ok();
        let (Some(first), Some(last)) = (number(first), number(last)) else {
            return Err(wrong());
        };
        // The range is checked before it is expanded, so that `ai0:999999999` takes no memory.
        if card.is_empty() || last < first || last - first >= MOST_CHANNELS {
            return Err(wrong());
        }
        channels.extend((first..=last).map(|input| format!("{card}/ai{input}")));
    }
    let card = |name: &str| name.split('/').next().unwrap_or_default().to_owned();
    let other = |(i, name): (usize, &String)| {
        card(name) != card(&channels[0]) || channels[..i].contains(name)
    };
    if channels.iter().enumerate().any(|(i, name)| other((i, name)))
        || channels.len() > MOST_CHANNELS
    {
        Err(refuse(format!("`{text}` names inputs twice or of several cards")))
    } else {
        Ok(channels)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_and_lists_are_expanded() {
        let names = |text| expanded(text).unwrap_or_default().join(" ");
        assert_eq!(names("Dev1/ai0:2, Dev1/ai5"), "Dev1/ai0 Dev1/ai1 Dev1/ai2 Dev1/ai5");
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
