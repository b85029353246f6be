//! The pieces of recordings: hits or windows, which are averaged or thrown out.
//!
//! A response is an average over pieces. Each piece has a time and, if it is thrown out, a reason.
//! With this information, a person can judge the measurement from the result, without the samples.

use std::fmt;
use std::ops::Range;

use serde::Serialize;

use super::record::Channel;

/// A part of a recording that is transformed to a spectrum: a hit, or a window of a continuous
/// drive.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Piece {
    pub file: String,
    /// Time of the hit's trigger, or of the window's start, in the file, seconds.
    pub time_s: f64,
    /// Largest deviation of the input from its rest level within this part, with its sign, in the
    /// input's unit.
    pub peak: f64,
    /// Why the piece was thrown out; `None` if it is used.
    pub thrown_out: Option<Reason>,
}

/// Why a hit or a window was thrown out.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "snake_case", tag = "reason")]
#[non_exhaustive]
pub enum Reason {
    /// The hammer touched the object a second time before the window ended.
    DoubleHit {
        /// Time of the second contact in the file, seconds.
        second_s: f64,
    },
    /// A channel reached the limit of its sensor or amplifier.
    Overload {
        channel: Channel,
        /// Time of the first sample at the limit in the file, seconds.
        at_s: f64,
        /// Value of this sample, in the channel's unit.
        value: f64,
    },
    /// The recording begins after the start of the window, which lies shortly before the trigger.
    StartsLate,
    /// The recording ends before the end of the window.
    EndsEarly {
        /// Missing time, seconds.
        missing_s: f64,
    },
    /// The RMS of the drive in this window is below a tenth of the RMS in the strongest window.
    Silent,
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::DoubleHit { second_s } => {
                write!(f, "double hit: second contact at {second_s:.4} s, within the window")
            }
            Self::Overload { channel, at_s, value } => {
                write!(f, "overload: the {channel} is at its limit of {value:.4} at {at_s:.4} s")
            }
            Self::StartsLate => {
                f.write_str("cut off: the recording starts within the time before the trigger")
            }
            Self::EndsEarly { missing_s } => {
                write!(f, "cut off: the recording ends {missing_s:.3} s before the window does")
            }
            Self::Silent => {
                f.write_str("silent: the drive is below a tenth of its strongest window")
            }
        }
    }
}

impl Piece {
    /// Returns the place and the reason, if the piece was thrown out.
    pub(crate) fn place_and_reason(&self) -> Option<String> {
        let reason = self.thrown_out.as_ref()?;
        Some(format!("{} at {:.4} s, {reason}", self.file, self.time_s))
    }
}

/// A piece with its samples.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Cut {
    /// Indices of the window's samples. The range extends beyond the recording if the window is cut
    /// off.
    pub(crate) samples: Range<usize>,
    /// Index of the trigger's sample, or of the first sample of a window of a continuous drive.
    pub(crate) trigger: usize,
    pub(crate) piece: Piece,
}
