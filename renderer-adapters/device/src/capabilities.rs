//! Capabilities of an output.

use serde::{Deserialize, Deserializer, Serialize};

use crate::DeviceError;
use crate::abi::{MAX_BLOCK_FRAMES, MAX_RATE_HZ, MIN_RATE_HZ};

/// Lowest sample rate of a display, as a multiple of its carrier frequency. At a lower rate, the
/// carrier could alias to a slow or direct voltage.
pub const RATE_PER_CARRIER: f64 = 2.5;

/// Capabilities of an output. A native library passes its capabilities to the host as JSON.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(
    feature = "schemars",
    derive(schemars::JsonSchema),
    schemars(
        extend("if" = {
            "properties": { "quantity": { "const": "display_voltage" } }, "required": ["quantity"]
        }),
        extend("then" = { "required": ["limit"] })
    )
)]
pub struct Capabilities {
    /// The physical quantity of the samples.
    pub quantity: Quantity,
    /// The supported sample rates.
    pub rates: Rates,
    /// Default sample rate, hertz.
    #[cfg_attr(feature = "schemars", schemars(range(min = MIN_RATE_HZ, max = MAX_RATE_HZ)))]
    pub default_rate_hz: f64,
    /// Largest magnitude of a sample that the output accepts, in the quantity's unit. If absent,
    /// there is no limit. A display voltage must have a limit.
    #[serde(default, skip_serializing_if = "Option::is_none", deserialize_with = "present")]
    #[cfg_attr(feature = "schemars", schemars(with = "f64", extend("exclusiveMinimum" = 0)))]
    pub limit: Option<f64>,
    /// Step between two adjacent output values, in the quantity's unit. If absent, the output takes
    /// floating-point values.
    #[serde(default, skip_serializing_if = "Option::is_none", deserialize_with = "present")]
    #[cfg_attr(feature = "schemars", schemars(with = "f64", extend("exclusiveMinimum" = 0)))]
    pub step: Option<f64>,
    /// Frequency of the carrier that an electrovibration display needs, hertz.
    #[serde(default, skip_serializing_if = "Option::is_none", deserialize_with = "present")]
    #[cfg_attr(feature = "schemars", schemars(with = "f64", extend("exclusiveMinimum" = 0)))]
    pub carrier_hz: Option<f64>,
    /// True if the output takes samples at the pace of a clock. False if the output takes samples
    /// as fast as they are generated, as a file does.
    pub paced: bool,
    /// Preferred block size, frames.
    #[cfg_attr(feature = "schemars", schemars(range(min = 1, max = MAX_BLOCK_FRAMES)))]
    pub block_frames: u32,
}

/// Reads a number that may be absent, but not `null`.
fn present<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<f64>, D::Error> {
    f64::deserialize(deserializer).map(Some)
}

impl Capabilities {
    /// Checks that the numbers are in range and do not contradict each other.
    ///
    /// # Errors
    /// [`DeviceError::Invalid`] with the first fault.
    pub fn check(&self) -> Result<(), DeviceError> {
        self.first_fault()
            .map_or(Ok(()), |what| Err(DeviceError::Invalid { document: "capabilities", what }))
    }

    fn first_fault(&self) -> Option<String> {
        let Self { rates, default_rate_hz, .. } = self;
        if !rates.are_sane() {
            return Some(format!(
                "rates must ascend, from {MIN_RATE_HZ} to {MAX_RATE_HZ} Hz, and there must be one"
            ));
        }
        if !rates.has(*default_rate_hz) {
            return Some(format!(
                "the default rate of {default_rate_hz} Hz is not one of its rates"
            ));
        }
        if self.quantity == Quantity::DisplayVoltage && self.limit.is_none() {
            return Some("a voltage without a limit".to_owned());
        }
        let numbers = [("limit", self.limit), ("step", self.step), ("carrier_hz", self.carrier_hz)];
        let is_bad = |number: Option<f64>| number.is_some_and(|x| !(x.is_finite() && x > 0.0));
        if let Some((name, _)) = numbers.into_iter().find(|(_, number)| is_bad(*number)) {
            return Some(format!("`{name}` must be finite and greater than 0"));
        }
        if !(1..=MAX_BLOCK_FRAMES).contains(&self.block_frames) {
            return Some(format!("`block_frames` must be 1 to {MAX_BLOCK_FRAMES}"));
        }
        None
    }

