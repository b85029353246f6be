//! A task of the driver on analog inputs.
#![allow(unsafe_code)] // The driver's functions are C.

use std::ptr::{null, null_mut};

use super::Driver;
use super::table::{Handle, c_text};
use crate::fault::Fault;

// Constants of `NIDAQmx.h`.
const VOLTS: i32 = 10348;
const RISING: i32 = 10280;
const CONTINUOUS: i32 = 10123;
const GROUP_BY_SCAN_NUMBER: u32 = 1;

/// How inputs are wired; the numbers are those of `NIDAQmx.h`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Terminals {
    Default = -1,
    NonReferenced = 10078,
    Referenced = 10083,
    Differential = 10106,
    PseudoDifferential = 12529,
}

/// Stopped and cleared when dropped.
pub(crate) struct InputTask {
    driver: &'static Driver,
    handle: Handle,
    width: usize,
}

// SAFETY: NI-DAQmx may be called from any thread, and one handle is used by one thread at a time.
unsafe impl Send for InputTask {}

impl InputTask {
    /// A task on `width` inputs of a range of ±`range_v`.
    pub(crate) fn new(
        driver: &'static Driver,
        channels: &str,
        width: usize,
        terminals: Terminals,
        range_v: f64,
    ) -> Result<Self, Fault> {
        let handle = driver.table.new_task()?;
        let task = Self {
            driver,
            handle,
            width,
        };
        let (channels, names) = (c_text(channels), c_text(""));
        // SAFETY: strings that end in zero; no custom scale.
        task.check(unsafe {
            let (channels, names, terminals) =
                (channels.as_ptr(), names.as_ptr(), terminals as i32);
            (driver.table.create_input)(
                handle,
                channels,
                names,
                terminals,
                -range_v,
                range_v,
                VOLTS,
                null(),
            )
        })?;
        Ok(task)
    }

    /// Lets the card's own clock sample into a buffer of `frames`.
    pub(crate) fn set_clock(&self, rate_hz: f64, frames: u32) -> Result<(), Fault> {
        let (table, source) = (&self.driver.table, c_text(""));
        // SAFETY: a string that ends in zero: the card's own clock.
        self.check(unsafe {
            let (source, count) = (source.as_ptr(), u64::from(frames));
            (table.set_clock)(self.handle, source, rate_hz, RISING, CONTINUOUS, count)
        })?;
        // SAFETY: numbers only.
        self.check(unsafe { (table.set_input_buffer)(self.handle, frames) })
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

    /// Frames that can be read now.
    pub(crate) fn available(&self) -> Result<usize, Fault> {
        let mut frames = 0u32;
        // SAFETY: a place for one number.
        self.check(unsafe { (self.driver.table.get_available)(self.handle, &mut frames) })?;
        Ok(frames as usize)
    }

    /// Reads so many frames, which are available; returns their number. `samples` has space for them.
    pub(crate) fn read(&self, frames: usize, samples: &mut [f64]) -> Result<usize, Fault> {
        let frames = frames.min(samples.len() / self.width);
        let count = i32::try_from(frames).unwrap_or(i32::MAX);
        let space = u32::try_from(samples.len()).unwrap_or(u32::MAX);
        let (now_s, mut read) = (0.0, 0i32);
        // SAFETY: space for that many samples, a place for the count, and the reserved argument.
        self.check(unsafe {
            (self.driver.table.read_samples)(
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

    fn check(&self, code: i32) -> Result<(), Fault> {
        self.driver.table.check(code)
    }
}

impl Drop for InputTask {
    fn drop(&mut self) {
        // SAFETY: the handle is this task's, and used nowhere after this.
        unsafe {
            (self.driver.table.stop_task)(self.handle);
            (self.driver.table.clear_task)(self.handle);
        }
    }
}
