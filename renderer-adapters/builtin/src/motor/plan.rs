//! The settings that all devices with motors have, and the values derived from them.

use htex_device::{
    Capabilities, DeviceError, FromScene, Quantity, Rates, Setting, SettingKind, Settings,
};

/// Lowest and highest sample rate, hertz. Frequencies of textures reach 1 kHz.
const RATES_HZ: (f64, f64) = (2_000.0, 192_000.0);
const DEFAULT_RATE_HZ: f64 = 8_000.0;
/// Defaults of the setting `buffer_ms`: in general, and for a live motion.
const DEFAULT_BUFFER_MS: [&str; 2] = ["100", "30"];
/// Default of the setting `gain`.
pub(crate) const DEFAULT_GAIN: &str = "3";

/// Returns the settings `gain`, `block_ms` and `buffer_ms`.
pub fn reducing_settings() -> Vec<Setting> {
    let gain = Setting::hardware(
        "gain",
        SettingKind::Number { min: 0.0, max: 100.0 },
        DEFAULT_GAIN,
        "The motor's strength is this gain times the level (RMS, where 1 is full scale), at most \
         1. With a gain of 3, a level of a third of full scale gives full strength. Noise can \
         reach about this level without clipping.",
    );
    let block = Setting::hardware(
        "block_ms",
        SettingKind::Number { min: 5.0, max: 100.0 },
        "10",
        "Duration of a block, milliseconds. The motor plays each block with one strength and one frequency.",
    );
    vec![gain, block, buffer_setting()]
}

/// Returns the setting `buffer_ms`. Its default is shorter if the motion is live.
pub fn buffer_setting() -> Setting {
    let [usual, live] = DEFAULT_BUFFER_MS;
    Setting::hardware(
        "buffer_ms",
        SettingKind::Number { min: 10.0, max: 10_000.0 },
        usual,
        "Duration of the samples that are kept ready, milliseconds: at least two blocks. A larger \
         buffer is safer, a smaller one has less latency.",
    )
    .with_live_default(live)
    .with_from_scene(FromScene::Less)
}

/// Whether `buffer_ms` has one of its default values.
pub fn has_usual_buffer(settings: &Settings) -> bool {
    DEFAULT_BUFFER_MS.contains(&settings.text("buffer_ms"))
}

/// Returns the error for a rate that a device does not support.
pub fn rate_error(device: &str, rate_hz: f64, can: &Capabilities) -> DeviceError {
    DeviceError::Rate { device: device.to_owned(), rate_hz, rates: can.rates.to_string() }
}

/// The values of the settings that all devices with motors have.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plan {
    /// Factor that converts the level of a block to the strength of the motor. Strengths above 1
    /// are limited to 1.
    pub gain: f64,
    /// Duration of a block, seconds.
    pub block_s: f64,
    /// Duration of the buffer, seconds.
    pub buffer_s: f64,
}

impl Plan {
    /// Reads the settings.
    pub fn new(settings: &Settings) -> Self {
        Self {
            gain: settings.number("gain"),
            block_s: settings.number("block_ms") / 1e3,
            buffer_s: settings.number("buffer_ms") / 1e3,
        }
    }

    /// Returns the number of samples in a block at a rate.
    pub fn block_frames(&self, rate_hz: f64) -> usize {
        (self.block_s * rate_hz).round().max(1.0) as usize
    }

    /// Returns the capabilities of a device with a motor: the device takes samples of sound at the
    /// pace of a clock.
    pub fn capabilities(&self) -> Capabilities {
        Capabilities {
            quantity: Quantity::Sound,
            rates: Rates::Range { min_hz: RATES_HZ.0, max_hz: RATES_HZ.1 },
            default_rate_hz: DEFAULT_RATE_HZ,
            limit: Some(1.0),
            step: None,
            carrier_hz: None,
            paced: true,
            block_frames: self.block_frames(DEFAULT_RATE_HZ) as u32,
        }
    }
}
