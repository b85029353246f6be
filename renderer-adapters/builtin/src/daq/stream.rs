//! An open analog output. A write waits until the buffer has space, and finishing a stream waits
//! until the card has output all samples.
//!
//! The device computes the number of waiting samples from the number of samples that were output.
//! The driver counts samples as output as soon as they are in the card's memory, which is before
//! the card outputs them. Therefore, the device does not use the free space that the driver
//! reports. The number of waiting samples does not include the ramp before a stream. With a live
//! motion, the buffer holds 20 ms (`live_default` of `buffer_ms`).

use std::sync::{Arc, MutexGuard};
use std::thread::sleep;
use std::time::{Duration, Instant};

use htex_device::{DeviceError, Output, Status, StreamFormat};

use crate::daq::driver::Driver;
use crate::daq::rig::Rig;
use crate::daq::session::Session;
use crate::daq::watchdog::{Watchdog, Watches};
use crate::daq::zero::Shared;

/// Polling interval for free space.
const LOOK: Duration = Duration::from_millis(2);
/// Number of zeros that are written at a time after the end of a stream.
const ZEROS: usize = 16_384;

pub(crate) struct Stream {
    shared: Arc<Shared>,
    _watchdogs: [Watchdog; 2],
}

impl Stream {
    pub(crate) fn open(
        rig: Rig,
        driver: &'static Driver,
        format: &StreamFormat,
    ) -> Result<Self, DeviceError> {
        let (device, buffer_s) = (rig.device.clone(), rig.buffer_s);
        let shared = Arc::new(Shared::new(Session::open(rig, driver, format)?));
        // At most 0.1 s, so that with `HANG` the output is at zero within half a second.
        let period = Duration::from_secs_f64((buffer_s / 4.0).min(0.1));
        let start = |watches| {
            let started = Watchdog::start(&shared, period, watches);
            started.map_err(|error| DeviceError::Failed {
                device: device.clone(),
                what: format!("cannot start its watchdog thread: {error}"),
            })
        };
        let watchdogs = [start(Watches::Output)?, start(Watches::Calls)?];
        Ok(Self { shared, _watchdogs: watchdogs })
    }

    fn session(&self) -> Result<MutexGuard<'_, Session>, DeviceError> {
        Ok(self.shared.lock()?)
    }

    /// Gives the driver the tail of the stream, and then zeros until the tail has been output. So
    /// the buffer is never empty while the clock runs.
    fn drain(&self) -> Result<(), DeviceError> {
        let mut tail = self.session()?.tail();
        let end = self.session()?.progress().0 + tail.len() as u64;
        loop {
            let mut session = self.session()?;
            session.watch();
            session.usable()?;
            let (_, generated) = session.progress();
            if generated >= end {
                return Ok(());
            }
            let given = session.give(&tail)?;
            drop(session);
            tail.drain(..given);
            tail.resize(tail.len().max(ZEROS), 0.0);
            sleep(LOOK);
        }
    }
}

impl Output for Stream {
    fn write(&mut self, samples: &[f32], timeout: Duration) -> Result<usize, DeviceError> {
        let since = Instant::now();
        let mut taken = 0;
        loop {
            taken += self.session()?.write(&samples[taken..])?;
            let left = timeout.saturating_sub(since.elapsed());
            if taken == samples.len() || left.is_zero() {
                return Ok(taken);
            }
            sleep(LOOK.min(left));
        }
    }

    fn status(&self) -> Status {
        let Ok(mut session) = self.session() else {
            return Status::default();
        };
        session.watch();
        session.status()
    }

    fn finish(&mut self) -> Result<(), DeviceError> {
        self.session()?.usable()?;
        let running = self.session()?.is_running();
        let drained = if running { self.drain() } else { Ok(()) };
        // The session is closed even if the end could not be played. In this case, the error of
        // playing is returned, because it came first.
        let closed = self.session().and_then(|mut session| session.close());
        drained.and(closed)
    }
}

impl Drop for Stream {
    fn drop(&mut self) {
        if let Err(error) = self.session().and_then(|mut session| session.close()) {
            crate::daq::watchdog::say(&error);
        }
    }
}
