//! The app's side of the guardian: an output that passes its samples to another process.

use std::fmt::Display as Show;
use std::process::Command;
use std::sync::mpsc::{Sender, channel};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use crate::{
    AdapterEntry, Capabilities, DeviceError, Output, Quantity, Settings, Status, StreamFormat,
};

use crate::guardian::attempt::Display;
use crate::guardian::decision::{REQUEST, Waits};
use crate::guardian::message::{ABORT, Answer, FINISH, MOST_SAMPLES, OPEN, STATUS, WRITE};
use crate::guardian::worker::{Message, Reply, Worker};

/// The settings that tell how long a display's output takes to reach zero, milliseconds.
const BUFFER_SETTING: &str = "buffer_ms";
const RAMP_SETTING: &str = "ramp_ms";
/// Assumed duration of buffer and ramp together, for a display whose settings state neither.
const USUAL_TO_ZERO: Duration = Duration::from_millis(400);
/// Maximum duration of the buffer, and of the ramp, that the app waits for, milliseconds.
const MOST_MS: f64 = 10_000.0;

/// Whether an output needs a guardian, i.e. whether the output could cause harm if it kept its last
/// value. An output needs a guardian if it plays display voltages at the pace of a clock.
pub fn is_wanted(able: &Capabilities) -> bool {
    able.paced && able.quantity == Quantity::DisplayVoltage
}

/// Returns the usual helper program: the command `htex guard`, looked up in the search path.
pub fn htex() -> Command {
    let mut command = Command::new("htex");
    command.arg("guard");
    command
}

/// Returns the error that no helper program could be started.
pub fn not_started(error: impl Show) -> DeviceError {
    DeviceError::Message(format!("no process to hold the output can be started: {error}"))
}

/// An output whose device is held by another process, the guardian.
///
/// Each call waits for an answer of the guardian for at most buffer + ramp + 0.6 s. Buffer and ramp
/// are the durations of the device's buffer and ramp. There are two exceptions. Opening waits at
/// most buffer + ramp + 10.5 s. A write may in addition take the timeout that the caller passed.
///
/// If no answer comes in time, the app kills the guardian, and a second process sets the output to
/// zero. If the second process does not confirm this within 0.5 s, the call returns an error, which
/// states that the output may not be at zero. A thread then prints every second that the amplifier
/// must be switched off, until the output is confirmed to be at zero
/// ([`crate::guardian::is_unconfirmed`]). In total, dropping the output takes at most buffer + ramp
/// + 0.6 s.
pub struct GuardedOutput {
    worker: Mutex<Sender<Message>>,
    name: String,
    waits: Waits,
    ended: bool,
}

impl GuardedOutput {
    /// Starts the helper program, which opens the device. If the device comes from a native
    /// library, this function adds the arguments `--device-file` and the library's file to the
    /// command of the helper program.
    ///
    /// # Errors
    /// Returns an error if the program cannot be started or does not answer, or if the program
    /// cannot open the device.
    pub fn open(
        known: &AdapterEntry,
        settings: &Settings,
        format: &StreamFormat,
        helper: Command,
    ) -> Result<Self, DeviceError> {
        let display = Display::new(helper, known, settings, format);
        let opening = display.opening();
        let mut guarded = Self {
            worker: Mutex::new(Worker::start(display).map_err(not_started)?),
            name: known.descriptor().name.clone(),
            waits: waits(settings),
            ended: false,
        };
        // Dropping must not abort a device that was not opened: it has no output to set to zero,
        // and it may belong to another process.
        if let Err(error) = guarded.ask(OPEN, opening, guarded.waits.opening()) {
            guarded.ended = true;
            return Err(error);
        }
        Ok(guarded)
    }

