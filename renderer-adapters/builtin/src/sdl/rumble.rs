//! The motors of an open gamepad.
#![allow(unsafe_code)] // The library's functions are C.

use crate::motor::{Block, Motor, Plan};
use htex_device::DeviceError;
use htex_dsp::reduced::{Scale, two_motors};

use crate::driver::Claim;
use crate::sdl::driver::Driver;
use crate::sdl::pads::Pad;
use crate::sdl::table::Handle;

/// Number of blocks for which a strength holds if no other strength follows.
pub(crate) const HOLD_BLOCKS: f64 = 10.0;

pub(crate) struct Rumble {
    driver: &'static Driver,
    handle: Handle,
    scale: Scale,
    hold_ms: u32,
    _claim: Claim,
}

// SAFETY: SDL's joystick functions take a lock, so any thread may call them; only one thread at a
// time has this value.
unsafe impl Send for Rumble {}

impl Rumble {
    /// Opens a gamepad. Its motors are at rest.
    pub(crate) fn open(
        driver: &'static Driver,
        pad: &Pad,
        plan: &Plan,
    ) -> Result<Self, DeviceError> {
        let claim = Claim::reserve(["sdl", &driver.path, &pad.instance.to_string()], &pad.name)?;
        let sdl = &driver.table;
        // SAFETY: the index comes from the list of gamepads; SDL refuses an index that is no longer
        // in the list.
        let handle = unsafe { (sdl.open)(pad.index) };
        if handle.is_null() {
            let reason = sdl.reason();
            return Err(DeviceError::Missing(format!("{} cannot be opened: {reason}", pad.name)));
        }
        let rumble = Self {
            driver,
            handle,
            // `two_motors` has its own frequencies, so the range is not used.
            scale: Scale { gain: plan.gain, low_hz: 0.0, high_hz: 0.0 },
            hold_ms: (HOLD_BLOCKS * plan.block_s * 1e3) as u32,
            _claim: claim,
        };
        // SAFETY: the handle is open.
        if unsafe { (sdl.has_rumble)(handle) } == 0 {
            return Err(DeviceError::Missing(format!(
                "{} has no motors that SDL can reach",
                pad.name
            )));
        }
        Ok(rumble)
    }

    fn tell(&self, strengths: [f64; 2], hold_ms: u32) -> Result<(), String> {
        let sdl = &self.driver.table;
        let [large, small] = strengths.map(|strength| (65_535.0 * strength).round() as u16);
        // SAFETY: the handle is open.
        let code = unsafe { (sdl.rumble)(self.handle, large, small, hold_ms) };
        match code {
            0 => Ok(()),
            _ => Err(format!("its motors cannot be told: {}", sdl.reason())),
        }
    }
}

impl Motor for Rumble {
    fn play(&mut self, block: &Block<'_>) -> Result<(), String> {
        let sdl = &self.driver.table;
        // SAFETY: the handle is open.
        let attached = unsafe {
            // SDL notices only in an update that a gamepad was disconnected.
            (sdl.update)();
            (sdl.attached)(self.handle)
        };
        if attached == 0 {
            return Err("it was disconnected".to_owned());
        }
        let strength = self.scale.strength(block.measured.level_rms);
        self.tell(two_motors(strength, block.measured.centroid_hz), self.hold_ms)
    }

    fn end(&mut self) -> Result<(), String> {
        self.stop()
    }

    fn stop(&mut self) -> Result<(), String> {
        self.tell([0.0; 2], 0)
    }
}

impl Drop for Rumble {
    fn drop(&mut self) {
        // SAFETY: the handle is open, and not used afterwards.
        unsafe { (self.driver.table.close)(self.handle) };
    }
}
