//! An open analog input. Samples wait in the driver's buffer until they are read.

use std::thread::sleep;
use std::time::{Duration, Instant};

use htex_device::{Channel, DeviceError, Input, InputFrames, InputStream};

use crate::daq::driver::{Driver, InputTask};
use crate::daq::fault::Fault;
use crate::daq::inputs::Inputs;

/// Polling interval for samples.
const LOOK: Duration = Duration::from_millis(2);

pub(crate) struct Sampler {
    inputs: Inputs,
    stream: InputStream,
    /// `None` after the end.
    task: Option<InputTask>,
    is_running: bool,
    delivered: u64,
}

impl Sampler {
    /// Creates the task, which does not run yet.
    pub(crate) fn open(inputs: Inputs, driver: &'static Driver) -> Result<Self, DeviceError> {
        let task = Self::task(&inputs, driver).map_err(|fault| fault.missing(&inputs.given))?;
        let name = |full: &String| full.rsplit('/').next().unwrap_or(full).to_owned();
        let channels = inputs.channels.iter().map(|full| Channel::new(name(full), "V"));
        Ok(Self {
            stream: InputStream { rate_hz: inputs.rate_hz, channels: channels.collect() },
            inputs,
            task: Some(task),
            is_running: false,
            delivered: 0,
        })
    }

    fn task(inputs: &Inputs, driver: &'static Driver) -> Result<InputTask, Fault> {
        let (names, width) = (inputs.channels.join(", "), inputs.channels.len());
        let task = InputTask::new(driver, &names, width, inputs.terminals, inputs.range_v)?;
        task.set_clock(inputs.rate_hz, inputs.buffer_frames())?;
        Ok(task)
    }

    fn running(&self) -> Result<&InputTask, DeviceError> {
        let task = self.task.as_ref().filter(|_| self.is_running);
        task.ok_or_else(|| DeviceError::Closed(self.inputs.given.clone()))
    }

    /// Reads the available samples.
    fn read_now(&self, samples: &mut [f64]) -> Result<Result<usize, Fault>, DeviceError> {
        let (task, width) = (self.running()?, self.stream.channels.len());
        let most = samples.len() / width;
        Ok(task.available().and_then(|there| match there.min(most) {
            0 => Ok(0),
            frames => task.read(frames, samples),
        }))
    }

    /// Ends the task and converts the fault to an error.
    fn fail(&mut self, fault: &Fault) -> DeviceError {
        self.task = None;
        let Inputs { given, buffer_s, .. } = &self.inputs;
        if fault.is_overrun() {
            DeviceError::Overrun {
                device: given.clone(),
                frames: self.delivered,
                advice: format!(
                    "NI-DAQmx {}: close other programs, lower `rate_hz`, or raise `buffer_s` (now {buffer_s} s)",
                    fault.code
                ),
            }
        } else {
            fault.failed(given)
        }
    }
}

impl Input for Sampler {
    fn stream(&self) -> &InputStream {
        &self.stream
    }

    fn start(&mut self) -> Result<(), DeviceError> {
        let Some(task) = &self.task else {
            return Err(DeviceError::Closed(self.inputs.given.clone()));
        };
        if !self.is_running {
            task.start().map_err(|fault| fault.missing(&self.inputs.given))?;
            self.is_running = true;
        }
        Ok(())
    }

    fn read(&mut self, samples: &mut [f64], timeout: Duration) -> Result<InputFrames, DeviceError> {
        let since = Instant::now();
        loop {
            // The time is checked after the read, so a read with a timeout of 0 still takes the
            // available samples.
            match self.read_now(samples)? {
                Err(fault) => return Err(self.fail(&fault)),
                Ok(frames) if frames > 0 || since.elapsed() >= timeout => {
                    self.delivered += frames as u64;
                    return Ok(InputFrames::Count(frames));
                }
                Ok(_) => sleep(LOOK.min(timeout.saturating_sub(since.elapsed()))),
            }
        }
    }

    fn finish(&mut self) -> Result<(), DeviceError> {
        // The task is taken even if it does not run, so that it is cleared and cannot be started
        // later.
        let Some(task) = self.task.take().filter(|_| self.is_running) else {
            return Ok(());
        };
        task.stop().map_err(|fault| fault.failed(&self.inputs.given))
    }
}
