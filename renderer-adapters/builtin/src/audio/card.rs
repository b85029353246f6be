//! Sound cards: finds their outputs and inputs, and chooses a configuration for a stream.

use cpal::traits::{DeviceTrait, HostTrait};
use cpal::{SampleFormat, StreamConfig, SupportedStreamConfigRange};
use htex_device::{Capabilities, DeviceError, Direction, Endpoint, Quantity, Rates};

/// Sample formats that a stream may use, best first.
const FORMATS: [SampleFormat; 4] =
    [SampleFormat::F32, SampleFormat::I32, SampleFormat::I16, SampleFormat::U8];
/// Rate to prefer if the card does not support its own preferred rate, hertz.
const USUAL_RATE_HZ: f64 = 48_000.0;
/// Preferred block size, frames.
const BLOCK_FRAMES: u32 = 256;
/// Highest rate that this crate reports, hertz. ALSA plugins would otherwise report unlimited
/// ranges.
const MAX_RATE_HZ: f64 = 768_000.0;
/// The name that stands for the system's preferred card.
pub(crate) const DEFAULT: &str = "default";

pub(crate) struct Card {
    pub(crate) name: String,
    pub(crate) device: cpal::Device,
    direction: Direction,
    configs: Vec<SupportedStreamConfigRange>,
}

impl Card {
    /// Finds the card of this name, which must be connected and have this direction.
    pub(crate) fn find(name: &str, direction: Direction) -> Result<Self, DeviceError> {
        let host = cpal::default_host();
        let device = match (name, direction) {
            (DEFAULT, Direction::Output) => host.default_output_device(),
            (DEFAULT, Direction::Input) => host.default_input_device(),
            _ => cards(direction)?.into_iter().find(|d| id(d) == name),
        };
        let missing = |what: &str| missing(direction, name, what);
        let device = device.ok_or_else(|| missing("there is no card of this name"))?;
        let configs = configs(&device, direction).map_err(|error| missing(&error.to_string()))?;
        if configs.is_empty() {
            Err(missing("it has no supported sample format"))
        } else {
            Ok(Self { name: name.to_owned(), device, direction, configs })
        }
    }

    /// Keeps only the card's configurations with this number of channels.
    pub(crate) fn with_channels(mut self, channels: u16) -> Result<Self, DeviceError> {
        self.configs.retain(|config| config.channels() == channels);
        if self.configs.is_empty() {
            let what = format!("it does not take {channels} channels");
            Err(missing(self.direction, &self.name, &what))
        } else {
            Ok(self)
        }
    }

    /// Returns the rate (hertz) and number of channels that the card prefers.
    pub(crate) fn preferred(&self) -> Result<(f64, u16), DeviceError> {
        let preferred = match self.direction {
            Direction::Output => self.device.default_output_config(),
            Direction::Input => self.device.default_input_config(),
        };
        let preferred =
            preferred.map_err(|error| missing(self.direction, &self.name, &error.to_string()))?;
        Ok((f64::from(preferred.sample_rate()), preferred.channels()))
    }

    pub(crate) fn capabilities(&self) -> Result<Capabilities, DeviceError> {
        Ok(Capabilities {
            quantity: Quantity::Sound,
            rates: self.rates(),
            default_rate_hz: self.usual_rate_hz()?,
            limit: Some(1.0),
            step: None,
            carrier_hz: None,
            paced: true,
            block_frames: BLOCK_FRAMES,
        })
    }

    /// Returns the rate that the card prefers. If the card does not support this rate with the
    /// chosen number of channels, returns the highest supported rate up to 48 kHz.
    fn usual_rate_hz(&self) -> Result<f64, DeviceError> {
        let (preferred_hz, rates) = (self.preferred()?.0, self.rates());
        Ok(match &rates {
            _ if rates.has(preferred_hz) => preferred_hz,
            Rates::List(all) => {
                let low = all.iter().copied().rfind(|hz| *hz <= USUAL_RATE_HZ);
                low.or(all.first().copied()).unwrap_or(preferred_hz)
            }
            Rates::Range { min_hz, max_hz } => USUAL_RATE_HZ.clamp(*min_hz, *max_hz),
        })
    }

