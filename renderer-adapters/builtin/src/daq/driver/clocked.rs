//! The common part of output tasks and input tasks: the handle, the clock, start and stop.
#![allow(unsafe_code)] // The driver's functions are C.

use super::Driver;
use super::table::{Handle, Table, c_text};
use crate::daq::fault::Fault;

// Constants from `NIDAQmx.h`.
pub(super) const VOLTS: i32 = 10348;
const RISING: i32 = 10280;
const CONTINUOUS: i32 = 10123;

/// A driver task. It has no channels at first. Dropping the task stops and clears it.
pub(crate) struct Clocked {
    driver: &'static Driver,
    pub(super) handle: Handle,
}

// SAFETY: NI-DAQmx may be called from any thread, and one handle is used by one thread at a time.
unsafe impl Send for Clocked {}

impl Clocked {
    pub(super) fn new(driver: &'static Driver) -> Result<Self, Fault> {
        let handle = driver.table.new_task()?;
        Ok(Self { driver, handle })
    }

    pub(super) fn table(&self) -> &'static Table {
        &self.driver.table
    }

    /// Makes the card's own clock take or deliver samples continuously, through a buffer of
    /// `frames`.
    pub(super) fn set_card_clock(&self, rate_hz: f64, frames: u32) -> Result<(), Fault> {
        let source = c_text("");
        // SAFETY: a string that ends in zero: the card's own clock.
        self.check(unsafe {
            let (source, count) = (source.as_ptr(), u64::from(frames));
            (self.table().set_clock)(self.handle, source, rate_hz, RISING, CONTINUOUS, count)
        })
    }

    pub(crate) fn start(&self) -> Result<(), Fault> {
        // SAFETY: the handle is this task's.
        self.check(unsafe { (self.table().start_task)(self.handle) })
    }

    /// Stops the task. If the task had failed, returns its error.
    pub(crate) fn stop(&self) -> Result<(), Fault> {
        // SAFETY: the handle is this task's.
        self.check(unsafe { (self.table().stop_task)(self.handle) })
    }

    /// Returns a handle with which another thread can stop this task while a call of the task
    /// hangs.
    pub(crate) fn stopper(&self) -> Stopper {
        Stopper { driver: self.driver, handle: self.handle }
    }

    pub(super) fn check(&self, code: i32) -> Result<(), Fault> {
        self.table().check(code)
    }
}

/// Stops a task that has not been cleared.
pub(crate) struct Stopper {
    driver: &'static Driver,
    handle: Handle,
}

// SAFETY: NI-DAQmx may be called from any thread, also to stop a task while another thread is in a
// call of this task.
unsafe impl Send for Stopper {}

impl Stopper {
    /// Stops the task. The task outputs nothing more, but its last voltage stays at the output.
    pub(crate) fn stop(&self) {
        // SAFETY: the handle comes from this driver, and the driver checks the handles that it is
        // given. The owner of the task drops this value before it clears the task.
        unsafe { (self.driver.table.stop_task)(self.handle) };
    }
}

impl Drop for Clocked {
    fn drop(&mut self) {
        // SAFETY: the handle is this task's, and used nowhere after this.
        unsafe {
            (self.table().stop_task)(self.handle);
            (self.table().clear_task)(self.handle);
        }
    }
}
