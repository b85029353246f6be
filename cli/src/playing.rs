//! From a renderer to a device, until the end or an interruption.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use htex_device::{Device, StreamFormat};
use htex_scene::{Plan, Renderer};

use crate::failure::Failure;
use crate::scenes::Ready;

/// Longest wait for room in a device; one that takes nothing for so long is stuck.
const PATIENCE: Duration = Duration::from_secs(5);
/// What an interrupted program answers by convention.
const INTERRUPTED: i32 = 130;

static STOP: AtomicBool = AtomicBool::new(false);

/// From now on Ctrl-C is answered by [`interrupted`]; a second one ends the program at once.
pub(crate) fn catch_interrupts() -> Result<(), Failure> {
    static CAUGHT: OnceLock<Result<(), String>> = OnceLock::new();
    let caught = CAUGHT.get_or_init(|| {
        let handler = || {
            if STOP.swap(true, Ordering::Relaxed) {
                std::process::exit(INTERRUPTED);
            }
        };
        ctrlc::set_handler(handler).map_err(|error| error.to_string())
    });
    caught
        .clone()
        .map_err(|error| Failure::Other(format!("cannot catch Ctrl-C: {error}")))
}

/// Whether the user wants an end.
pub(crate) fn interrupted() -> bool {
    STOP.load(Ordering::Relaxed)
}

/// An open device and the blocks that go to it.
pub(crate) struct Output {
    pub(crate) device: Box<dyn Device>,
    block: Vec<f32>,
    rate_hz: f64,
    /// When the first block was made, for a device without a clock in a scene without an end.
    pace: Option<Instant>,
    frames: u64,
}

impl Output {
    /// Opens the device of a scene.
    pub(crate) fn open(ready: &Ready, plan: &Plan) -> Result<Self, Failure> {
        let frames = ready.capabilities.block_frames.max(1);
        let format = StreamFormat {
            rate_hz: plan.rate_hz,
            block_frames: frames,
        };
        let device = ready.device.adapter.open(ready.settings(), &format)?;
        Ok(Self::new(device, frames as usize, plan.rate_hz))
    }

    pub(crate) fn new(device: Box<dyn Device>, block_frames: usize, rate_hz: f64) -> Self {
        Self {
            device,
            block: vec![0.0; block_frames],
            rate_hz,
            pace: None,
            frames: 0,
        }
    }

    /// Takes blocks of at most 10 ms no faster than they last, as a device with a clock would.
    pub(crate) fn paced(mut self) -> Self {
        let most = (self.rate_hz / 100.0).ceil().max(1.0) as usize;
        self.block.truncate(most);
        self.pace = Some(Instant::now());
        self
    }

    /// Renders one block and writes it; false at the end.
    pub(crate) fn step(&mut self, renderer: &mut Renderer) -> Result<bool, Failure> {
        let frames = renderer.render(&mut self.block);
        if let Some(error) = renderer.take_failure() {
            return Err(Failure::Other(error.to_string()));
        }
        self.write(frames)?;
        self.frames += frames as u64;
        if let Some(start) = self.pace {
            let due = Duration::from_secs_f64(self.frames as f64 / self.rate_hz);
            std::thread::sleep(due.saturating_sub(start.elapsed()));
        }
        Ok(frames == self.block.len())
    }

    fn write(&mut self, frames: usize) -> Result<(), Failure> {
        let mut rest = &self.block[..frames];
        while !rest.is_empty() {
            let taken = self.device.write(rest, PATIENCE)?;
            if taken == 0 {
                let sentence = "the device has taken nothing for 5 s; connect it anew";
                return Err(Failure::Other(sentence.to_owned()));
            }
            rest = &rest[taken..];
        }
        Ok(())
    }

    /// Frames that were written.
    pub(crate) fn frames(&self) -> u64 {
        self.frames
    }

    /// Plays what is written, and keeps the result.
    pub(crate) fn finish(mut self) -> Result<htex_device::Status, Failure> {
        self.device.finish()?;
        Ok(self.device.status())
    }
}
