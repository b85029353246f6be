//! The connected gamepads and joysticks.
#![allow(unsafe_code)] // The library's functions are C.

use htex_device::DeviceError;

use crate::sdl::driver::Driver;
use crate::sdl::table::text;

/// The value of the setting `device` that selects the first gamepad or joystick.
pub(crate) const FIRST: &str = "first";

/// A connected gamepad or joystick.
#[derive(Debug, Clone)]
pub(crate) struct Pad {
    /// SDL's name. A second gamepad of the same name is called `NAME #2`.
    pub(crate) name: String,
    /// The index in SDL's list. It changes when other gamepads are connected or disconnected.
    pub(crate) index: i32,
    /// The number of the gamepad. It stays the same while the gamepad is connected.
    pub(crate) instance: i32,
}

impl Driver {
    /// Lists all connected gamepads and joysticks.
    pub(crate) fn pads(&self) -> Vec<Pad> {
        let sdl = &self.table;
        let mut pads: Vec<Pad> = Vec::new();
        // SAFETY: under the lock the list does not change; indices below its length are valid.
        unsafe {
            (sdl.lock)();
            // SDL notices only in an update which gamepads were connected or disconnected.
            (sdl.update)();
            for index in 0..(sdl.count)() {
                let (name, instance) = (text((sdl.name)(index)), (sdl.instance)(index));
                let alike = pads.iter().filter(|pad| pad.base() == name).count();
                let name = match alike {
                    0 => name,
                    _ => format!("{name} #{}", alike + 1),
                };
                pads.push(Pad { name, index, instance });
            }
            (sdl.unlock)();
        }
        pads
    }

    /// Finds the gamepad or joystick with this name.
    pub(crate) fn find(&self, name: &str) -> Result<Pad, DeviceError> {
        let pads = self.pads();
        let mut all = pads.iter();
        let found = all.find(|pad| name == FIRST || pad.name == name);
        found.cloned().ok_or_else(|| {
            let names: Vec<&str> = pads.iter().map(|pad| pad.name.as_str()).collect();
            let there = if names.is_empty() { "none is connected".to_owned() } else { format!("there is {}", names.join(", ")) };
            DeviceError::Missing(format!(
                "no gamepad `{name}`: {there}. Connect one, which the system must let you read and write (on Linux /dev/input)"
            ))
        })
    }
}

impl Pad {
    fn base(&self) -> &str {
        match self.name.rsplit_once(" #") {
            Some((base, number)) if number.parse::<u32>().is_ok() => base,
            _ => &self.name,
        }
    }
}
