//! An output that takes samples in real time and discards them, to try settings without hardware.

use crate::motor::{Block, Motor, PacedOutput, Plan};
use htex_device::{Capabilities, DeviceError, Output, StreamFormat};

/// Duration of a block, seconds.
const BLOCK_S: f64 = 0.01;

struct Nowhere;

impl Motor for Nowhere {
    fn play(&mut self, _: &Block<'_>) -> Result<(), String> {
        Ok(())
    }

    fn end(&mut self) -> Result<(), String> {
        Ok(())
    }

    fn stop(&mut self) -> Result<(), String> {
        Ok(())
    }
}

pub(crate) fn open(
    buffer_s: f64,
    can: Capabilities,
    format: &StreamFormat,
) -> Result<Box<dyn Output>, DeviceError> {
    let plan = Plan { gain: 1.0, block_s: BLOCK_S, buffer_s };
    let paced = PacedOutput::open("Channels", Box::new(Nowhere), &plan, can, format)?;
    Ok(Box::new(paced))
}
