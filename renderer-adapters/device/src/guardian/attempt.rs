//! Attempts to set a display's output to zero after its guardian failed. Each attempt opens the
//! device, and opening sets the output to zero.

use std::process::{Child, Command, Stdio};
use std::sync::{Arc, Mutex, PoisonError};

use crate::{AdapterEntry, Origin, Settings, StreamFormat};

use crate::guardian::decision::By;
use crate::guardian::message::{Answer, OPEN, Opening};
use crate::guardian::worker::{converse, thread};

/// A display, and the helper program that can hold it.
pub(crate) struct Display {
    helper: Mutex<Command>,
    known: AdapterEntry,
    settings: Settings,
    format: StreamFormat,
}

impl Display {
    pub(crate) fn new(
        helper: Command,
        known: &AdapterEntry,
        settings: &Settings,
        format: &StreamFormat,
    ) -> Self {
        Self {
            helper: Mutex::new(prepared(helper, known)),
            known: known.clone(),
            settings: settings.clone(),
            format: *format,
        }
    }

    /// Starts the helper program.
    pub(crate) fn start(&self) -> std::io::Result<Child> {
        let mut helper = self.helper.lock().unwrap_or_else(PoisonError::into_inner);
        helper.spawn()
    }

    /// Returns the first message to the helper program.
    pub(crate) fn opening(&self) -> Vec<u8> {
        let opening = Opening {
            device: self.known.descriptor().id.clone(),
            settings: self.settings.to_lines(self.known.descriptor()),
            rate_hz: self.format.rate_hz,
            block_frames: self.format.block_frames,
        };
        serde_json::to_vec(&opening).unwrap_or_default()
    }
}

/// Prepares the command that starts the helper program for a device. The program gets its own
/// process group, so keys such as Ctrl-C in the terminal do not reach it.
fn prepared(mut command: Command, known: &AdapterEntry) -> Command {
    if let Origin::Library(path) = &known.origin {
        command.arg("--device-file").arg(path);
    }
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(&mut command, 0);
    // `CREATE_NEW_PROCESS_GROUP` of the Windows API.
    #[cfg(windows)]
    std::os::windows::process::CommandExt::creation_flags(&mut command, 0x0000_0200);
    command.stdin(Stdio::piped()).stdout(Stdio::piped());
    command
}

/// An attempt that runs in its own thread.
pub(crate) struct Attempt(Arc<Mutex<Option<Child>>>);

impl Attempt {
    /// Starts the attempt, which calls `tell` once: with `Ok` if the output is at zero, otherwise
    /// with the reason.
    pub(crate) fn start(
        display: &Arc<Display>,
        by: By,
        tell: impl FnOnce(Result<(), String>) + Clone + Send + 'static,
    ) -> Self {
        let process = Arc::new(Mutex::new(None));
        let (display, child, told) = (Arc::clone(display), Arc::clone(&process), tell.clone());
        let run = move || match by {
            By::Process => {
                told(by_process(&display, &child));
                // The helper ends when its pipes are closed.
                let child = child.lock().unwrap_or_else(PoisonError::into_inner).take();
                // The wait does not hold the lock, so `kill` never blocks.
                let _ = child.map(|mut child| child.wait());
            }
            By::Player => told(by_player(&display)),
        };
        if let Err(error) = thread("htex-zero", run) {
            tell(Err(error.to_string()));
        }
        Self(process)
    }

    /// Kills the attempt's process, if there is one.
    pub(crate) fn kill(&self) {
        let mut child = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let _ = child.as_mut().map(Child::kill);
    }
}

/// Tries to set the output to zero with a helper process, which opens the device.
fn by_process(display: &Display, child: &Mutex<Option<Child>>) -> Result<(), String> {
    let mut started = display.start().map_err(|error| error.to_string())?;
    let pipes = started.stdin.take().zip(started.stdout.take());
    // Stored before the conversation, which may hang: `kill` needs the process then.
    *child.lock().unwrap_or_else(PoisonError::into_inner) = Some(started);
    let Some((mut to, mut from)) = pipes else {
        return Err("it has no pipes".to_owned());
    };
    match converse(&mut to, &mut from, OPEN, &display.opening()) {
        Ok(Answer::Done(_)) => Ok(()),
        Ok(Answer::Failed(reason)) => Err(reason),
        Ok(_) => Err("its answer is invalid".to_owned()),
        Err(error) => Err(format!("the helper program ended: {error}")),
    }
}

/// Tries to set the output to zero by opening the device in this process.
fn by_player(display: &Display) -> Result<(), String> {
    let opened = display.known.adapter.open_output(&display.settings, &display.format);
    opened.map(drop).map_err(|error| error.to_string())
}
