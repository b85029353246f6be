//! Plays a renderer on a device until the end or an interruption.

use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

use htex_device::guardian::{GuardedOutput, is_unconfirmed, is_wanted, not_started};
use htex_device::{DeviceError, SettingKind, StreamFormat};
use htex_scene::file::Motion;
use htex_scene::{Plan, Renderer};

use crate::failure::{Failure, Result};
use crate::scenes::Ready;
use crate::{invocation, signals};

/// Longest wait for space in a device. A device that takes nothing for this long is reported as
/// stuck.
const PATIENCE: Duration = Duration::from_secs(5);
/// Polling interval while waiting until an output is at zero.
const LOOK: Duration = Duration::from_millis(20);
/// Longest block with a live motion, seconds.
const LIVE_BLOCK_S: f64 = 0.005;
/// Longest block on a display, seconds. A block is played to its end before the output goes to
/// zero.
const DISPLAY_BLOCK_S: f64 = 0.02;

/// Returns the block size in frames: the device's block size, or a smaller one if the motion is
/// live or the device is a display.
fn block_frames(ready: &Ready, plan: &Plan) -> u32 {
    let most_s = match ready.scene.file.motion {
        Motion::Live => LIVE_BLOCK_S,
        // The output must be at zero within 0.5 s after a signal. The buffer and the ramp may take
        // 400 ms of this time.
        _ if is_wanted(&ready.capabilities) => DISPLAY_BLOCK_S,
        _ => f64::INFINITY,
    };
    let most = (most_s * plan.rate_hz).ceil().max(1.0) as u32;
    ready.capabilities.block_frames.clamp(1, most)
}

/// Returns the command that runs this program as a guardian, which holds a display's output.
fn guardian() -> Result<Command, DeviceError> {
    let mut command = invocation::program().map_err(not_started)?.command();
    command.arg("guard");
    Ok(command)
}

/// Waits until the output of a display is confirmed to be at zero. While this function waits, the
/// guardian's crate keeps trying, and prints every second that the amplifier must be switched off.
/// A signal ends the program.
pub(crate) fn stay_until_zero() {
    if is_unconfirmed() && signals::handle().is_ok() {
        while is_unconfirmed() {
            std::thread::sleep(LOOK);
        }
    }
}

/// An open device and the renderer that feeds it.
pub(crate) struct Output {
    pub(crate) device: Box<dyn htex_device::Output>,
    block: Vec<f32>,
    rate_hz: f64,
    /// When playback in real time began; `None` if the device takes samples as fast as they are
    /// made or has its own clock.
    pace: Option<Instant>,
    frames: u64,
    /// Number of frames in the last written block.
    #[cfg(feature = "lab")]
    last: usize,
    /// The first error. After it, the scene fades to silence, and the error is reported.
    failed: Option<String>,
    /// Whether the device has its own clock.
    clocked: bool,
}

impl Output {
    /// Opens the device of a scene.
    pub(crate) fn open(ready: &Ready, plan: &Plan) -> Result<Self> {
        let frames = block_frames(ready, plan);
        let format = StreamFormat { rate_hz: plan.rate_hz, block_frames: frames };
        let settings = &ready.scene.settings;
        let written = ready.device.descriptor().settings.iter();
        for file in written.filter(|s| s.kind == SettingKind::Path) {
            ready.check_output(Path::new(settings.text(&file.name)))?;
        }
        let device: Box<dyn htex_device::Output> = if is_wanted(&ready.capabilities) {
            Box::new(GuardedOutput::open(&ready.device, settings, &format, guardian()?)?)
        } else {
            ready.device.adapter.open_output(settings, &format)?
        };
        let output = Self::new(device, frames as usize, plan.rate_hz);
        Ok(Self { clocked: ready.capabilities.paced, ..output })
    }

    pub(crate) fn new(
        device: Box<dyn htex_device::Output>,
        block_frames: usize,
        rate_hz: f64,
    ) -> Self {
        Self {
            device,
            block: vec![0.0; block_frames],
            rate_hz,
            pace: None,
            frames: 0,
            #[cfg(feature = "lab")]
            last: 0,
            failed: None,
            clocked: false,
        }
    }

    /// Makes playback wait for real time, as a device with a clock would. Blocks are then at most
    /// 10 ms long.
    pub(crate) fn paced(mut self) -> Self {
        let most = (self.rate_hz / 100.0).ceil().max(1.0) as usize;
        self.block.truncate(most);
        self.pace = Some(Instant::now());
        self
    }

    /// Renders one block and writes it. Returns false at the end.
    pub(crate) fn step(&mut self, renderer: &mut Renderer) -> Result<bool> {
        let left = renderer.frames_left().map_or(usize::MAX, |left| left as usize);
        let frames = renderer.render(&mut self.block).unwrap_or_else(|error| {
            self.failed.get_or_insert_with(|| error.to_string());
            renderer.stop();
            left.min(self.block.len())
        });
        self.write(frames)?;
        self.frames += frames as u64;
        #[cfg(feature = "lab")]
        {
            self.last = frames;
        }
        if let Some(start) = self.pace {
            // Measured from the start, so that the errors of the sleeps do not add up.
            let due = Duration::from_secs_f64(self.frames as f64 / self.rate_hz);
            std::thread::sleep(due.saturating_sub(start.elapsed()));
        }
        // Only the last block is shorter. If the last block with samples is full, an empty block
        // follows.
        Ok(frames == self.block.len())
    }

    fn write(&mut self, frames: usize) -> Result<()> {
        let mut rest = &self.block[..frames];
        while !rest.is_empty() {
            let taken = self.device.write(rest, PATIENCE)?;
            if taken == 0 {
                return Err(Failure::other(
                    "the device has taken nothing for 5 s; connect it anew",
                ));
            }
            rest = &rest[taken..];
        }
        Ok(())
    }

    /// Returns the time until the first written frame is at the display, seconds, as far as the
    /// device knows it.
    #[cfg(feature = "lab")]
    pub(crate) fn lead_s(&self) -> f64 {
        self.device.status().latency_s - self.frames as f64 / self.rate_hz
    }

    /// Returns the block that [`Self::step`] wrote last.
    #[cfg(feature = "lab")]
    pub(crate) fn last_block(&self) -> &[f32] {
        &self.block[..self.last]
    }

    /// Returns the number of frames written.
    pub(crate) fn frames(&self) -> u64 {
        self.frames
    }

    /// Plays all written samples to their end. After an error of the renderer, returns this error,
    /// and leaves no file behind.
    pub(crate) fn finish(mut self) -> Result<htex_device::Status> {
        if let Some(error) = self.failed.take() {
            // The fade to zero still has to be played on a device with a clock. A file is not kept.
            if self.clocked {
                self.device.finish()?;
            }
            return Err(Failure::Other(error));
        }
        self.device.finish()?;
        Ok(self.device.status())
    }
}

/// Returns the line about samples that were limited, if there were any.
pub(crate) fn limited_text(samples: u64) -> String {
    match samples {
        0 => String::new(),
        _ => format!("{samples} samples were held at the drive or the device's limit\n"),
    }
}
