//! What a device can do.

use serde::{Deserialize, Serialize};

/// What a device can do; crosses the ABI as JSON.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Capabilities {
    /// What its samples mean.
    pub quantity: Quantity,
    /// Rates it runs at.
    pub rates: Rates,
    /// The rate it runs at best, hertz.
    pub default_rate_hz: f64,
    /// Largest magnitude it takes, in the quantity's unit; absent: no limit. A voltage always has
    /// one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub limit: Option<f64>,
    /// Distance of two neighbouring values it can put out, in the quantity's unit; absent: floats.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub step: Option<f64>,
    /// Frequency of the carrier that an electrovibration display wants, hertz.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub carrier_hz: Option<f64>,
    /// A clock takes the samples; else they go as fast as they are made (a file).
    pub paced: bool,
    /// Frames a block is best made of.
    pub block_frames: u32,
}

/// What a device's samples mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// Lateral force on the finger, newtons.
    LateralForce,
    /// Voltage at an electrovibration display, volts: the friction it adds goes with its square.
    DisplayVoltage,
    /// Sound; 1 is full scale.
    Sound,
}

impl Quantity {
    /// Symbol of the unit; `FS` is full scale.
    pub fn unit(self) -> &'static str {
        match self {
            Self::LateralForce => "N",
            Self::DisplayVoltage => "V",
            Self::Sound => "FS",
        }
    }
}

/// The rates a device runs at, hertz.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Rates {
    /// Just these, ascending.
    List(Vec<f64>),
    /// All in between, both ends included.
    Range {
        /// Lowest.
        min_hz: f64,
        /// Highest.
        max_hz: f64,
    },
}

impl Rates {
    /// Whether the device runs at `rate_hz`.
    pub fn has(&self, rate_hz: f64) -> bool {
        match self {
            Self::List(all) => all.contains(&rate_hz),
            Self::Range { min_hz, max_hz } => (*min_hz..=*max_hz).contains(&rate_hz),
        }
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
