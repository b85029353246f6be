//! The app's side: a device whose samples go to another process.

use std::fmt::Display;
use std::io::{BufReader, BufWriter};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use htex_device::{
    Capabilities, Device, DeviceError, KnownDevice, Origin, Quantity, Settings, Status,
    StreamFormat,
};

use crate::message::{ABORT, Answer, FINISH, LONGEST, Opening, STATUS, WRITE, put, take};

/// Whether a device's output may hurt when it keeps its last value.
pub fn is_wanted(able: &Capabilities) -> bool {
    able.paced && able.quantity == Quantity::DisplayVoltage
}

/// Returns the usual helper program: the command `htex guard`, found as a shell finds it.
pub fn htex() -> Command {
    let mut command = Command::new("htex");
    command.arg("guard");
    command
}

/// Returns the error that no helper program can be started.
pub fn not_started(error: impl Display) -> DeviceError {
    DeviceError::Told(format!(
        "no process to hold the output can be started: {error}"
    ))
}

/// A device that another process holds.
pub struct Guarded {
    pipes: Mutex<Option<Pipes>>,
    child: Child,
    known: KnownDevice,
    settings: Settings,
    format: StreamFormat,
    ended: bool,
}

struct Pipes {
    to: BufWriter<ChildStdin>,
    from: BufReader<ChildStdout>,
}

impl Guarded {
    /// Starts the helper program, which opens the device. If the device is that of a library, the program's last arguments are
    /// `--device-file` and the library's file.
    ///
    /// # Errors
    /// When the program cannot be started, or the error of opening the device there.
    pub fn open(
        known: &KnownDevice,
        settings: &Settings,
        format: &StreamFormat,
        helper: Command,
    ) -> Result<Self, DeviceError> {
        let mut child = start(helper, known).map_err(not_started)?;
        let pipes = child.stdin.take().zip(child.stdout.take());
        let pipes = pipes.map(|(to, from)| Pipes {
            to: BufWriter::new(to),
            from: BufReader::new(from),
        });
        let opening = Opening {
            device: known.descriptor().id.clone(),
            settings: settings.to_lines(known.descriptor()),
            rate_hz: format.rate_hz,
            block_frames: format.block_frames,
        };
        let mut guarded = Self {
            pipes: Mutex::new(pipes),
            child,
            known: known.clone(),
            settings: settings.clone(),
            format: *format,
            ended: false,
        };
        let opening = serde_json::to_vec(&opening).unwrap_or_default();
        // A device that was not opened has no output to set to zero, and may belong to another process.
        if let Err(error) = guarded.ask(b'o', &opening) {
            guarded.ended = true;
            return Err(error);
        }
        Ok(guarded)
    }

    /// Sends a request and waits for the reply.
    fn ask(&self, tag: u8, body: &[u8]) -> Result<Answer, DeviceError> {
        let mut held = self.pipes.lock().unwrap_or_else(PoisonError::into_inner);
        let Some(pipes) = held.as_mut() else {
            return Err(DeviceError::Closed(self.known.descriptor().name.clone()));
        };
        let answer = put(&mut pipes.to, tag, body).and_then(|()| take(&mut pipes.from));
        let answer = answer.and_then(|(_, body)| Ok(serde_json::from_slice(&body)?));
        match answer {
            Ok(Answer::Failed(text)) => Err(DeviceError::Told(text)),
            Ok(Answer::Dry {
                device,
                frames,
                advice,
            }) => Err(DeviceError::Underflow {
                device,
                frames,
                advice,
            }),
            Ok(answer) => Ok(answer),
            Err(_) => {
                *held = None;
                Err(self.zero_from_here())
            }
        }
    }

    /// The guardian has ended: opening the device sets its output to zero.
    fn zero_from_here(&self) -> DeviceError {
        let gone = "the process that held the output has ended";
        match self.known.adapter.open(&self.settings, &self.format) {
            Ok(_) => DeviceError::Told(format!("{gone}; the output was set to zero")),
            Err(error) => DeviceError::Told(format!(
                "{gone}, and the output could not be set to zero: switch the amplifier off ({error})"
            )),
        }
    }

    fn end(&mut self, tag: u8) -> Result<(), DeviceError> {
        if std::mem::replace(&mut self.ended, true) {
            return Err(DeviceError::Closed(self.known.descriptor().name.clone()));
        }
        self.ask(tag, &[]).map(|_| ())
    }
}

/// Starts the helper program for a device, out of reach of the terminal's keys.
fn start(mut command: Command, known: &KnownDevice) -> std::io::Result<Child> {
    if let Origin::Library(path) = &known.origin {
        command.arg("--device-file").arg(path);
    }
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(&mut command, 0);
    #[cfg(windows)]
    std::os::windows::process::CommandExt::creation_flags(&mut command, 0x0000_0200);
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn()
}

impl Device for Guarded {
    fn write(&mut self, samples: &[f32], timeout: Duration) -> Result<usize, DeviceError> {
        let samples = &samples[..samples.len().min(LONGEST as usize / 8)];
        let timeout_ms = u32::try_from(timeout.as_millis()).unwrap_or(u32::MAX);
        let mut body = timeout_ms.to_le_bytes().to_vec();
        body.extend(samples.iter().flat_map(|sample| sample.to_le_bytes()));
        match self.ask(WRITE, &body)? {
            Answer::Done(taken) => Ok((taken as usize).min(samples.len())),
            _ => Ok(0),
        }
    }

    fn status(&self) -> Status {
        match self.ask(STATUS, &[]) {
            Ok(Answer::Status(numbers)) => numbers.into(),
            _ => Status::default(),
        }
    }

    fn finish(&mut self) -> Result<(), DeviceError> {
        self.end(FINISH)
    }
}

impl Drop for Guarded {
    fn drop(&mut self) {
        if !self.ended {
            let _ = self.end(ABORT);
        }
        // Closing the pipe ends the guardian.
        *self.pipes.get_mut().unwrap_or_else(PoisonError::into_inner) = None;
        let _ = self.child.wait();
    }
}
