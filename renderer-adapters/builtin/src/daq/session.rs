//! The state that the writer and the watchdog of an open output share: the running task, and the
//! data for returning the output to zero.
//!
//! The adapter refuses a sample over the limit, and samples whose mean exceeds the direct-voltage
//! limit. In addition, the driver refuses samples beyond its own channel limits. If the writer
//! hangs, the last voltage would stay at the output. Therefore, the watchdog detects when the
//! buffer runs empty, and then sets the output to zero. The last step of every session is an
//! unclocked write of zero, even after an error. If this write fails, it is repeated. Before the
//! last repetition, the card is reset.

use std::sync::Arc;
use std::time::{Duration, Instant};

use htex_device::{DeviceError, DirectVoltage, Excess, Status, StreamFormat};

use crate::daq::driver::{Driver, Task};
use crate::daq::fault::Fault;
use crate::daq::rig::{MOST_TO_ZERO_MS, Rig};
use crate::daq::zero::{Emergency, Zero};
use crate::driver::Claim;

/// If no frame is output for this long, the clock is considered stopped. The last voltage would
/// then stay at the output.
const STILL: Duration = Duration::from_millis(400);

pub(crate) struct Session {
    rig: Rig,
    /// `None` after the session has ended.
    claim: Option<Claim>,
    driver: &'static Driver,
    emergency: Arc<Emergency>,
    rate_hz: f64,
    /// Maximum number of the stream's frames that wait in the driver's buffer and on the card.
    ahead: usize,
    /// Capacity of the driver's buffer, frames. It may exceed `ahead`, because a ramp before the
    /// stream may be longer than `ahead`.
    capacity: usize,
    /// `None` before the first sample and after the session has ended.
    task: Option<Task>,
    /// An error for the next call. The call returns the error and clears this field.
    error: Option<DeviceError>,
    closed: bool,
    /// Whether the output could not be set to zero at the end.
    not_zero: bool,
    /// Number of frames before the stream (the lead): zeros, and a ramp if there is one.
    lead: u64,
    /// Number of frames given to the driver, including the lead.
    given: u64,
    /// Number of frames that were output so far, including the lead.
    generated: u64,
    /// When `generated` last grew.
    moved_at: Instant,
    /// The stream's last sample, in volts of the card.
    last_v: f64,
    /// The mean of the voltages given to the driver, in volts of the card.
    direct: DirectVoltage,
    status: Status,
}

impl Session {
    /// Opens the device and sets its output to zero.
    pub(crate) fn open(
        rig: Rig,
        driver: &'static Driver,
        format: &StreamFormat,
    ) -> Result<Self, DeviceError> {
        let frames = |seconds: f64| (seconds * format.rate_hz).ceil() as usize;
        // A large block at a low rate must not delay the zero.
        let most = frames(MOST_TO_ZERO_MS / 1e3 - rig.ramp_s);
        let ahead =
            frames(rig.buffer_s).max(2 * format.block_frames as usize).clamp(2, most.max(2));
        let session = Self {
            claim: Some(Claim::reserve(["daq", &rig.driver, &rig.device], &rig.device)?),
            capacity: ahead.max(frames(rig.ramp_s)),
            ahead,
            rate_hz: format.rate_hz,
            direct: DirectVoltage::new(rig.dc_limit_v / rig.gain, format.rate_hz),
            emergency: Arc::new(Emergency::new(Zero {
                driver,
                device: rig.device.clone(),
                limit_v: rig.limit_v / rig.gain,
            })),
            rig,
            driver,
            task: None,
            error: None,
            closed: false,
            not_zero: false,
            lead: 0,
            given: 0,
            generated: 0,
            moved_at: Instant::now(),
            last_v: 0.0,
            status: Status::default(),
        };
        let zero = session.emergency.zero.put();
        zero.map_err(|fault| fault.missing(&session.rig.device))?;
        Ok(session)
    }

