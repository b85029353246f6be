//! A separate process that holds a display's output, so that no end of this process leaves a voltage at the display.
//!
//! A signal that kills, stops or hangs the player reaches only the player: the guardian is in a process group of its own, receives no
//! signals of the terminal's keys, and ends when its pipe does. It then plays what it has (at most the device's buffer), sets the output to
//! zero, and exits; a device whose buffer runs dry sets its output to zero itself. If the guardian ends first, the player sets the
//! output to zero.

use std::io::{BufReader, BufWriter, Read, Write};
use std::process::{Child, ChildStdin, ChildStdout, Stdio};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use htex_device::{
    Capabilities, Device, DeviceError, KnownDevice, Origin, Quantity, Settings, Status,
    StreamFormat,
};
use serde::{Deserialize, Serialize};

use crate::invocation;

/// Longest message, bytes: a second at a million samples a second.
const LONGEST: u32 = 4 << 20;

/// The first message of the player.
#[derive(Serialize, Deserialize)]
struct Opening {
    device: String,
    settings: String,
    rate_hz: f64,
    block_frames: u32,
}

/// Replies of the guardian.
#[derive(Serialize, Deserialize)]
enum Answer {
    Done(u64),
    Status([f64; 5]),
    Failed(String),
}

/// Requests of the player, a byte each; samples follow a time in milliseconds.
const WRITE: u8 = b'w';
const STATUS: u8 = b's';
const FINISH: u8 = b'f';
const ABORT: u8 = b'a';

/// Whether a device's output may hurt when it keeps its last value.
pub(crate) fn is_wanted(able: &Capabilities) -> bool {
    able.paced && able.quantity == Quantity::DisplayVoltage
}

fn put(to: &mut impl Write, tag: u8, body: &[u8]) -> std::io::Result<()> {
    to.write_all(&[tag])?;
    to.write_all(&(body.len() as u32).to_le_bytes())?;
    to.write_all(body)?;
    to.flush()
}

fn take(from: &mut impl Read) -> std::io::Result<(u8, Vec<u8>)> {
    let mut head = [0; 5];
    from.read_exact(&mut head)?;
    let [tag, a, b, c, d] = head;
    let length = u32::from_le_bytes([a, b, c, d]);
    if length > LONGEST {
        return Err(std::io::Error::other("a message is too long"));
    }
    let mut body = vec![0; length as usize];
    from.read_exact(&mut body)?;
    Ok((tag, body))
}

/// A device that another process holds.
pub(crate) struct Guarded {
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
    /// Starts the guardian, which opens the device.
    pub(crate) fn open(
        known: &KnownDevice,
        settings: &Settings,
        format: &StreamFormat,
    ) -> Result<Self, DeviceError> {
        let mut child = start(known).map_err(|error| {
            DeviceError::Told(format!(
                "no process to hold the output can be started: {error}"
            ))
        })?;
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

/// The command that starts this program as the guardian of a device.
fn start(known: &KnownDevice) -> std::io::Result<Child> {
    let program = invocation::program().map_err(std::io::Error::other)?;
    let mut command = program.command();
    command.arg("guard");
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

/// Holds a device for the process at the other end of the pipes, until they end.
pub(crate) fn hold(
    find: impl FnOnce(&str) -> Result<KnownDevice, DeviceError>,
    from: impl Read,
    to: impl Write,
) {
    let (mut from, mut to) = (BufReader::new(from), BufWriter::new(to));
    let opened = take(&mut from).ok().map(|(_, body)| open(find, &body));
    let mut device = match opened {
        None => return,
        Some(Err(error)) => {
            let _ = answer(&mut to, &Answer::Failed(error.to_string()));
            return;
        }
        Some(Ok(device)) => device,
    };
    let mut heard = answer(&mut to, &Answer::Done(0));
    while heard.is_ok() {
        let Ok((tag, body)) = take(&mut from) else {
            break;
        };
        let said = match tag {
            WRITE => write(&mut *device, &body),
            STATUS => Ok(Answer::Status(device.status().into())),
            FINISH => device.finish().map(|()| Answer::Done(0)),
            _ => {
                drop(device);
                let _ = answer(&mut to, &Answer::Done(0));
                return;
            }
        };
        let said = said.unwrap_or_else(|error| Answer::Failed(error.to_string()));
        heard = answer(&mut to, &said);
    }
    // The player has ended: what was written is played and ends at zero. If that fails, dropping the device sets it to zero.
    let _ = device.finish();
}

fn open(
    find: impl FnOnce(&str) -> Result<KnownDevice, DeviceError>,
    body: &[u8],
) -> Result<Box<dyn Device>, DeviceError> {
    let opening: Opening = serde_json::from_slice(body)
        .map_err(|error| DeviceError::Told(format!("invalid first message: {error}")))?;
    let known = find(&opening.device)?;
    let settings = Settings::from_lines(known.descriptor(), &opening.settings)?;
    let format = StreamFormat {
        rate_hz: opening.rate_hz,
        block_frames: opening.block_frames,
    };
    known.adapter.open(&settings, &format)
}

fn write(device: &mut dyn Device, body: &[u8]) -> Result<Answer, DeviceError> {
    let (words, _) = body.as_chunks::<4>();
    let Some((timeout_ms, samples)) = words.split_first() else {
        return Ok(Answer::Done(0));
    };
    let timeout = Duration::from_millis(u32::from_le_bytes(*timeout_ms).into());
    let samples: Vec<f32> = samples
        .iter()
        .map(|word| f32::from_le_bytes(*word))
        .collect();
    let taken = device.write(&samples, timeout)?;
    Ok(Answer::Done(taken as u64))
}

fn answer(to: &mut impl Write, answer: &Answer) -> std::io::Result<()> {
    put(to, b'a', &serde_json::to_vec(answer)?)
}
