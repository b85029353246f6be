//! A driver task on one analog output.
#![allow(unsafe_code)] // The driver's functions are C.

use std::ops::Deref;
use std::ptr::{null, null_mut};

use super::Driver;
use super::clocked::{Clocked, VOLTS};
use super::table::c_text;
use crate::daq::fault::Fault;

// Constants from `NIDAQmx.h`.
const DO_NOT_ALLOW_REGENERATION: i32 = 10158;
// A task has one channel, for which both groupings are the same.
const GROUP_BY_CHANNEL: u32 = 0;
/// Status when the buffer is full. The samples that fitted were taken.
const NOT_YET: i32 = -200292;

/// A task on one analog output. Dropping it stops and clears it; the output then holds its last
/// voltage.
pub(crate) struct Task {
    task: Clocked,
}

impl Task {
    /// Creates a task that outputs samples at once, within ±`limit_v`. Voltages are at the card's
    /// output.
    pub(crate) fn new(driver: &'static Driver, output: &str, limit_v: f64) -> Result<Self, Fault> {
        let task = Clocked::new(driver)?;
        let (output, name) = (c_text(output), c_text(""));
        // SAFETY: strings that end in zero; no custom scale.
        task.check(unsafe {
            let (output, name) = (output.as_ptr(), name.as_ptr());
            (task.table().create_voltage)(
                task.handle,
                output,
                name,
                -limit_v,
                limit_v,
                VOLTS,
                null(),
            )
        })?;
        Ok(Self { task })
    }

    /// Makes a clock take each sample once from a buffer of `frames`.
    pub(crate) fn set_clock(&self, rate_hz: f64, frames: u32) -> Result<(), Fault> {
        self.set_card_clock(rate_hz, frames)?;
        // SAFETY: numbers only.
        self.check(unsafe { (self.table().set_buffer)(self.handle, frames) })?;
        // Otherwise the card plays the old samples of its buffer again when the host is late.
        // SAFETY: numbers only.
        self.check(unsafe {
            (self.table().set_regeneration)(self.handle, DO_NOT_ALLOW_REGENERATION)
        })
    }

    /// Takes the samples (volts) that fit now and returns their number. `start` starts a task that
    /// has no clock.
    pub(crate) fn write(&self, samples: &[f64], start: bool) -> Result<usize, Fault> {
        let count = i32::try_from(samples.len()).unwrap_or(i32::MAX);
        let (now_s, mut written) = (0.0, 0i32);
        // SAFETY: that many samples, a place for the count, and the reserved argument.
        let code = unsafe {
            (self.table().write_samples)(
                self.handle,
                count,
                u32::from(start),
                now_s,
                GROUP_BY_CHANNEL,
                samples.as_ptr(),
                &mut written,
                null_mut(),
            )
        };
        if code != NOT_YET {
            self.check(code)?;
        }
        Ok(usize::try_from(written).unwrap_or(0).min(samples.len()))
    }

    /// Returns the free space in frames. Works only while the task runs.
    pub(crate) fn space(&self) -> Result<usize, Fault> {
        let mut space = 0u32;
        // SAFETY: a place for one number.
        self.check(unsafe { (self.table().get_space)(self.handle, &mut space) })?;
        Ok(space as usize)
    }

    /// Returns the number of frames output since the start.
    pub(crate) fn generated(&self) -> Result<u64, Fault> {
        let mut frames = 0u64;
        // SAFETY: a place for one number.
        self.check(unsafe { (self.table().get_generated)(self.handle, &mut frames) })?;
        Ok(frames)
    }

    /// Whether the task stopped by itself. Returns the error that stopped it, if any.
    pub(crate) fn is_done(&self) -> Result<bool, Fault> {
        let mut done = 0u32;
        // SAFETY: a place for one truth value.
        self.check(unsafe { (self.table().is_done)(self.handle, &mut done) })?;
        Ok(done != 0)
    }
}

impl Deref for Task {
    type Target = Clocked;

    fn deref(&self) -> &Clocked {
        &self.task
    }
}
