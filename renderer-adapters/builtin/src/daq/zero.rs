//! Writes zero to the output, even if a call to the driver does not return.
//!
//! A driver call may hang while it holds the lock of the session. Therefore, this module does not
//! use the session. If the watchdog or a caller waits for the session longer than [`HANG`], the
//! waiting thread sets the output to zero with a separate driver task. When the driver call
//! returns, the session notices that another task took over, and ends.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, TryLockError};
use std::thread::sleep;
use std::time::{Duration, Instant};

use htex_device::DeviceError;

use crate::daq::driver::{Driver, Stopper, Task};
use crate::daq::fault::{Fault, NOT_ZERO};
use crate::daq::session::Session;

/// Number of attempts to output zero before the card is reset.
const ATTEMPTS: usize = 5;
/// Pause between two attempts, so that transient faults can pass.
const PAUSE: Duration = Duration::from_millis(10);
/// Longest time that one use of the session may take. Together with the watchdog's period (at most
/// 0.1 s), it ensures that zero is written within half a second.
pub(crate) const HANG: Duration = Duration::from_millis(300);
/// Polling interval while waiting for the session.
const LOOK: Duration = Duration::from_millis(1);

/// Writes zero to one output channel.
pub(crate) struct Zero {
    pub(crate) driver: &'static Driver,
    /// The output, e.g. `Dev1/ao0`.
    pub(crate) device: String,
    /// Limit of the card's voltage, volts.
    pub(crate) limit_v: f64,
}

impl Zero {
    /// Outputs zero with a separate task without a clock. Retries on failure, the last time after a
    /// reset of the card.
    pub(crate) fn put(&self) -> Result<(), Fault> {
        let mut zero = self.once();
        for _ in 1..ATTEMPTS {
            if zero.is_ok() {
                return zero;
            }
            sleep(PAUSE);
            zero = self.once();
        }
        // A reset ends all tasks of the card and sets its outputs to their power-on state. This
        // state may differ from zero, so zero is written again.
        zero.or_else(|fault| {
            self.driver.reset(&self.device).map_err(|_| fault)?;
            self.once()
        })
    }

    fn once(&self) -> Result<(), Fault> {
        let task = Task::new(self.driver, &self.device, self.limit_v)?;
        match task.write(&[0.0], true)? {
            1 => task.stop(),
            written => {
                Err(Fault { code: 0, words: format!("{written} of 1 samples were written") })
            }
        }
    }
}

/// The error that another thread has held the session for longer than [`HANG`].
pub(crate) struct Hung {
    /// The error, which also says whether the output was set to zero.
    pub(crate) error: DeviceError,
    /// Whether this thread was the first to notice, and therefore set the output to zero.
    pub(crate) is_first: bool,
}

impl From<Hung> for DeviceError {
    fn from(hung: Hung) -> Self {
        hung.error
    }
}

/// Sets the output to zero in an emergency, without the session.
pub(crate) struct Emergency {
    pub(crate) zero: Zero,
    /// The task whose clock runs. This task holds the output.
    running: Mutex<Option<Stopper>>,
    has_begun: AtomicBool,
    /// The error of the emergency, once it is over.
    error: Mutex<Option<DeviceError>>,
}

impl Emergency {
    pub(crate) fn new(zero: Zero) -> Self {
        Self {
            zero,
            running: Mutex::new(None),
            has_begun: AtomicBool::new(false),
            error: Mutex::new(None),
        }
    }

    /// Records the task whose clock runs from now on. Call it with `None` before that task is
    /// cleared.
    pub(crate) fn runs(&self, task: Option<Stopper>) {
        *self.running.lock().unwrap_or_else(PoisonError::into_inner) = task;
    }

    /// Returns the error if an emergency has begun.
    pub(crate) fn error(&self) -> Option<DeviceError> {
        if !self.has_begun.load(Ordering::SeqCst) {
            return None;
        }
        let error = self.error.lock().unwrap_or_else(PoisonError::into_inner);
        Some(error.clone().unwrap_or_else(|| self.hangs(NOT_ZERO)))
    }

    /// Sets the output to zero once. The returned error gives the reason and says whether the
    /// output is at zero.
    fn begin(&self) -> Hung {
        if self.has_begun.swap(true, Ordering::SeqCst) {
            // The first emergency may still be running. Until it ends, the output counts as not at
            // zero.
            let error = self.error().unwrap_or_else(|| self.hangs(NOT_ZERO));
            let is_first = false;
            return Hung { error, is_first };
        }
        let zero = self.zero.once().or_else(|_| {
            let running = self.running.lock().unwrap_or_else(PoisonError::into_inner);
            if let Some(running) = running.as_ref() {
                running.stop();
            }
            drop(running);
            self.zero.put()
        });
        let error = match zero {
            Ok(()) => self.hangs("the output was set to zero"),
            Err(_) => self.hangs(NOT_ZERO),
        };
        *self.error.lock().unwrap_or_else(PoisonError::into_inner) = Some(error.clone());
        let is_first = true;
        Hung { error, is_first }
    }

    fn hangs(&self, output: &str) -> DeviceError {
        DeviceError::Failed {
            device: self.zero.device.clone(),
            what: format!(
                "a call of NI-DAQmx has not returned for {} s; {output}",
                HANG.as_secs_f64()
            ),
        }
    }
}

/// The session, shared by callers and the watchdog.
pub(crate) struct Shared {
    session: Mutex<Session>,
    /// Counts the uses of the session, to distinguish one long use (a hang) from many short uses.
    turn: AtomicU64,
    emergency: Arc<Emergency>,
}

impl Shared {
    pub(crate) fn new(session: Session) -> Self {
        Self {
            emergency: session.emergency(),
            session: Mutex::new(session),
            turn: AtomicU64::new(0),
        }
    }

    /// Waits until the session is free and returns it.
    ///
    /// # Errors
    /// Returns an error if another thread has held the session for longer than [`HANG`]. The error
    /// says whether the output could be set to zero.
    pub(crate) fn lock(&self) -> Result<MutexGuard<'_, Session>, Hung> {
        let mut turn = self.turn.load(Ordering::SeqCst);
        let mut since = Instant::now();
        loop {
            match self.session.try_lock() {
                Ok(session) => return Ok(self.taken(session)),
                // A panic in another thread must not prevent this thread from setting the output to
                // zero.
                Err(TryLockError::Poisoned(session)) => return Ok(self.taken(session.into_inner())),
                Err(TryLockError::WouldBlock) => {}
            }
            let now = self.turn.load(Ordering::SeqCst);
            if now != turn {
                (turn, since) = (now, Instant::now());
            } else if since.elapsed() >= HANG {
                return Err(self.emergency.begin());
            }
            sleep(LOOK);
        }
    }

    fn taken<'a>(&self, session: MutexGuard<'a, Session>) -> MutexGuard<'a, Session> {
        self.turn.fetch_add(1, Ordering::SeqCst);
        session
    }
}
