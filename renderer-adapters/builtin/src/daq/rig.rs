//! The rig that the settings describe: card, amplifier and limits.

use htex_device::{
    Capabilities, DIRECT_SETTING, DeviceError, Quantity, RATE_PER_CARRIER, Rates, Settings,
};

use crate::daq::driver::Driver;

/// Default rate, hertz: the rate at which the paper records forces. The paper states no output
/// rate.
const DEFAULT_RATE_HZ: f64 = 20_000.0;
/// Lowest rate, hertz. Frequencies of textures reach 1000 Hz. At the lowest rate, a control block
/// of eight frames takes 8 ms. At much lower rates it would take seconds.
const LOWEST_RATE_HZ: f64 = 1_000.0;
/// Maximum duration of buffer and ramp together, milliseconds. This limit ensures that the output
/// is at zero within half a second after the player is killed.
pub(crate) const MOST_TO_ZERO_MS: f64 = 400.0;
/// Preferred block size, frames.
const BLOCK_FRAMES: u32 = 256;
/// Relative tolerance of the limit, for rounding to `f32`.
const ROUNDING: f64 = 1e-6;

#[derive(Debug, Clone)]
pub(crate) struct Rig {
    /// The output, e.g. `Dev1/ao0`.
    pub(crate) device: String,
    pub(crate) driver: String,
    /// Gain of the amplifier: volts at the display per volt of the card.
    pub(crate) gain: f64,
    /// Limit at the display, volts.
    pub(crate) limit_v: f64,
    /// Step between two adjacent voltages at the display, volts.
    pub(crate) step_v: f64,
    /// Limit of the mean voltage at the display, volts.
    pub(crate) dc_limit_v: f64,
    carrier_hz: f64,
    pub(crate) buffer_s: f64,
    pub(crate) ramp_s: f64,
}

impl Rig {
    pub(crate) fn new(settings: &Settings) -> Result<Self, DeviceError> {
        let gain = settings.number("amplifier_gain");
        let full_scale_v = settings.number("dac_full_scale_v");
        // The setting is a number and may have a fraction.
        let codes = settings.number("dac_bits").floor().exp2();
        let rig = Self {
            device: settings.text("device").to_owned(),
            driver: settings.text("driver").to_owned(),
            gain,
            // The card cannot output more than its full scale, whatever the user allows.
            limit_v: settings.number("limit_v").min(gain * full_scale_v),
            step_v: 2.0 * full_scale_v * gain / codes,
            dc_limit_v: settings.number(DIRECT_SETTING),
            carrier_hz: settings.number("carrier_hz"),
            buffer_s: settings.number("buffer_ms") / 1e3,
            ramp_s: settings.number("ramp_ms") / 1e3,
        };
        let to_zero_ms = 1e3 * (rig.buffer_s + rig.ramp_s);
        match rig.limit_v > 0.0 {
            _ if to_zero_ms > MOST_TO_ZERO_MS * (1.0 + ROUNDING) => Err(DeviceError::setting(
                "buffer_ms",
                format!(
                    "buffer_ms and ramp_ms have at most {MOST_TO_ZERO_MS} ms together, and not {to_zero_ms}: the output must be at \
                     zero within half a second"
                ),
            )),
            _ if !rig.device.contains('/') => Err(DeviceError::setting(
                "device",
                "it must name an analog output, such as `Dev1/ao0`",
            )),
            false => Err(DeviceError::setting("limit_v", "it must be above zero")),
            true => Ok(rig),
        }
    }

    /// Returns the capabilities of the card and the amplifier together.
    pub(crate) fn capabilities(&self, driver: &Driver) -> Result<Capabilities, DeviceError> {
        let card = self.device.split('/').next().unwrap_or_default();
        let outputs = driver.outputs().map_err(|f| f.failed(&self.device))?;
        if !outputs.iter().any(|(name, _)| *name == self.device) {
            let there: Vec<&str> = outputs.iter().map(|(name, _)| &name[..]).collect();
            return Err(DeviceError::Missing(not_there(&self.device, &there)));
        }
        let rates = driver.rates(card).map_err(|f| f.missing(&self.device))?;
        let (min_hz, max_hz) = rates;
        let carried_hz = RATE_PER_CARRIER * self.carrier_hz;
        if carried_hz > max_hz {
            let what = format!(
                "a carrier of {} Hz takes a rate of {carried_hz} Hz or more, and the card has {max_hz} Hz at most",
                self.carrier_hz
            );
            return Err(DeviceError::setting("carrier_hz", what));
        }
        // A slow card may not reach the lowest useful rate.
        let min_hz = min_hz.max(LOWEST_RATE_HZ).max(carried_hz).min(max_hz);
        Ok(Capabilities {
            quantity: Quantity::DisplayVoltage,
            rates: Rates::Range { min_hz, max_hz },
            default_rate_hz: DEFAULT_RATE_HZ.clamp(min_hz, max_hz),
            limit: Some(self.limit_v),
            step: Some(self.step_v),
            carrier_hz: (self.carrier_hz > 0.0).then_some(self.carrier_hz),
            paced: true,
            block_frames: BLOCK_FRAMES,
        })
    }

    /// Returns advice for the case that samples come too late.
    pub(crate) fn larger_buffer(&self) -> String {
        let buffer_ms = self.buffer_s * 1e3;
        let most_ms = MOST_TO_ZERO_MS - self.ramp_s * 1e3;
        format!(
            "write sooner, or give `setting buffer_ms={}` (now {buffer_ms} ms)",
            (2.0 * buffer_ms).min(most_ms)
        )
    }

    /// Converts a voltage at the display to a voltage of the card. Returns `None` if the voltage is
    /// over the limit or not a number.
    pub(crate) fn card_v(&self, display_v: f64) -> Option<f64> {
        let within = display_v.abs() <= self.limit_v * (1.0 + ROUNDING);
        // A voltage within the tolerance is still clamped to the limit.
        within.then(|| display_v.clamp(-self.limit_v, self.limit_v) / self.gain)
    }
}

fn not_there(device: &str, there: &[&str]) -> String {
    if there.is_empty() {
        format!("`{device}` is not connected: NI-DAQmx knows no card; see NI MAX or `nilsdev`")
    } else {
        format!("`{device}` is not connected; connected is {}", there.join(", "))
    }
}