    /// Returns the part that can set the output to zero without the session.
    pub(crate) fn emergency(&self) -> Arc<Emergency> {
        Arc::clone(&self.emergency)
    }

    /// Takes the samples that fit now and returns their number.
    pub(crate) fn write(&mut self, samples: &[f32]) -> Result<usize, DeviceError> {
        self.usable()?;
        // All samples of the call are checked, even those for which there is no space now. No
        // sample may be output if a later one of the same call is refused.
        let mut volts = self.checked(samples)?;
        // The driver's buffer cannot hold more, so the rest waits for the next call.
        volts.truncate(self.capacity);
        if volts.is_empty() {
            return Ok(0);
        }
        if self.task.is_none() {
            self.start(&volts)?;
        }
        // The mean is checked after the start, because it also includes the lead.
        self.check_direct(&volts)?;
        let fitting = self.space()?.min(volts.len());
        let taken = self.give(&volts[..fitting])?;
        for sample in &samples[..taken] {
            self.status.peak = self.status.peak.max(f64::from(sample.abs()));
        }
        self.last_v = volts[..taken].last().copied().unwrap_or(self.last_v);
        self.status.frames_written += taken as u64;
        self.status.latency_s = self.waiting_s();
        Ok(taken)
    }

    /// Returns how many frames of the stream may be given to the driver now. This number follows
    /// from the frames that were output so far. The driver's own count cannot be used: it reports
    /// free space as soon as samples have moved to the card's memory, which may hold a second of
    /// samples.
    fn space(&mut self) -> Result<usize, DeviceError> {
        let generated = self
            .task
            .as_ref()
            .map(Task::generated)
            .transpose()
            .map_err(|fault| self.fail(&fault))?;
        self.came_out(generated.unwrap_or(self.generated));
        let waiting = self.given.saturating_sub(self.generated);
        Ok(self.ahead.saturating_sub(waiting as usize))
    }

    /// Returns the voltages that lead from the stream's last sample to zero: the mirrored end of
    /// the stream, multiplied by a falling weight. If these voltages would exceed the limit of the
    /// direct voltage, returns a single zero.
    pub(crate) fn tail(&self) -> Vec<f64> {
        let mut tail = self.ramp(self.last_v, self.direct.mirrored());
        tail.push(0.0);
        match self.direct.excess(&tail) {
            None => tail,
            Some(_) => vec![0.0],
        }
    }

    /// Gives the driver as many of these voltages as fit, and returns their number.
    pub(crate) fn give(&mut self, volts: &[f64]) -> Result<usize, DeviceError> {
        self.usable()?;
        let task = self.task.as_ref();
        let given = task
            .map_or(Ok(0), |task| {
                let space = task.space()?;
                match space.min(volts.len()) {
                    0 => Ok(0),
                    fitting => task.write(&volts[..fitting], false),
                }
            })
            .map_err(|fault| self.fail(&fault))?;
        // The call may have hung so long that another thread has set the output to zero in the
        // meantime.
        self.still_holds()?;
        self.given += given as u64;
        self.direct.push(&volts[..given]);
        Ok(given)
    }

    fn came_out(&mut self, generated: u64) {
        if generated > self.generated {
            self.moved_at = Instant::now();
        }
        self.generated = generated;
    }

    /// Reads the driver's state. After an error, or if the clock stands still, sets the output to
    /// zero.
    pub(crate) fn watch(&mut self) {
        let Some(task) = &self.task else { return };
        match task.is_done().and_then(|done| Ok((done, task.generated()?))) {
            Ok((false, generated)) => {
                self.came_out(generated);
                if self.moved_at.elapsed() > STILL {
                    let words = "the sample clock stands still".to_owned();
                    self.error = Some(self.fail(&Fault { code: 0, words }));
                }
            }
            Ok((true, _)) => {
                let words = "the task ended by itself".to_owned();
                self.error = Some(self.fail(&Fault { code: 0, words }));
            }
            Err(fault) => self.error = Some(self.fail(&fault)),
        }
    }