    /// Returns the lowest rate that can represent the carrier, hertz. Returns 0 if there is no
    /// carrier.
    pub(crate) fn lowest_with_carrier_hz(&self) -> f64 {
        self.carrier_hz.map_or(0.0, |hz| RATE_PER_CARRIER * hz)
    }

    /// Whether the device supports this rate and the rate is high enough for the carrier.
    pub fn has_rate(&self, rate_hz: f64) -> bool {
        self.rates.has(rate_hz) && rate_hz >= self.lowest_with_carrier_hz()
    }

    /// Returns the supported rates as text for a message, including the lowest rate that the
    /// carrier allows.
    pub fn rates_text(&self) -> String {
        match self.carrier_hz {
            Some(hz) => format!(
                "{}, and at least at {RATE_PER_CARRIER} times its carrier of {hz} Hz",
                self.rates
            ),
            None => self.rates.to_string(),
        }
    }

    /// Checks that each sample is a number within the limit. The limit is first rounded to the
    /// nearest `f32`. `first_frame` is the index of the first sample of `samples`, counted since
    /// the device was opened.
    ///
    /// # Errors
    /// Returns [`DeviceError::OverLimit`] for the first sample that is over the limit or not a
    /// number.
    pub fn check_samples(&self, samples: &[f32], first_frame: u64) -> Result<(), DeviceError> {
        // Without a limit, only NaN and infinity are refused.
        let limit = self.limit.map_or(f32::MAX, |limit| limit as f32);
        // The condition is negated so that NaN counts as over the limit.
        let over = |sample: &f32| !(0.0..=limit).contains(&sample.abs());
        // No early exit, so that the compiler can vectorize the loop.
        if !samples.iter().fold(false, |any, sample| any | over(sample)) {
            return Ok(());
        }
        let at = samples.iter().position(over).unwrap_or_default();
        Err(DeviceError::OverLimit {
            frame: first_frame + at as u64,
            value: f64::from(samples[at]),
            limit: self.limit.unwrap_or(f64::from(f32::MAX)),
            unit: self.quantity.unit(),
        })
    }
}

/// The quantity of a device's samples, which determines their unit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// Lateral force on the finger, newtons.
    LateralForce,
    /// Normal force on the finger, newtons.
    NormalForce,
    /// Acceleration of the finger or tool, m/s².
    Acceleration,
    /// Velocity of the finger or tool, m/s.
    Velocity,
    /// Displacement of the finger or tool, metres.
    Displacement,
    /// Voltage at an electrovibration display, volts. The friction that the display adds is
    /// proportional to the square of the voltage.
    DisplayVoltage,
    /// Sound, where 1 is full scale.
    Sound,
}

impl Quantity {
    /// All quantities.
    pub const ALL: [Self; 7] = [
        Self::LateralForce,
        Self::NormalForce,
        Self::Acceleration,
        Self::Velocity,
        Self::Displacement,
        Self::DisplayVoltage,
        Self::Sound,
    ];

    /// Returns the name used in the capabilities.
    pub fn name(self) -> &'static str {
        match self {
            Self::LateralForce => "lateral_force",
            Self::NormalForce => "normal_force",
            Self::Acceleration => "acceleration",
            Self::Velocity => "velocity",
            Self::Displacement => "displacement",
            Self::DisplayVoltage => "display_voltage",
            Self::Sound => "sound",
        }
    }

    /// Whether the samples are a mechanical quantity in an SI unit. Textures of a mechanical
    /// quantity are played at their own level, without scaling.
    pub fn is_physical(self) -> bool {
        !matches!(self, Self::DisplayVoltage | Self::Sound)
    }

    /// Returns the symbol of the unit. `FS` is full scale.
    pub fn unit(self) -> &'static str {
        match self {
            Self::LateralForce | Self::NormalForce => "N",
            Self::Acceleration => "m/s2",
            Self::Velocity => "m/s",
            Self::Displacement => "m",
            Self::DisplayVoltage => "V",
            Self::Sound => "FS",
        }
    }
}

