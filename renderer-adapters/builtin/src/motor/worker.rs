//! The thread that passes blocks to the motor in real time.

use std::collections::VecDeque;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use htex_device::DeviceError;
use htex_dsp::envelope::Analyser;
use htex_dsp::grid::Band;

use crate::motor::{Block, Motor};

/// A request from the writer to the thread.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) enum Wish {
    /// Wait for samples before the first block.
    #[default]
    Wait,
    Play,
    /// Play the samples in the buffer, then stop the motor.
    Drain,
    /// Stop the motor now.
    Stop,
}

/// The state that the writer and the thread share.
#[derive(Debug, Default)]
pub(crate) struct State {
    pub(crate) waiting: VecDeque<f32>,
    pub(crate) wish: Wish,
    /// Number of frames in the blocks that have been played.
    pub(crate) played: u64,
    pub(crate) underruns: u64,
    /// An error for the next call. The call returns the error and clears this field.
    pub(crate) error: Option<DeviceError>,
    /// Whether the motor is at rest for good.
    pub(crate) ended: bool,
}

#[derive(Debug, Default)]
pub(crate) struct Shared {
    state: Mutex<State>,
    changed: Condvar,
}

impl Shared {
    pub(crate) fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(crate) fn changed(&self) {
        self.changed.notify_all();
    }

    /// Waits for a change of the state, at most for this duration.
    pub(crate) fn wait<'a>(
        &'a self,
        state: MutexGuard<'a, State>,
        most: Duration,
    ) -> MutexGuard<'a, State> {
        let waited = self.changed.wait_timeout(state, most);
        waited.unwrap_or_else(PoisonError::into_inner).0
    }

    /// Waits until a time, or until the writer asks to stop.
    fn wait_until(&self, due: Instant) -> MutexGuard<'_, State> {
        let mut state = self.lock();
        while state.wish != Wish::Stop {
            let left = due.saturating_duration_since(Instant::now());
            if left.is_zero() {
                break;
            }
            state = self.wait(state, left);
        }
        state
    }

    fn wait_for_start(&self) {
        let mut state = self.lock();
        while state.wish == Wish::Wait {
            // The loop repeats until the state changes, so any long duration is suitable.
            state = self.wait(state, Duration::from_secs(3_600));
        }
    }
}

/// The state of the thread.
pub(crate) struct Worker {
    pub(crate) name: String,
    pub(crate) motor: Box<dyn Motor>,
    pub(crate) shared: Arc<Shared>,
    pub(crate) rate_hz: f64,
    pub(crate) block_frames: usize,
}

/// What to do next when a block is over.
enum Next {
    Block,
    End,
    Stop,
    Dry,
}

impl Worker {
    pub(crate) fn run(mut self) {
        self.shared.wait_for_start();
        let rested = self.play();
        let Self { shared, motor, .. } = self;
        // Close the motor before the device is reported as ended.
        drop(motor);
        let mut state = shared.lock();
        state.waiting.clear();
        state.ended = true;
        if let Err(error) = rested {
            state.error = Some(error);
        }
        drop(state);
        shared.changed();
    }

    /// Plays blocks until the end of the samples, a stop or an error. The motor is at rest
    /// afterwards.
    fn play(&mut self) -> Result<(), DeviceError> {
        let mut analyser = Analyser::new(1, Band::TACTILE, self.rate_hz);
        let mut samples = Vec::with_capacity(self.block_frames);
        let mut due = Instant::now();
        loop {
            let next = self.next(due, &mut samples);
            self.shared.changed();
            match next {
                Next::Block => {}
                Next::End => return self.motor.end().map_err(|what| self.failed(what)),
                Next::Stop => return self.stop(),
                // If the motor cannot be stopped, this error is returned, because it matters more
                // than an underrun.
                Next::Dry => return self.stop().and(Err(self.ran_dry())),
            }
            analyser.push(&samples);
            let measured = analyser.read(&mut []);
            let block = Block { samples: &samples, measured };
            if let Err(what) = self.motor.play(&block) {
                // An error of stopping is ignored, because the reason why the motor failed says
                // more.
                let _ = self.motor.stop();
                return Err(self.failed(what));
            }
            let length = Duration::from_secs_f64(samples.len() as f64 / self.rate_hz);
            // After a delay of the program, the missed blocks must not be played all at once.
            let latest = Instant::now().checked_sub(length).unwrap_or(due);
            due = (due + length).max(latest);
        }
    }

    /// Waits until the block in `samples` is over, and replaces it with the next block.
    fn next(&self, due: Instant, samples: &mut Vec<f32>) -> Next {
        let mut state = self.shared.wait_until(due);
        if state.wish == Wish::Stop {
            return Next::Stop;
        }
        state.played += samples.len() as u64;
        samples.clear();
        let there = state.waiting.len().min(self.block_frames);
        match (there == self.block_frames, state.wish) {
            (false, Wish::Drain) if there == 0 => return Next::End,
            (false, Wish::Drain) | (true, _) => {}
            (false, _) => {
                state.underruns += 1;
                return Next::Dry;
            }
        }
        samples.extend(state.waiting.drain(..there));
        Next::Block
    }

    fn stop(&mut self) -> Result<(), DeviceError> {
        self.motor.stop().map_err(|what| self.failed(what))
    }

    fn failed(&self, what: String) -> DeviceError {
        DeviceError::Failed { device: self.name.clone(), what }
    }

    fn ran_dry(&self) -> DeviceError {
        DeviceError::Underflow {
            device: self.name.clone(),
            frames: self.shared.lock().played,
            advice: "give samples earlier, or a larger `buffer_ms`".to_owned(),
        }
    }
}