    fn rates(&self) -> Rates {
        let ends = |c: &SupportedStreamConfigRange| {
            (f64::from(c.min_sample_rate()), f64::from(c.max_sample_rate()))
        };
        let mut all: Vec<(f64, f64)> = self.configs.iter().map(ends).collect();
        if all.iter().any(|(min, max)| min < max) {
            // Gaps between the ranges are not reported. `config` refuses a rate in a gap.
            let min_hz = all.iter().map(|r| r.0).fold(f64::INFINITY, f64::min);
            let max_hz = all.iter().map(|r| r.1).fold(0.0, f64::max).min(MAX_RATE_HZ);
            return Rates::Range { min_hz, max_hz };
        }
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        all.dedup();
        Rates::List(all.into_iter().map(|r| r.0).collect())
    }

    /// Chooses the best format at this rate, with the requested number of channels or the number
    /// closest to it.
    pub(crate) fn config(
        &self,
        rate_hz: f64,
        channels: u16,
    ) -> Result<(StreamConfig, SampleFormat), DeviceError> {
        let fits = |c: &&SupportedStreamConfigRange| {
            let rates = c.min_sample_rate()..=c.max_sample_rate();
            // The library cpal has only whole rates.
            rate_hz.fract() == 0.0 && rates.contains(&(rate_hz as u32))
        };
        let rank = |c: &&SupportedStreamConfigRange| {
            let format = FORMATS.iter().position(|f| *f == c.sample_format());
            // The format matters more than the number of channels.
            (format, c.channels().abs_diff(channels))
        };
        let best =
            self.configs.iter().filter(fits).min_by_key(rank).ok_or_else(|| DeviceError::Rate {
                device: self.name.clone(),
                rate_hz,
                rates: self.rates().to_string(),
            })?;
        let config = best.with_sample_rate(rate_hz as u32);
        Ok((config.config(), config.sample_format()))
    }
}

/// Returns the configurations of a card that this crate can use.
fn configs(
    device: &cpal::Device,
    direction: Direction,
) -> Result<Vec<SupportedStreamConfigRange>, cpal::Error> {
    let mut configs: Vec<_> = match direction {
        Direction::Output => device.supported_output_configs()?.collect(),
        Direction::Input => device.supported_input_configs()?.collect(),
    };
    configs.retain(|config| FORMATS.contains(&config.sample_format()));
    Ok(configs)
}

/// Lists all connected cards of this direction.
fn cards(direction: Direction) -> Result<Vec<cpal::Device>, DeviceError> {
    let host = cpal::default_host();
    let cards: Result<Vec<_>, _> = match direction {
        Direction::Output => host.output_devices().map(Iterator::collect),
        Direction::Input => host.input_devices().map(Iterator::collect),
    };
    cards.map_err(|error| missing(direction, "sound", &error.to_string()))
}

/// Lists the card that the system prefers, and all connected cards of this direction.
pub(crate) fn endpoints(direction: Direction) -> Result<Vec<Endpoint>, DeviceError> {
    let endpoint =
        |name: String, summary: String| Endpoint { name, setting: "device".to_owned(), summary };
    let default = Card::find(DEFAULT, direction)
        .ok()
        .map(|_| endpoint(DEFAULT.to_owned(), "what the system prefers".into()));
    let named = cards(direction)?.into_iter().map(|device| {
        let description = device.description().map(|d| d.to_string());
        endpoint(id(&device), description.unwrap_or_default().replace('\n', ", "))
    });
    Ok(default.into_iter().chain(named).collect())
}

/// Returns the name of a card. Empty if the system gives the card no name.
fn id(device: &cpal::Device) -> String {
    device.id().map(|id| id.to_string()).unwrap_or_default()
}

fn missing(direction: Direction, name: &str, what: &str) -> DeviceError {
    let list = match direction {
        Direction::Output => "aplay",
        Direction::Input => "arecord",
    };
    let check = if cfg!(target_os = "linux") {
        format!("`{list} -l` lists the cards; a machine without one, or a container, has none")
    } else {
        "see the sound settings of the system".to_owned()
    };
    DeviceError::Missing(format!("no sound {direction} `{name}`: {what}; {check}"))
}
