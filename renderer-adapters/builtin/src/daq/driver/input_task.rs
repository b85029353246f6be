//! A driver task on analog inputs.
#![allow(unsafe_code)] // The driver's functions are C.

use std::ops::Deref;
use std::ptr::{null, null_mut};

use super::Driver;
use super::clocked::{Clocked, VOLTS};
use super::table::c_text;
use crate::daq::fault::Fault;

// Constants from `NIDAQmx.h`.
const GROUP_BY_SCAN_NUMBER: u32 = 1;

/// How inputs are wired. The numbers are from `NIDAQmx.h`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Terminals {
    Default = -1,
    NonReferenced = 10078,
    Referenced = 10083,
    Differential = 10106,
    PseudoDifferential = 12529,
}

/// A task on analog inputs. Dropping it stops and clears it.
pub(crate) struct InputTask {
    task: Clocked,
    width: usize,
}

impl InputTask {
    /// Creates a task on `width` inputs with a range of ±`range_v`.
    pub(crate) fn new(
        driver: &'static Driver,
        channels: &str,
        width: usize,
        terminals: Terminals,
        range_v: f64,
    ) -> Result<Self, Fault> {
        let task = Clocked::new(driver)?;
        let (channels, names) = (c_text(channels), c_text(""));
        // SAFETY: strings that end in zero; no custom scale.
        task.check(unsafe {
            let (channels, names, terminals) =
                (channels.as_ptr(), names.as_ptr(), terminals as i32);
            (task.table().create_input)(
                task.handle,
                channels,
                names,
                terminals,
                -range_v,
                range_v,
                VOLTS,
                null(),
            )
        })?;
        Ok(Self { task, width })
    }

    /// Makes the card sample at its own clock into a buffer of `frames`.
    pub(crate) fn set_clock(&self, rate_hz: f64, frames: u32) -> Result<(), Fault> {
        self.set_card_clock(rate_hz, frames)?;
        // SAFETY: numbers only.
        self.check(unsafe { (self.table().set_input_buffer)(self.handle, frames) })
    }

    /// Returns the number of frames that can be read now.
    pub(crate) fn available(&self) -> Result<usize, Fault> {
        let mut frames = 0u32;
        // SAFETY: a place for one number.
        self.check(unsafe { (self.table().get_available)(self.handle, &mut frames) })?;
        Ok(frames as usize)
    }

    /// Reads up to `frames` frames, and returns their number. The frames must be available, and
    /// `samples` must have space for them.
    pub(crate) fn read(&self, frames: usize, samples: &mut [f64]) -> Result<usize, Fault> {
        let frames = frames.min(samples.len() / self.width);
        let count = i32::try_from(frames).unwrap_or(i32::MAX);
        let space = u32::try_from(samples.len()).unwrap_or(u32::MAX);
        let (now_s, mut read) = (0.0, 0i32);
        // SAFETY: space for that many samples, a place for the count, and the reserved argument.
        self.check(unsafe {
            (self.table().read_samples)(
                self.handle,
                count,
                now_s,
                GROUP_BY_SCAN_NUMBER,
                samples.as_mut_ptr(),
                space,
                &mut read,
                null_mut(),
            )
        })?;
        Ok(usize::try_from(read).unwrap_or(0).min(frames))
    }
}

impl Deref for InputTask {
    type Target = Clocked;

    fn deref(&self) -> &Clocked {
        &self.task
    }
}
