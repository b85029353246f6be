//! The sound input adapter: its descriptor, and opening a card.

use htex_device::{
    Descriptor, DeviceError, Endpoint, FromScene, Setting, SettingKind, Settings, Source,
    SourceAdapter,
};

use crate::audio::card::{self, Card, DEFAULT, Side};
use crate::audio::recorder::Recorder;

/// Maximum number of channels of a source.
const MOST_CHANNELS: f64 = 64.0;
/// Maximum number of samples that may wait to be read (512 MiB).
const MOST_SAMPLES: f64 = 67_108_864.0;

/// The inputs of sound cards as a source, where 1 is full scale.
pub struct AudioInput {
    descriptor: Descriptor,
}

impl AudioInput {
    /// Creates the adapter. Opens nothing.
    pub fn new() -> Self {
        Self { descriptor: descriptor() }
    }
}

impl Default for AudioInput {
    fn default() -> Self {
        Self::new()
    }
}

impl SourceAdapter for AudioInput {
    fn descriptor(&self) -> &Descriptor {
        &self.descriptor
    }

    fn target(&self) -> &str {
        "device"
    }

    fn endpoints(&self) -> Result<Vec<Endpoint>, DeviceError> {
        card::endpoints(Side::Input)
    }

    fn open(&self, settings: &Settings) -> Result<Box<dyn Source>, DeviceError> {
        let card = Card::find(settings.text("device"), Side::Input)?;
        let preferred = card.preferred()?;
        let rate_hz = Some(settings.number("rate_hz")).filter(|rate_hz| *rate_hz > 0.0);
        let channels = Some(settings.number("channels") as u16).filter(|channels| *channels > 0);
        let (rate_hz, wanted) = (rate_hz.unwrap_or(preferred.0), channels.unwrap_or(preferred.1));
        let (config, format) = card.config(rate_hz, wanted)?;
        // `config` chooses the nearest number of channels, which may not be the one asked for.
        if channels.is_some_and(|channels| channels != config.channels) {
            return Err(refuse(
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
            return Err(refuse("buffer_s", what));
        }
        Ok(Box::new(Recorder::open(&card, config, format, buffered as usize)?))
    }
}

fn refuse(name: &str, what: String) -> DeviceError {
    DeviceError::Setting { name: name.to_owned(), what }
}

fn descriptor() -> Descriptor {
    let number = |min, max| SettingKind::Number { min, max };
    let setting = |name: &str, kind, default: &str, description: &str| Setting {
        name: name.to_owned(),
        kind,
        default: Some(default.to_owned()),
        live_default: None,
        from_scene: FromScene::Never,
        description: description.to_owned(),
    };
    Descriptor {
        id: "org.htex.audio".to_owned(),
        name: "Sound".to_owned(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        summary: "Inputs of a sound card; 1 is full scale.".to_owned(),
        settings: vec![
            setting(
                "device",
                SettingKind::Text,
                DEFAULT,
                "Sound input, as the list of sources names it.",
            ),
            setting(
                "rate_hz",
                number(0.0, 768_000.0),
                "0",
                "Frames a second, hertz; 0: what the card prefers.",
            ),
            setting(
                "channels",
                number(0.0, MOST_CHANNELS),
                "0",
                "Number of channels; 0: what the card prefers.",
            ),
            setting(
                "buffer_s",
                number(0.1, 60.0),
                "10",
                "Samples that may wait to be read, seconds.",
            ),
        ],
        profiles: Vec::new(),
        mapping: None,
    }
}