    /// Sends a request and waits at most `patience` for the answer. If no answer comes, waits until
    /// the output is at zero, at most another 0.5 s.
    fn ask(&self, tag: u8, body: Vec<u8>, patience: Duration) -> Result<Answer, DeviceError> {
        let (reply, replied) = channel();
        let ask = Message::Ask { tag, body, patience, reply };
        let worker = self.worker.lock().unwrap_or_else(PoisonError::into_inner);
        let replied = match worker.send(ask) {
            Ok(()) => replied.recv().unwrap_or(Reply::Closed),
            Err(_) => Reply::Closed,
        };
        match replied {
            Reply::Answer(Answer::Failed(text)) => Err(DeviceError::Message(text)),
            Reply::Answer(Answer::Dry { device, frames, advice }) => {
                Err(DeviceError::Underflow { device, frames, advice })
            }
            Reply::Answer(answer) => Ok(answer),
            Reply::Failed(error) => Err(error),
            Reply::Closed => Err(DeviceError::Closed(self.name.clone())),
        }
    }

    fn end(&mut self, tag: u8, patience: Duration) -> Result<(), DeviceError> {
        if std::mem::replace(&mut self.ended, true) {
            return Err(DeviceError::Closed(self.name.clone()));
        }
        self.ask(tag, vec![], patience).map(|_| ())
    }

    /// Writes the samples that fit within at most [`REQUEST`].
    fn write_some(&self, samples: &[f32], timeout: Duration) -> Result<usize, DeviceError> {
        let samples = &samples[..samples.len().min(MOST_SAMPLES)];
        let timeout_ms = u32::try_from(timeout.min(REQUEST).as_millis()).unwrap_or(u32::MAX);
        let mut body = timeout_ms.to_le_bytes().to_vec();
        body.extend(samples.iter().flat_map(|sample| sample.to_le_bytes()));
        match self.ask(WRITE, body, self.waits.answer())? {
            // A wrong answer must not lead beyond the end of the samples.
            Answer::Done(taken) => Ok((taken as usize).min(samples.len())),
            _ => Ok(0),
        }
    }
}

/// Computes the waits from the buffer and the ramp in a display's settings, or from a default.
fn waits(settings: &Settings) -> Waits {
    let stated = [BUFFER_SETTING, RAMP_SETTING]
        .map(|name| settings.number(name))
        .into_iter()
        .filter(|ms| ms.is_finite());
    let to_zero = stated.map(|ms| Duration::from_secs_f64(ms.clamp(0.0, MOST_MS) / 1e3));
    Waits { to_zero: to_zero.reduce(|a, b| a + b).unwrap_or(USUAL_TO_ZERO) }
}

impl Output for GuardedOutput {
    fn write(&mut self, samples: &[f32], timeout: Duration) -> Result<usize, DeviceError> {
        let (begun, mut taken) = (Instant::now(), 0);
        loop {
            // Computed before the request, so that even with a timeout of zero one request is sent.
            let left = timeout.saturating_sub(begun.elapsed());
            taken += self.write_some(&samples[taken..], left)?;
            if taken == samples.len() || left.is_zero() {
                return Ok(taken);
            }
        }
    }

    fn status(&self) -> Status {
        match self.ask(STATUS, vec![], self.waits.answer()) {
            Ok(Answer::Status(numbers)) => numbers.into(),
            _ => Status::default(),
        }
    }

    fn finish(&mut self) -> Result<(), DeviceError> {
        self.end(FINISH, self.waits.answer())
    }
}

impl Drop for GuardedOutput {
    fn drop(&mut self) {
        let begun = Instant::now();
        if !self.ended {
            let _ = self.end(ABORT, self.waits.abort());
        }
        let (reply, replied) = channel();
        // Both waits together are at most as long as the wait for one answer.
        let patience = self.waits.answer().saturating_sub(begun.elapsed());
        let worker = self.worker.get_mut().unwrap_or_else(PoisonError::into_inner);
        if worker.send(Message::Close { patience, reply }).is_ok() {
            let _ = replied.recv();
        }
    }
}