/// The sample rates that a device supports, hertz.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Rates {
    /// Only the listed rates, in ascending order.
    List(
        #[cfg_attr(
            feature = "schemars",
            schemars(length(min = 1), inner(range(min = MIN_RATE_HZ, max = MAX_RATE_HZ)))
        )]
        Vec<f64>,
    ),
    /// All rates in a range, both ends included.
    Range {
        /// Lowest.
        #[cfg_attr(feature = "schemars", schemars(range(min = MIN_RATE_HZ, max = MAX_RATE_HZ)))]
        min_hz: f64,
        /// Highest.
        #[cfg_attr(feature = "schemars", schemars(range(min = MIN_RATE_HZ, max = MAX_RATE_HZ)))]
        max_hz: f64,
    },
}

impl Rates {
    /// Whether the device supports `rate_hz`.
    pub fn has(&self, rate_hz: f64) -> bool {
        match self {
            Self::List(all) => all.contains(&rate_hz),
            Self::Range { min_hz, max_hz } => (*min_hz..=*max_hz).contains(&rate_hz),
        }
    }

    fn are_sane(&self) -> bool {
        let (all, ascending) = match self {
            Self::List(all) => (all.clone(), all.is_sorted_by(|a, b| a < b)),
            Self::Range { min_hz, max_hz } => (vec![*min_hz, *max_hz], min_hz <= max_hz),
        };
        let sane = |hz: &f64| (MIN_RATE_HZ..=MAX_RATE_HZ).contains(hz);
        !all.is_empty() && ascending && all.iter().all(sane)
    }
}

impl std::fmt::Display for Rates {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::List(all) => {
                let all: Vec<String> = all.iter().map(ToString::to_string).collect();
                write!(f, "{} Hz", all.join(", "))
            }
            Self::Range { min_hz, max_hz } => write!(f, "{min_hz} to {max_hz} Hz"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sane() -> Capabilities {
        Capabilities {
            quantity: Quantity::LateralForce,
            rates: Rates::List(vec![8000.0, 48_000.0]),
            default_rate_hz: 8000.0,
            limit: Some(0.1),
            step: None,
            carrier_hz: None,
            paced: false,
            block_frames: 64,
        }
    }

    #[test]
    fn contradictions_are_found() {
        assert_eq!(sane().check(), Ok(()));
        let wrong: [fn(&mut Capabilities); 8] = [
            |c| c.default_rate_hz = 9000.0,
            |c| c.rates = Rates::List(vec![]),
            |c| c.rates = Rates::List(vec![8000.0, 8000.0]),
            |c| c.rates = Rates::Range { min_hz: f64::NAN, max_hz: 1e4 },
            |c| (c.quantity, c.limit) = (Quantity::DisplayVoltage, None),
            |c| c.limit = Some(f64::INFINITY),
            |c| c.step = Some(0.0),
            |c| c.block_frames = 0,
        ];
        for (i, break_it) in wrong.iter().enumerate() {
            let mut broken = sane();
            break_it(&mut broken);
            assert!(broken.check().is_err(), "{i}");
        }
    }

    #[test]
    fn the_first_sample_over_the_limit_is_named() {
        // 0.1 as `f32` is a little more than 0.1. It must still be allowed.
        assert_eq!(sane().check_samples(&[0.1, -0.1], 7), Ok(()));
        for bad in [0.1001, -0.2, f32::NAN, f32::INFINITY] {
            let error = sane().check_samples(&[0.0, bad, bad], 7);
            assert!(matches!(error, Err(DeviceError::OverLimit { frame: 8, .. })));
        }
        let unlimited = Capabilities { limit: None, ..sane() };
        assert_eq!(unlimited.check_samples(&[1e30], 0), Ok(()));
        assert!(unlimited.check_samples(&[f32::NAN], 0).is_err());
    }
}
