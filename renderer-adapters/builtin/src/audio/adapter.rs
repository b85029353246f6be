//! The sound output adapter: its descriptor, and opening a card.

use htex_device::{
    Adapter, Capabilities, Descriptor, Device, DeviceError, Endpoint, FromScene, Setting,
    SettingKind, Settings, StreamFormat,
};

use crate::audio::card::{self, Card, DEFAULT, Side};
use crate::audio::sound::{Channels, Sound};

/// The sound output adapter. See the crate's documentation.
pub struct Audio {
    descriptor: Descriptor,
}

impl Audio {
    /// Creates the adapter. Opens nothing.
    pub fn new() -> Self {
        Self { descriptor: descriptor() }
    }
}

impl Default for Audio {
    fn default() -> Self {
        Self::new()
    }
}

impl Adapter for Audio {
    fn descriptor(&self) -> &Descriptor {
        &self.descriptor
    }

    fn endpoints(&self) -> Result<Vec<Endpoint>, DeviceError> {
        card::endpoints(Side::Output)
    }

    fn capabilities(&self, settings: &Settings) -> Result<Capabilities, DeviceError> {
        Card::find(settings.text("device"), Side::Output)?.capabilities()
    }

    fn open(
        &self,
        settings: &Settings,
        format: &StreamFormat,
    ) -> Result<Box<dyn Device>, DeviceError> {
        let card = Card::find(settings.text("device"), Side::Output)?;
        let buffer_s = settings.number("buffer_ms") / 1e3;
        Ok(Box::new(Sound::open(&card, buffer_s, format, Channels::All)?))
    }
}

fn descriptor() -> Descriptor {
    let device = Setting {
        name: "device".to_owned(),
        kind: SettingKind::Text,
        default: Some(DEFAULT.to_owned()),
        live_default: None,
        from_scene: FromScene::Never,
        description: "Sound output, as the list of devices names it.".to_owned(),
    };
    let buffer = Setting {
        name: "buffer_ms".to_owned(),
        kind: SettingKind::Number { min: 5.0, max: 10_000.0 },
        default: Some("60".to_owned()),
        live_default: None,
        from_scene: FromScene::Less,
        description: "Samples kept ready for the card, milliseconds: more is safer, less is \
                      quicker."
            .to_owned(),
    };
    Descriptor {
        id: "org.htex.audio".to_owned(),
        name: "Sound".to_owned(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        summary: "Sound through a sound card, the same on all its channels.".to_owned(),
        settings: vec![device, buffer],
        profiles: Vec::new(),
        mapping: None,
    }
}
