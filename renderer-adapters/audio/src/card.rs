//! Sound cards, what they can do, and the configuration that is chosen for a stream.

use cpal::traits::{DeviceTrait, HostTrait};
use cpal::{SampleFormat, StreamConfig, SupportedStreamConfigRange};
use htex_device::{Capabilities, DeviceError, Quantity, Rates};

/// Formats a stream may have, the best first.
const FORMATS: [SampleFormat; 4] = [
    SampleFormat::F32,
    SampleFormat::I32,
    SampleFormat::I16,
    SampleFormat::U8,
];
/// Preferred frames in a block.
const BLOCK_FRAMES: u32 = 256;
/// Highest rate that is reported, hertz: plugins of ALSA report unlimited ranges.
const MAX_RATE_HZ: f64 = 768_000.0;
/// The name of the card that the system prefers.
pub(crate) const DEFAULT: &str = "default";

pub(crate) struct Card {
    pub(crate) name: String,
    pub(crate) device: cpal::Device,
    configs: Vec<SupportedStreamConfigRange>,
}

impl Card {
    /// The card of this name, which must be connected and have an output.
    pub(crate) fn find(name: &str) -> Result<Self, DeviceError> {
        let host = cpal::default_host();
        let device = match name {
            DEFAULT => host.default_output_device(),
            _ => outputs()?.into_iter().find(|d| id(d) == name),
        };
        let device = device.ok_or_else(|| missing(name, "there is no card of this name"))?;
        let configs = device.supported_output_configs();
        let configs: Vec<_> = configs
            .map_err(|error| missing(name, &error.to_string()))?
            .filter(|config| FORMATS.contains(&config.sample_format()))
            .collect();
        match configs.is_empty() {
            true => Err(missing(name, "it has no supported sample format")),
            false => Ok(Self {
                name: name.to_owned(),
                device,
                configs,
            }),
        }
    }

    pub(crate) fn capabilities(&self) -> Result<Capabilities, DeviceError> {
        let preferred = self.device.default_output_config();
        let preferred = preferred.map_err(|error| missing(&self.name, &error.to_string()))?;
        Ok(Capabilities {
            quantity: Quantity::Sound,
            rates: self.rates(),
            default_rate_hz: f64::from(preferred.sample_rate()),
            limit: Some(1.0),
            step: None,
            carrier_hz: None,
            paced: true,
            block_frames: BLOCK_FRAMES,
        })
    }

    fn rates(&self) -> Rates {
        let ends = |c: &SupportedStreamConfigRange| {
            (
                f64::from(c.min_sample_rate()),
                f64::from(c.max_sample_rate()),
            )
        };
        let mut all: Vec<(f64, f64)> = self.configs.iter().map(ends).collect();
        if all.iter().any(|(min, max)| min < max) {
            let min_hz = all.iter().map(|r| r.0).fold(f64::INFINITY, f64::min);
            let max_hz = all.iter().map(|r| r.1).fold(0.0, f64::max).min(MAX_RATE_HZ);
            return Rates::Range { min_hz, max_hz };
        }
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        all.dedup();
        Rates::List(all.into_iter().map(|r| r.0).collect())
    }

    /// The best format at this rate, with two channels or the number closest to two.
    pub(crate) fn config(&self, rate_hz: f64) -> Result<(StreamConfig, SampleFormat), DeviceError> {
        let fits = |c: &&SupportedStreamConfigRange| {
            let rates = c.min_sample_rate()..=c.max_sample_rate();
            rate_hz.fract() == 0.0 && rates.contains(&(rate_hz as u32))
        };
        let rank = |c: &&SupportedStreamConfigRange| {
            let format = FORMATS.iter().position(|f| *f == c.sample_format());
            (format, c.channels().abs_diff(2))
        };
        let best = self.configs.iter().filter(fits).min_by_key(rank);
        let best = best.ok_or_else(|| DeviceError::Rate {
            device: self.name.clone(),
            rate_hz,
            rates: self.rates().to_string(),
        })?;
        let config = best.with_sample_rate(rate_hz as u32);
        Ok((config.config(), config.sample_format()))
    }
}

/// All connected cards with an output.
pub(crate) fn outputs() -> Result<Vec<cpal::Device>, DeviceError> {
    let outputs = cpal::default_host().output_devices();
    Ok(outputs
        .map_err(|error| missing("sound", &error.to_string()))?
        .collect())
}

/// The name of a card; empty when the system gives none.
pub(crate) fn id(device: &cpal::Device) -> String {
    device.id().map(|id| id.to_string()).unwrap_or_default()
}

fn missing(name: &str, what: &str) -> DeviceError {
    let check = match cfg!(target_os = "linux") {
        true => "`aplay -l` lists the cards; a machine without one, or a container, has none",
        false => "see the sound settings of the system",
    };
    DeviceError::Missing(format!("no sound output `{name}`: {what}; {check}"))
}
