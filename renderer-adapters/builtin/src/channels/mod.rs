//! Outputs with several channels. The user selects the channels that play the texture. The
//! interleaved frames go to a sound card or to a WAV file, or are discarded.
//!
//! For example, a DualSense controller connected by a cable is a sound card with four channels.
//! Channels 1 and 2 are its loudspeaker and headset. Channels 3 and 4 are its left and right
//! actuator. The actuators play the texture's samples, not only a vibration strength, so no part of
//! a texture is lost.
#![forbid(unsafe_code)]

mod nowhere;
mod plays;
mod to;

use std::sync::LazyLock;

use crate::motor::buffer_setting;
use htex_device::{
    Adapter, Capabilities, Descriptor, DeviceError, Endpoint, FromScene, Mapping, Output, Setting,
    SettingKind, Settings, StreamFormat,
};

use to::To;

/// The adapter for outputs with several channels. See the crate's documentation.
#[derive(Debug, Clone, Copy, Default)]
pub struct Channels;

impl Adapter for Channels {
    fn descriptor(&self) -> &Descriptor {
        &DESCRIPTOR
    }

    /// Lists the outputs: `null`, and the sound cards by the names that the system gives them. A
    /// card's number of channels is checked only when the card is used.
    fn endpoints(&self) -> Result<Vec<Endpoint>, DeviceError> {
        let nothing = Endpoint {
            name: "null".to_owned(),
            setting: "to".to_owned(),
            summary: "nothing: the frames are taken at the pace of the clock, and discarded"
                .to_owned(),
        };
        Ok([nothing].into_iter().chain(to::cards()).collect())
    }

    fn capabilities(&self, settings: &Settings) -> Result<Capabilities, DeviceError> {
        To::new(settings)?.capabilities(&plays::factors(settings.text("plays"))?)
    }

    fn open_output(
        &self,
        settings: &Settings,
        format: &StreamFormat,
    ) -> Result<Box<dyn Output>, DeviceError> {
        let factors = plays::factors(settings.text("plays"))?;
        To::new(settings)?.open(&factors, format)
    }
}

static DESCRIPTOR: LazyLock<Descriptor> = LazyLock::new(|| {
    let settings = vec![
        Setting::new(
            "to",
            SettingKind::choice(&to::NAMES),
            "Where the frames go: a sound card, a WAV file of 32-bit floats, or nothing.",
        )
        .with_from_scene(FromScene::Never),
        Setting::hardware(
            "plays",
            SettingKind::Text,
            plays::DUALSENSE,
            "What each channel plays, separated by commas: `off`, `texture`, or a factor from -1 to 1 for the texture. The default suits a DualSense.",
        ),
        Setting::hardware(
            "device",
            SettingKind::Text,
            to::DEFAULT_CARD,
            "Only for to=sound: name of the sound output in the list of devices.",
        ),
        Setting::hardware(
            "path",
            SettingKind::Text,
            "",
            "Only for to=file: path of the file. The file appears, or replaces an existing one, when the output finishes.",
        ),
        buffer_setting(),
    ];
    Descriptor {
        id: "org.htex.channels".to_owned(),
        name: "Channels".to_owned(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        summary: "Chosen channels of a sound card or a WAV file, such as the actuators of a DualSense.".to_owned(),
        settings,
        mapping: Some(Mapping {
            plays: "the samples, times the factor of each channel".to_owned(),
            loses: "nothing of the samples. But an actuator has its own frequency response, and both actuators of a \
                    DualSense play the same texture".to_owned(),
        }),
        ..Descriptor::default()
    }
});
