//! A stream of samples (`XR_FB_haptic_pcm`) at the rate of the controller.
#![allow(unsafe_code)] // The runtime's functions are C.

use std::ptr::null;
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::motor::{Block, Motor, Plan};
use htex_device::DeviceError;
use openxr_sys as xr;

use crate::parametric::element::Element;

/// Maximum number of samples that a runtime can hold.
const MOST: usize = xr::MAX_HAPTIC_PCM_BUFFER_SIZE_FB;

pub(crate) struct Samples {
    element: Element,
    rate_hz: f64,
    block_s: f64,
    /// Samples that the runtime has not taken yet.
    waiting: Vec<f32>,
    /// Number of samples to collect before the first call: two blocks. So the runtime always has a
    /// block in reserve.
    first: usize,
    /// When the runtime began to play.
    since: Option<Instant>,
    /// Number of samples that the runtime has taken since it began to play.
    taken: u64,
}

impl Samples {
    /// Opens the haptic element. Nothing plays yet.
    pub(crate) fn open(element: Element, plan: &Plan, rate_hz: f64) -> Result<Self, DeviceError> {
        let first = 2 * plan.block_frames(rate_hz);
        if first > MOST {
            return Err(DeviceError::setting(
                "block_ms",
                format!(
                    "two blocks are {first} samples at {rate_hz} Hz, and a runtime keeps {MOST}; choose shorter blocks"
                ),
            ));
        }
        Ok(Self {
            element,
            rate_hz,
            block_s: plan.block_frames(rate_hz) as f64 / rate_hz,
            waiting: Vec::with_capacity(MOST),
            first,
            since: None,
            taken: 0,
        })
    }

    /// Passes the waiting samples on. The runtime takes as many as it has space for.
    fn send(&mut self) -> Result<(), String> {
        if self.waiting.is_empty() {
            return Ok(());
        }
        let mut taken = 0;
        let vibration = xr::HapticPcmVibrationFB {
            ty: xr::HapticPcmVibrationFB::TYPE,
            next: null(),
            buffer_size: self.waiting.len() as u32,
            buffer: self.waiting.as_ptr(),
            sample_rate: self.rate_hz as f32,
            append: self.since.is_some().into(),
            samples_consumed: &mut taken,
        };
        let header = (&raw const vibration).cast::<xr::HapticBaseHeader>();
        // SAFETY: the structure of the header; its arrays last until the call returns.
        unsafe { self.element.session.apply(self.element.hand, header) }?;
        self.since.get_or_insert_with(Instant::now);
        let taken = (taken as usize).min(self.waiting.len());
        self.taken += taken as u64;
        self.waiting.drain(..taken);
        Ok(())
    }
}

impl Motor for Samples {
    fn play(&mut self, block: &Block<'_>) -> Result<(), String> {
        self.element.session.follow()?;
        if self.waiting.len() + block.samples.len() > MOST {
            return Err(format!(
                "the runtime takes fewer samples than the {} a second that it says it plays",
                self.rate_hz
            ));
        }
        self.waiting.extend_from_slice(block.samples);
        if self.since.is_some() || self.waiting.len() >= self.first { self.send() } else { Ok(()) }
    }

    fn end(&mut self) -> Result<(), String> {
        let since = Instant::now();
        // Twice the time in which a runtime with a full buffer plays everything.
        let most = Duration::from_secs_f64(2.0 * (MOST as f64 / self.rate_hz).max(self.block_s));
        while !self.waiting.is_empty() {
            self.send()?;
            if since.elapsed() > most {
                return Err("the runtime does not take the last samples".to_owned());
            }
            if !self.waiting.is_empty() {
                sleep(Duration::from_secs_f64(self.block_s));
            }
        }
        if let Some(since) = self.since {
            let played_s = self.taken as f64 / self.rate_hz;
            sleep(Duration::from_secs_f64((played_s - since.elapsed().as_secs_f64()).max(0.0)));
        }
        self.stop()
    }

    fn stop(&mut self) -> Result<(), String> {
        self.element.stop()
    }

    fn delay_s(&self) -> f64 {
        self.block_s
    }
}
