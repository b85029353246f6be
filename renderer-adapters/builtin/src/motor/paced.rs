//! Runs in the thread that writes the samples of an open motor output.

use std::sync::Arc;
use std::thread::{Builder, JoinHandle};
use std::time::{Duration, Instant};

use htex_device::{Capabilities, DeviceError, Output, Status, StreamFormat};

use crate::motor::worker::{Shared, Wish, Worker};
use crate::motor::{Motor, Plan};

/// An output that passes its samples in blocks to a [`Motor`], at the pace of a clock.
pub struct PacedOutput {
    name: String,
    can: Capabilities,
    rate_hz: f64,
    block_frames: usize,
    /// Number of frames that the motor has received but not played yet.
    delayed: usize,
    capacity: usize,
    shared: Arc<Shared>,
    /// `None` after the device has ended.
    thread: Option<JoinHandle<()>>,
    written: u64,
    peak: f64,
}

impl PacedOutput {
    /// Opens an output called `name` for a motor that is at rest.
    ///
    /// # Errors
    /// Returns an error if the device does not support the rate, or no thread can be started.
    pub fn open(
        name: &str,
        motor: Box<dyn Motor>,
        plan: &Plan,
        can: Capabilities,
        format: &StreamFormat,
    ) -> Result<Self, DeviceError> {
        let rate_hz = format.rate_hz;
        if !can.has_rate(rate_hz) {
            return Err(crate::motor::rate_error(name, rate_hz, &can));
        }
        let block_frames = plan.block_frames(rate_hz);
        let least = 2 * block_frames.max(format.block_frames as usize);
        let capacity = ((plan.buffer_s * rate_hz) as usize).max(least);
        let delayed = (motor.delay_s() * rate_hz).round() as usize;
        let shared = Arc::new(Shared::default());
        // The motor's thread uses the same lock, so a write must not allocate while it holds the
        // lock.
        shared.lock().waiting.reserve_exact(capacity);
        let worker = Worker {
            name: name.to_owned(),
            motor,
            shared: Arc::clone(&shared),
            rate_hz,
            block_frames,
        };
        let builder = Builder::new().name("htex-motor".to_owned());
        let thread = builder.spawn(move || worker.run());
        let thread = thread.map_err(|error| DeviceError::Failed {
            device: name.to_owned(),
            what: format!("cannot start its thread: {error}"),
        })?;
        Ok(Self {
            name: name.to_owned(),
            can,
            rate_hz,
            block_frames,
            delayed,
            capacity,
            shared,
            thread: Some(thread),
            written: 0,
            peak: 0.0,
        })
    }

    fn usable(&self) -> Result<(), DeviceError> {
        let mut state = self.shared.lock();
        match state.error.take() {
            Some(error) => Err(error),
            None if state.ended || self.thread.is_none() => {
                Err(DeviceError::Closed(self.name.clone()))
            }
            None => Ok(()),
        }
    }

    /// Stops the motor and waits until it is at rest.
    fn end(&mut self, wish: Wish) {
        self.shared.lock().wish = wish;
        self.shared.changed();
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }

    /// Takes the samples that fit now. The motor starts when half of the buffer is full.
    fn push(&mut self, samples: &[f32]) -> usize {
        let mut state = self.shared.lock();
        let fits = self.capacity.saturating_sub(state.waiting.len());
        let taken = samples.get(..fits).unwrap_or(samples);
        state.waiting.extend(taken);
        // The thread needs a whole block. Otherwise the motor would run dry at once.
        let enough = (self.capacity / 2).max(self.block_frames);
        if state.wish == Wish::Wait && state.waiting.len() >= enough {
            state.wish = Wish::Play;
            self.shared.changed();
        }
        drop(state);
        // The peak is computed after the lock is released, so that the motor's thread can continue.
        let peak = taken.iter().fold(0.0_f32, |peak, x| peak.max(x.abs()));
        self.peak = self.peak.max(f64::from(peak));
        self.written += taken.len() as u64;
        taken.len()
    }
}

impl Output for PacedOutput {
    fn write(&mut self, samples: &[f32], timeout: Duration) -> Result<usize, DeviceError> {
        let since = Instant::now();
        self.usable()?;
        if let Err(error) = self.can.check_samples(samples, self.written) {
            self.end(Wish::Stop);
            return Err(error);
        }
        let mut left = samples;
        loop {
            let taken = self.push(left);
            left = left.get(taken..).unwrap_or_default();
            let time = timeout.saturating_sub(since.elapsed());
            if left.is_empty() || time.is_zero() {
                return Ok(samples.len() - left.len());
            }
            let state = self.shared.lock();
            // Wait only if there is still no space. If there is space now, nothing would end the
            // wait early.
            if state.waiting.len() >= self.capacity && !state.ended {
                drop(self.shared.wait(state, time));
            } else {
                drop(state);
            }
            self.usable()?;
        }
    }

    fn status(&self) -> Status {
        let state = self.shared.lock();
        let on_the_way =
            if state.ended { 0 } else { state.waiting.len() + self.block_frames + self.delayed };
        Status {
            frames_written: self.written,
            frames_played: state.played,
            underruns: state.underruns,
            latency_s: on_the_way as f64 / self.rate_hz,
            peak: self.peak,
        }
    }

    fn finish(&mut self) -> Result<(), DeviceError> {
        self.usable()?;
        self.end(Wish::Drain);
        self.shared.lock().error.take().map_or(Ok(()), Err)
    }
}

impl Drop for PacedOutput {
    fn drop(&mut self) {
        self.end(Wish::Stop);
    }
}
