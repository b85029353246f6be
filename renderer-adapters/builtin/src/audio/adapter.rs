//! The sound output adapter: its descriptor, and the code that opens a sound card.

use std::sync::LazyLock;

use htex_device::{
    Adapter, Capabilities, Descriptor, DeviceError, Direction, Endpoint, FromScene, Output,
    Setting, SettingKind, Settings, StreamFormat,
};

use crate::audio::card::{self, Card, DEFAULT};
use crate::audio::sound::{Channels, Sound};

/// The sound output adapter, which plays on sound cards. See the crate's documentation.
#[derive(Debug, Clone, Copy, Default)]
pub struct Audio;

impl Adapter for Audio {
    fn descriptor(&self) -> &Descriptor {
        &DESCRIPTOR
    }

    fn endpoints(&self) -> Result<Vec<Endpoint>, DeviceError> {
        card::endpoints(Direction::Output)
    }

    fn capabilities(&self, settings: &Settings) -> Result<Capabilities, DeviceError> {
        Card::find(settings.text("device"), Direction::Output)?.capabilities()
    }

    fn open_output(
        &self,
        settings: &Settings,
        format: &StreamFormat,
    ) -> Result<Box<dyn Output>, DeviceError> {
        let card = Card::find(settings.text("device"), Direction::Output)?;
        let buffer_s = settings.number("buffer_ms") / 1e3;
        Ok(Box::new(Sound::open(&card, buffer_s, format, Channels::All)?))
    }
}

static DESCRIPTOR: LazyLock<Descriptor> = LazyLock::new(|| {
    let buffer_ms = SettingKind::Number { min: 5.0, max: 10_000.0 };
    let about = "Duration of the samples that are kept ready for the card, milliseconds. A larger \
                 buffer is safer, a smaller one has less latency.";
    Descriptor {
        id: "org.htex.audio".to_owned(),
        name: "Sound".to_owned(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        summary: "Sound through a sound card. All channels play the same.".to_owned(),
        settings: vec![
            Setting::hardware(
                "device",
                SettingKind::Text,
                DEFAULT,
                "Name of the sound output in the list of devices.",
            ),
            Setting::hardware("buffer_ms", buffer_ms, "60", about).with_from_scene(FromScene::Less),
        ],
        ..Descriptor::default()
    }
});
