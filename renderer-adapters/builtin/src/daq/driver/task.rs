//! A task of the NI-DAQmx driver on one analog output.
#![allow(unsafe_code)] // The driver's functions are C.

use std::ops::Deref;
use std::ptr::{null, null_mut};

use super::Driver;
use super::clocked::{Clocked, VOLTS};
use super::table::c_text;
use crate::daq::fault::Fault;

// Constants from `NIDAQmx.h`.
const DO_NOT_ALLOW_REGENERATION: i32 = 10158;
// A task has one channel, so both groupings have the same effect.
const GROUP_BY_CHANNEL: u32 = 0;
/// Status if the buffer is full. The driver has then taken the samples that fitted.
const NOT_YET: i32 = -200292;

/// A task on one analog output. Dropping the task stops and clears it. The output then holds its
/// last voltage.
pub(crate) struct Task {
    task: Clocked,
}

impl Task {
    /// Creates a task without a clock, which outputs samples at once. Voltages are at the card's
    /// output, within ±`limit_v`.
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

    /// Makes the card's clock take each sample once from a buffer of `frames`.
    pub(crate) fn set_clock(&self, rate_hz: f64, frames: u32) -> Result<(), Fault> {
        self.set_card_clock(rate_hz, frames)?;
        // SAFETY: numbers only.
        self.check(unsafe { (self.table().set_buffer)(self.handle, frames) })?;
        // Otherwise the card would repeat the old samples in its buffer when the host is late.
        // SAFETY: numbers only.
        self.check(unsafe {
            (self.table().set_regeneration)(self.handle, DO_NOT_ALLOW_REGENERATION)
        })
    }

    /// Takes the samples (volts) that fit now, and returns their number. If `start` is true, a task
    /// without a clock starts.
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

    /// Returns the number of frames that were output since the start.
    pub(crate) fn generated(&self) -> Result<u64, Fault> {
        let mut frames = 0u64;
        // SAFETY: a place for one number.
        self.check(unsafe { (self.table().get_generated)(self.handle, &mut frames) })?;
        Ok(frames)
    }

    /// Whether the task stopped by itself. If an error stopped it, returns the error.
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
