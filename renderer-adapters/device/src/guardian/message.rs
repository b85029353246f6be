//! The messages between an app and its guardian: each message consists of one byte, a length, and a
//! body.

use std::io::{Read, Write};

use crate::DeviceError;
use serde::{Deserialize, Serialize};

/// Longest message, bytes: about one second of `f32` samples at a million samples per second.
pub(crate) const LONGEST: u32 = 4 << 20;

/// Maximum number of samples in a request.
pub(crate) const MOST_SAMPLES: usize = 1 << 16;

/// The first message of the app.
#[derive(Serialize, Deserialize)]
pub(crate) struct Opening {
    pub(crate) device: String,
    pub(crate) settings: String,
    pub(crate) rate_hz: f64,
    pub(crate) block_frames: u32,
}

/// Replies of the guardian.
#[derive(Serialize, Deserialize)]
pub(crate) enum Answer {
    Done(u64),
    Status([f64; 5]),
    Failed(String),
    /// The device had no more samples to play ([`DeviceError::Underflow`]).
    Dry {
        device: String,
        frames: u64,
        advice: String,
    },
}

impl Answer {
    /// Converts an error to an answer with its message. If a device ran dry, the answer keeps all
    /// details, because the app may try again.
    pub(crate) fn of_error(error: DeviceError) -> Self {
        match error {
            DeviceError::Underflow { device, frames, advice } => {
                Self::Dry { device, frames, advice }
            }
            error => Self::Failed(error.to_string()),
        }
    }
}

/// Requests of the app, one byte each. A write request has the timeout in milliseconds, then the
/// samples.
pub(crate) const OPEN: u8 = b'o';
pub(crate) const WRITE: u8 = b'w';
pub(crate) const STATUS: u8 = b's';
pub(crate) const FINISH: u8 = b'f';
pub(crate) const ABORT: u8 = b'a';

pub(crate) fn put(to: &mut impl Write, tag: u8, body: &[u8]) -> std::io::Result<()> {
    to.write_all(&[tag])?;
    to.write_all(&(body.len() as u32).to_le_bytes())?;
    to.write_all(body)?;
    to.flush()
}

pub(crate) fn read_message(from: &mut impl Read) -> std::io::Result<(u8, Vec<u8>)> {
    let mut head = [0; 5];
    from.read_exact(&mut head)?;
    let [tag, a, b, c, d] = head;
    let length = u32::from_le_bytes([a, b, c, d]);
    // A wrong length must not allocate gigabytes.
    if length > LONGEST {
        return Err(std::io::Error::other("a message is too long"));
    }
    let mut body = vec![0; length as usize];
    from.read_exact(&mut body)?;
    Ok((tag, body))
}
