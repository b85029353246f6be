//! The motors of gamepads and joysticks, through SDL 2. The SDL library is not linked, but loaded
//! at run time.
//!
//! A gamepad has a large and a small motor, each with an unbalanced mass. Each motor takes a
//! strength. The mean frequency of a block of `block_ms` determines how the level of the block is
//! divided between the two motors ([`htex_dsp::reduced::two_motors`]).
//!
//! Each command to SDL drives the motors with one strength for the duration of `HOLD_BLOCKS`
//! blocks. If the device's thread hangs, SDL stops the motors after this time, as long as the
//! program still polls SDL's events. If the program ends, the operating system stops the motors.
//! SDL stays initialised after the device is closed, because the application may also use SDL.
#![deny(unsafe_code)]

mod driver;
mod pads;
mod rumble;
mod table;

use std::sync::LazyLock;

use crate::motor::{PacedOutput, Plan, reducing_settings};
use htex_device::{
    Adapter, Capabilities, Descriptor, DeviceError, Endpoint, Mapping, Output, Setting,
    SettingKind, Settings, StreamFormat,
};

use driver::Driver;
use rumble::Rumble;

/// The gamepad adapter. See the crate's documentation.
#[derive(Debug, Clone, Copy, Default)]
pub struct Sdl;

impl Adapter for Sdl {
    fn descriptor(&self) -> &Descriptor {
        &DESCRIPTOR
    }

    fn endpoints(&self) -> Result<Vec<Endpoint>, DeviceError> {
        let pads = Driver::load("")?.pads();
        let endpoint = |pad: pads::Pad| Endpoint {
            name: pad.name,
            setting: "device".to_owned(),
            summary: "gamepad or joystick".to_owned(),
        };
        Ok(pads.into_iter().map(endpoint).collect())
    }

    fn capabilities(&self, settings: &Settings) -> Result<Capabilities, DeviceError> {
        Driver::load(settings.text("driver"))?.find(settings.text("device"))?;
        Ok(Plan::new(settings).capabilities())
    }

    fn open_output(
        &self,
        settings: &Settings,
        format: &StreamFormat,
    ) -> Result<Box<dyn Output>, DeviceError> {
        let plan = Plan::new(settings);
        let can = plan.capabilities();
        let driver = Driver::load(settings.text("driver"))?;
        let pad = driver.find(settings.text("device"))?;
        if !can.has_rate(format.rate_hz) {
            return Err(crate::motor::rate_error(&pad.name, format.rate_hz, &can));
        }
        let rumble = Rumble::open(driver, &pad, &plan)?;
        let paced = PacedOutput::open(&pad.name, Box::new(rumble), &plan, can, format)?;
        Ok(Box::new(paced))
    }
}

static DESCRIPTOR: LazyLock<Descriptor> = LazyLock::new(|| {
    let device = Setting::hardware(
        "device",
        SettingKind::Text,
        pads::FIRST,
        "Name of the gamepad or joystick in the list of devices; `first` is the first in the list.",
    );
    let driver = Setting::hardware(
        "driver",
        SettingKind::Text,
        "",
        "Library of SDL 2: a file, or a name that the system's loader finds. Empty: the installed library.",
    );
    let mut settings = vec![device, driver];
    settings.extend(reducing_settings());
    Descriptor {
        id: "org.htex.sdl".to_owned(),
        name: "Gamepad".to_owned(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        summary: "The two motors of a gamepad or joystick, through SDL 2.".to_owned(),
        settings,
        mapping: Some(Mapping {
            plays: "the level of each block of block_ms, divided between a large and a small motor by the mean \
                    frequency of the block: up to 60 Hz only the large motor plays, from 420 Hz only the small motor"
                .to_owned(),
            loses: "the waveform and the spectrum: a motor vibrates at its own frequency, which rises with the \
                    motor's strength, and takes about 20 to 100 ms to start"
                .to_owned(),
        }),
        ..Descriptor::default()
    }
});