    /// Returns the error after which a voltage may remain at the display, if no call has returned
    /// this error yet.
    pub(crate) fn untold_danger(&self) -> Option<&DeviceError> {
        self.error.as_ref().filter(|_| self.not_zero)
    }

    /// Returns the number of frames given to the driver, and the number of frames that were output
    /// so far. Both include the lead.
    pub(crate) fn progress(&self) -> (u64, u64) {
        (self.given, self.generated)
    }

    pub(crate) fn is_running(&self) -> bool {
        self.task.is_some()
    }

    pub(crate) fn status(&self) -> Status {
        let played = self.generated.saturating_sub(self.lead);
        Status {
            frames_played: played.min(self.status.frames_written),
            latency_s: self.latency_s(),
            ..self.status
        }
    }

    /// Returns the latency of a sample, seconds. After the session has ended, returns the latency
    /// of the last sample.
    fn latency_s(&self) -> f64 {
        match self.task {
            Some(_) => self.waiting_s(),
            None => self.status.latency_s,
        }
    }

    fn waiting_s(&self) -> f64 {
        self.given.saturating_sub(self.generated) as f64 / self.rate_hz
    }

    /// Stops, sets the output to zero and takes no more samples. Returns an earlier error if there
    /// was one.
    pub(crate) fn close(&mut self) -> Result<(), DeviceError> {
        if self.closed {
            return self.error.take().map_or(Ok(()), Err);
        }
        let zero = self.end();
        zero.map_err(|fault| fault.failed_and_not_zero(&self.rig.device))
    }

    pub(crate) fn usable(&mut self) -> Result<(), DeviceError> {
        self.still_holds()?;
        match self.error.take() {
            Some(error) => Err(error),
            None if self.closed => Err(DeviceError::Closed(self.rig.device.clone())),
            None => Ok(()),
        }
    }

    /// Ends the session if a call took so long that another thread has set the output to zero.
    fn still_holds(&mut self) -> Result<(), DeviceError> {
        match self.emergency.error() {
            Some(error) if !self.closed => Err(self
                .end()
                .err()
                .map_or(error, |fault| fault.failed_and_not_zero(&self.rig.device))),
            _ => Ok(()),
        }
    }

    /// Starts the clock with a lead of zeros. The lead is half as long as `ahead`, so that the
    /// first write is not late. If the first sample is not zero, the lead ends with a ramp to this
    /// sample. The ramp mirrors the first samples.
    fn start(&mut self, volts: &[f64]) -> Result<(), DeviceError> {
        let (first, rest) = (volts[0], volts.get(1..).unwrap_or_default());
        let there = if rest.is_empty() { volts } else { rest };
        let back = there.iter().chain(there.iter().rev()).copied().cycle();
        let ramp = self.ramp(first, back);
        let mut lead = vec![0.0; (self.ahead / 2).saturating_sub(ramp.len())];
        lead.extend(ramp.iter().rev());
        self.check_direct(&lead)?;
        let started = self.started(&lead);
        self.task = Some(started.map_err(|fault| self.fail(&fault))?);
        self.still_holds()?;
        self.moved_at = Instant::now();
        self.lead = lead.len() as u64;
        self.given = self.lead;
        self.direct.push(&lead);
        Ok(())
    }

    /// Starts a task with a running clock.
    fn started(&self, lead: &[f64]) -> Result<Task, Fault> {
        let limit_v = self.rig.limit_v / self.rig.gain;
        let task = Task::new(self.driver, &self.rig.device, limit_v)?;
        let capacity = u32::try_from(self.capacity).unwrap_or(u32::MAX);
        task.set_clock(self.rate_hz, capacity)?;
        // The lead must be in the buffer before the clock starts. Otherwise the buffer would run
        // dry at once.
        task.write(lead, false)?;
        // The task is recorded before the start, because the start itself may hang.
        self.emergency.runs(Some(task.stopper()));
        let started = task.start();
        // The task is cleared on return, so no other thread may use its handle then.
        if started.is_err() {
            self.emergency.runs(None);
        }
        started.map(|()| task)
    }

