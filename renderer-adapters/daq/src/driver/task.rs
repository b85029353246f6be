//! A task of the driver on one analog output.
#![allow(unsafe_code)] // The driver's functions are C.

use std::ptr::{null, null_mut};

use super::Driver;
use super::table::{Handle, c_text};
use crate::fault::Fault;

// Constants of `NIDAQmx.h`.
const VOLTS: i32 = 10348;
const RISING: i32 = 10280;
const CONTINUOUS: i32 = 10123;
const DO_NOT_ALLOW_REGENERATION: i32 = 10158;
const GROUP_BY_CHANNEL: u32 = 0;
/// The buffer is full: the samples that fitted were taken.
const NOT_YET: i32 = -200292;

/// Stopped and cleared when dropped; the output then holds its last voltage.
pub(crate) struct Task {
    driver: &'static Driver,
    handle: Handle,
}

// SAFETY: NI-DAQmx may be called from any thread, and one handle is used by one thread at a time.
unsafe impl Send for Task {}

impl Task {
    /// A task that outputs samples at once, within ±`limit_v`; volts of the card.
    pub(crate) fn new(driver: &'static Driver, output: &str, limit_v: f64) -> Result<Self, Fault> {
        let handle = driver.table.new_task()?;
        let task = Self { driver, handle };
        let (output, name) = (c_text(output), c_text(""));
        // SAFETY: strings that end in zero; no custom scale.
        task.check(unsafe {
            let (output, name) = (output.as_ptr(), name.as_ptr());
            (driver.table.create_voltage)(handle, output, name, -limit_v, limit_v, VOLTS, null())
        })?;
        Ok(task)
    }

    /// Lets a clock take the samples, each once, from a buffer of `frames`.
    pub(crate) fn set_clock(&self, rate_hz: f64, frames: u32) -> Result<(), Fault> {
        let (table, source) = (&self.driver.table, c_text(""));
        // SAFETY: a string that ends in zero: the card's own clock.
        self.check(unsafe {
            let (source, count) = (source.as_ptr(), u64::from(frames));
            (table.set_clock)(self.handle, source, rate_hz, RISING, CONTINUOUS, count)
        })?;
        // SAFETY: numbers only.
        self.check(unsafe { (table.set_buffer)(self.handle, frames) })?;
        // SAFETY: numbers only.
        self.check(unsafe { (table.set_regeneration)(self.handle, DO_NOT_ALLOW_REGENERATION) })
    }

    pub(crate) fn start(&self) -> Result<(), Fault> {
        // SAFETY: the handle is this task's.
        self.check(unsafe { (self.driver.table.start_task)(self.handle) })
    }

    /// Stops the task; returns the error that it had.
    pub(crate) fn stop(&self) -> Result<(), Fault> {
        // SAFETY: the handle is this task's.
        self.check(unsafe { (self.driver.table.stop_task)(self.handle) })
    }

    /// Takes the samples that fit now, volts; returns their number. `start` starts a task without a
    /// clock.
    pub(crate) fn write(&self, samples: &[f64], start: bool) -> Result<usize, Fault> {
        let count = i32::try_from(samples.len()).unwrap_or(i32::MAX);
        let (now_s, mut written) = (0.0, 0i32);
        // SAFETY: that many samples, a place for the count, and the reserved argument.
        let code = unsafe {
            (self.driver.table.write_samples)(
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

    /// Frames of free space; only while the task runs.
    pub(crate) fn space(&self) -> Result<usize, Fault> {
        let mut space = 0u32;
        // SAFETY: a place for one number.
        self.check(unsafe { (self.driver.table.get_space)(self.handle, &mut space) })?;
        Ok(space as usize)
    }

    /// Frames that came out since the start.
    pub(crate) fn generated(&self) -> Result<u64, Fault> {
        let mut frames = 0u64;
        // SAFETY: a place for one number.
        self.check(unsafe { (self.driver.table.get_generated)(self.handle, &mut frames) })?;
        Ok(frames)
    }

    /// Whether the task stopped by itself; the error that stopped it, if any.
    pub(crate) fn is_done(&self) -> Result<bool, Fault> {
        let mut done = 0u32;
        // SAFETY: a place for one truth value.
        self.check(unsafe { (self.driver.table.is_done)(self.handle, &mut done) })?;
        Ok(done != 0)
    }

    fn check(&self, code: i32) -> Result<(), Fault> {
        self.driver.table.check(code)
    }
}

impl Drop for Task {
    fn drop(&mut self) {
        // SAFETY: the handle is this task's, and used nowhere after this.
        unsafe {
            (self.driver.table.stop_task)(self.handle);
            (self.driver.table.clear_task)(self.handle);
        }
    }
}
