//! The sound input adapter: its descriptor, and the code that opens a sound card.

use std::sync::LazyLock;

use htex_device::{
    Adapter, Descriptor, DeviceError, Direction, Endpoint, Input, Setting, SettingKind, Settings,
};

use crate::audio::card::{self, Card, DEFAULT};
use crate::audio::recorder::Recorder;

/// Maximum number of channels of an input.
const MOST_CHANNELS: f64 = 64.0;
/// Maximum number of samples that may wait to be read (512 MiB).
const MOST_SAMPLES: f64 = 67_108_864.0;

/// The sound input adapter: records from sound cards. In the samples, 1 is full scale.
#[derive(Debug, Clone, Copy, Default)]
pub struct AudioInput;

impl Adapter for AudioInput {
    fn descriptor(&self) -> &Descriptor {
        &DESCRIPTOR
    }

    fn endpoints(&self) -> Result<Vec<Endpoint>, DeviceError> {
        card::endpoints(Direction::Input)
    }

    fn open_input(&self, settings: &Settings) -> Result<Box<dyn Input>, DeviceError> {
        let card = Card::find(settings.text("device"), Direction::Input)?;
        let preferred = card.preferred()?;
        let rate_hz = Some(settings.number("rate_hz")).filter(|rate_hz| *rate_hz > 0.0);
        let channels = Some(settings.number("channels") as u16).filter(|channels| *channels > 0);
        let (rate_hz, wanted) = (rate_hz.unwrap_or(preferred.0), channels.unwrap_or(preferred.1));
        let (config, format) = card.config(rate_hz, wanted)?;
        // `config` chooses the nearest number of channels, which may differ from the requested
        // number.
        if channels.is_some_and(|channels| channels != config.channels) {
            return Err(DeviceError::setting(
                "channels",
                format!(
                    "`{}` has no {wanted} channels at {rate_hz} Hz; the nearest number is {}",
                    card.name, config.channels
                ),
            ));
        }
        let buffered = settings.number("buffer_s") * rate_hz * f64::from(config.channels);
        if buffered > MOST_SAMPLES {
            let most_s = MOST_SAMPLES / (rate_hz * f64::from(config.channels));
            let what = format!("{most_s:.1} s of so many samples are the most");
            return Err(DeviceError::setting("buffer_s", what));
        }
        Ok(Box::new(Recorder::open(&card, config, format, buffered as usize)?))
    }
}

static DESCRIPTOR: LazyLock<Descriptor> = LazyLock::new(|| {
    let number = |min, max| SettingKind::Number { min, max };
    Descriptor {
        id: "org.htex.audio".to_owned(),
        name: "Sound".to_owned(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        summary: "Inputs of a sound card; 1 is full scale.".to_owned(),
        direction: Direction::Input,
        target: Some("device".to_owned()),
        settings: vec![
            Setting::hardware(
                "device",
                SettingKind::Text,
                DEFAULT,
                "Name of the sound input in the list of devices.",
            ),
            Setting::hardware(
                "rate_hz",
                number(0.0, 768_000.0),
                "0",
                "Sample rate, hertz; 0: the rate that the card prefers.",
            ),
            Setting::hardware(
                "channels",
                number(0.0, MOST_CHANNELS),
                "0",
                "Number of channels; 0: the number that the card prefers.",
            ),
            Setting::hardware(
                "buffer_s",
                number(0.1, 60.0),
                "10",
                "Size of the buffer for samples that wait to be read, seconds.",
            ),
        ],
        ..Descriptor::default()
    }
});