    /// Returns a ramp from `from_v` to zero, without its two ends. The ramp consists of the samples
    /// multiplied by a falling weight. It is empty if `from_v` is less than one step of the card.
    fn ramp(&self, from_v: f64, samples: impl Iterator<Item = f64>) -> Vec<f64> {
        if from_v.abs() * self.rig.gain < self.rig.step_v {
            return Vec::new();
        }
        let frames = (self.rig.ramp_s * self.rate_hz) as usize;
        let weight = |i: usize| (frames - i) as f64 / (frames + 1) as f64;
        let weighted = samples.take(frames).enumerate();
        weighted.map(|(i, volts)| volts * weight(i)).collect()
    }

    /// Sets the output to zero if these voltages would exceed the limit of the direct voltage.
    fn check_direct(&mut self, volts: &[f64]) -> Result<(), DeviceError> {
        let Some(Excess { at, mean_v }) = self.direct.excess(volts) else {
            return Ok(());
        };
        let frame = self.status.frames_written + at as u64;
        Err(match self.end() {
            Err(fault) => fault.failed_and_not_zero(&self.rig.device),
            Ok(()) => DeviceError::DirectVoltage {
                frame,
                mean_v: mean_v * self.rig.gain,
                limit_v: self.rig.dc_limit_v,
            },
        })
    }

    /// Checks that all samples are within the limit, and converts them to voltages of the card.
    fn checked(&mut self, samples: &[f32]) -> Result<Vec<f64>, DeviceError> {
        let mut volts = Vec::with_capacity(samples.len());
        for (i, &sample) in samples.iter().enumerate() {
            let display_v = f64::from(sample);
            let Some(card_v) = self.rig.card_v(display_v) else {
                return Err(self.refuse(self.status.frames_written + i as u64, display_v));
            };
            volts.push(card_v);
        }
        Ok(volts)
    }

    /// Sets the output to zero after a fault. If that fails, the returned error contains the
    /// warning.
    fn fail(&mut self, fault: &Fault) -> DeviceError {
        if let Err(error) = self.still_holds() {
            return error;
        }
        let zero = self.end();
        if fault.is_dry() {
            self.status.underruns += 1;
            // A buffer that ran dry has output everything.
            self.generated = self.given;
        }
        match zero {
            Err(_) => fault.failed_and_not_zero(&self.rig.device),
            Ok(()) if fault.is_dry() => DeviceError::Underflow {
                device: self.rig.device.clone(),
                frames: self.status().frames_played,
                advice: self.rig.larger_buffer(),
            },
            Ok(()) => fault.failed(&self.rig.device),
        }
    }

    /// Sets the output to zero because of an invalid sample.
    fn refuse(&mut self, frame: u64, value: f64) -> DeviceError {
        match self.end() {
            Err(fault) => fault.failed_and_not_zero(&self.rig.device),
            Ok(()) => DeviceError::OverLimit { frame, value, limit: self.rig.limit_v, unit: "V" },
        }
    }

    /// Ends the task, if one runs, and sets the output to zero for good.
    fn end(&mut self) -> Result<(), Fault> {
        self.closed = true;
        if let Some(task) = self.task.take() {
            // The task is cleared at the end of this block. No other thread may stop it after that.
            self.emergency.runs(None);
            self.generated = task.generated().unwrap_or(self.generated);
        }
        // No task reserves the output any more, so a separate task can write the zero.
        let zero = self.emergency.zero.put();
        self.not_zero = zero.is_err();
        self.claim = None;
        zero
    }
}
