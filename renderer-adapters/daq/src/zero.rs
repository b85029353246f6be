//! The written zero, and the way to it when a call of the driver does not return.
//!
//! A call may hang while it holds the session. Nothing here needs the session: whoever waits for it
//! for [`HANG`] sets the output to zero by a task of its own, the watchdog or a caller. The session
//! sees that as soon as its call returns, and ends.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, TryLockError};
use std::thread::sleep;
use std::time::{Duration, Instant};

use htex_device::DeviceError;

use crate::driver::{Driver, Stopper, Task};
use crate::fault::{Fault, NOT_ZERO};
use crate::session::Session;

/// Attempts to output zero before the card is reset.
const ATTEMPTS: usize = 5;
/// Pause between two attempts, for transient faults.
const PAUSE: Duration = Duration::from_millis(10);
/// Time that one use of the session may take. With the watchdog's period, at most 0.1 s, zero is
/// written within half a second.
pub(crate) const HANG: Duration = Duration::from_millis(300);
/// Time between two looks at whether the session is free.
const LOOK: Duration = Duration::from_millis(1);

/// Outputs zero at one channel.
pub(crate) struct Zero {
    pub(crate) driver: &'static Driver,
    /// `Dev1/ao0`
    pub(crate) device: String,
    /// Limit of the card's voltage.
    pub(crate) limit_v: f64,
}

impl Zero {
    /// Outputs zero by a separate task without a clock; retries on failure, at last after a reset
    /// of the card.
    pub(crate) fn put(&self) -> Result<(), Fault> {
        let mut zero = self.once();
        for _ in 1..ATTEMPTS {
            if zero.is_ok() {
                return zero;
            }
            sleep(PAUSE);
            zero = self.once();
        }
        // A reset ends all tasks of the card and sets its outputs to their power-on state, which
        // need not be zero: so zero is written again.
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

/// Another thread has had the session for [`HANG`].
pub(crate) struct Hung {
    /// Says so, and whether the output was set to zero.
    pub(crate) error: DeviceError,
    /// Whether this thread was the first to find it, and set the output to zero.
    pub(crate) is_first: bool,
}

impl From<Hung> for DeviceError {
    fn from(hung: Hung) -> Self {
        hung.error
    }
}

/// Zero without the session.
pub(crate) struct Emergency {
    pub(crate) zero: Zero,
    /// The task whose clock runs, which holds the output.
    running: Mutex<Option<Stopper>>,
    has_begun: AtomicBool,
    /// The error of the emergency, when it is over.
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

    /// Notes the task whose clock runs from now on; `None` before the task is cleared.
    pub(crate) fn runs(&self, task: Option<Stopper>) {
        *self.running.lock().unwrap_or_else(PoisonError::into_inner) = task;
    }

    /// The error of an emergency that has begun.
    pub(crate) fn error(&self) -> Option<DeviceError> {
        if !self.has_begun.load(Ordering::SeqCst) {
            return None;
        }
        let error = self.error.lock().unwrap_or_else(PoisonError::into_inner);
        Some(error.clone().unwrap_or_else(|| self.hangs(NOT_ZERO)))
    }

    /// Sets the output to zero, once; returns the error that says why, and whether it is.
    fn begin(&self) -> Hung {
        if self.has_begun.swap(true, Ordering::SeqCst) {
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

/// The session that callers and the watchdog share.
pub(crate) struct Shared {
    session: Mutex<Session>,
    /// Counts the uses of the session: one that lasts hangs, many short ones do not.
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

    /// The session, as soon as it is free.
    ///
    /// # Errors
    /// When another thread has had it for [`HANG`]: the output was then set to zero, or the error
    /// says that it could not be.
    pub(crate) fn lock(&self) -> Result<MutexGuard<'_, Session>, Hung> {
        let mut turn = self.turn.load(Ordering::SeqCst);
        let mut since = Instant::now();
        loop {
            match self.session.try_lock() {
                Ok(session) => return Ok(self.taken(session)),
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
