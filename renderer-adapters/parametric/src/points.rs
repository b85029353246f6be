//! A stream of points: `XR_EXT_haptic_parametric`.
#![allow(unsafe_code)] // The runtime's functions are C.

use std::ptr::null;
use std::thread::sleep;
use std::time::{Duration, Instant};

use htex_device::DeviceError;
use htex_device_motor::{Block, Motor, Plan};
use htex_dsp::reduced::{Point, Points, Scale};
use openxr_sys as xr;

use crate::element::Element;
use crate::structures::{
    FREQUENCIES_HZ, Frame, MOST_POINTS, Properties, VIBRATION, Vibration, XrPoint,
};

/// The range of frequencies where neither a person nor the runtime states one, hertz: from a little
/// below what wideband actuators reach to a little above what a finger feels best.
const USUAL_HZ: (f64, f64) = (50.0, 500.0);
pub(crate) struct Stream {
    element: Element,
    scale: Scale,
    rate_hz: f64,
    points: Points,
    /// Points that were not handed over.
    waiting: Vec<Point>,
    /// Seconds of samples that were handed over.
    sent_s: f64,
    /// Length of the first frame at least, and of each other one, seconds. The first one is a block
    /// longer than the others: each comes a block before the runtime needs it.
    first_s: f64,
    frame_s: f64,
    block_s: f64,
    /// When the first frame was handed over: the runtime's time 0.
    since: Option<Instant>,
}

impl Stream {
    /// Opens the haptic element; nothing plays.
    pub(crate) fn open(
        element: Element,
        plan: &Plan,
        range_hz: Option<(f64, f64)>,
        rate_hz: f64,
    ) -> Result<Self, DeviceError> {
        let properties = element.session.properties(element.hand).map_err(DeviceError::Missing)?;
        let (low_hz, high_hz) = range(range_hz, &properties);
        let block_s = plan.block_frames(rate_hz) as f64 / rate_hz;
        let frame_s = seconds(properties.ideal_frame).max(block_s);
        let first_s = seconds(properties.least_first_frame).max(frame_s + block_s);
        // One point for each block, and one more at the start and at the end.
        let most_s = (MOST_POINTS - 3) as f64 * block_s;
        if first_s > most_s {
            return Err(DeviceError::Setting {
                name: "block_ms".to_owned(),
                what: format!(
                    "the runtime asks for frames of {:.0} ms, and a frame has at most {MOST_POINTS} points; choose longer blocks",
                    1e3 * first_s
                ),
            });
        }
        Ok(Self {
            element,
            scale: Scale { gain: plan.gain, low_hz, high_hz },
            rate_hz,
            points: Points::default(),
            waiting: Vec::with_capacity(MOST_POINTS),
            sent_s: 0.0,
            first_s,
            frame_s,
            block_s,
            since: None,
        })
    }

    /// Seconds of samples that the points have.
    fn there_s(&self) -> f64 {
        self.points.frames as f64 / self.rate_hz
    }

    /// After a delay of this thread the runtime has played all that it had, and its time has gone
    /// on: what comes is of its present.
    fn catch_up(&mut self) {
        let now_s = self.since.map_or(0.0, |since| since.elapsed().as_secs_f64());
        if now_s > self.there_s() {
            self.points.frames = ((now_s + self.block_s) * self.rate_hz) as u64;
            self.sent_s = self.there_s();
        }
    }

    fn send(&mut self, frame: Frame) -> Result<(), String> {
        let point =
            |time_ns: i64, value: f32| XrPoint { time: xr::Duration::from_nanos(time_ns), value };
        let all = &self.waiting;
        let amplitudes: Vec<XrPoint> = all.iter().map(|p| point(p.time_ns, p.strength)).collect();
        let frequencies: Vec<XrPoint> = all.iter().map(|p| point(p.time_ns, p.place)).collect();
        let states_range = frame == Frame::FIRST || frame == Frame::WHOLE;
        let of_range = |hz: f64| {
            if states_range { hz as f32 } else { xr::FREQUENCY_UNSPECIFIED }
        };
        let vibration = Vibration {
            ty: VIBRATION,
            next: null(),
            amplitude_count: amplitudes.len() as u32,
            amplitudes: amplitudes.as_ptr(),
            frequency_count: frequencies.len() as u32,
            frequencies: frequencies.as_ptr(),
            transient_count: 0,
            transients: null(),
            min_frequency_hz: of_range(self.scale.low_hz),
            max_frequency_hz: of_range(self.scale.high_hz),
            frame,
        };
        let header = (&raw const vibration).cast::<xr::HapticBaseHeader>();
        // SAFETY: the structure of the registry; its arrays last until the call returns.
        unsafe { self.element.session.apply(self.element.hand, header) }?;
        self.sent_s = self.there_s();
        self.waiting.clear();
        Ok(())
    }
}

impl Motor for Stream {
    fn play(&mut self, block: &Block<'_>) -> Result<(), String> {
        self.element.session.follow()?;
        self.catch_up();
        let points = self.points.block(&block.measured, &self.scale, self.rate_hz);
        self.waiting.extend(points);
        let unsent_s = self.there_s() - self.sent_s + 0.5 / self.rate_hz;
        match self.since {
            None if unsent_s >= self.first_s => {
                self.send(Frame::FIRST)?;
                self.since = Some(Instant::now());
                Ok(())
            }
            Some(_) if unsent_s >= self.frame_s => self.send(Frame::INTERMEDIATE),
            _ => Ok(()),
        }
    }

    fn end(&mut self) -> Result<(), String> {
        if self.points.frames == 0 {
            return Ok(());
        }
        self.waiting.push(self.points.end(self.rate_hz));
        let left_s = match self.since {
            Some(since) => {
                self.send(Frame::LAST)?;
                self.there_s() - since.elapsed().as_secs_f64()
            }
            None => {
                self.send(Frame::WHOLE)?;
                self.there_s()
            }
        };
        sleep(Duration::from_secs_f64(left_s.max(0.0)));
        self.stop()
    }

    fn stop(&mut self) -> Result<(), String> {
        self.element.stop()
    }

    fn delay_s(&self) -> f64 {
        self.first_s - self.block_s
    }
}

/// The range of frequencies that the points cover: what a person states and what the element has,
/// as far as they meet.
fn range(stated_hz: Option<(f64, f64)>, properties: &Properties) -> (f64, f64) {
    let element = (f64::from(properties.min_frequency_hz), f64::from(properties.max_frequency_hz));
    let is_told = element.0 >= FREQUENCIES_HZ.0 && element.0 <= element.1;
    match (stated_hz, is_told) {
        (None, false) => USUAL_HZ,
        (None, true) => element,
        (Some(stated), false) => stated,
        // As the runtime does: both ends are moved into the range of the element.
        (Some((low, high)), true) => {
            (low.clamp(element.0, element.1), high.clamp(element.0, element.1))
        }
    }
}

fn seconds(duration: xr::Duration) -> f64 {
    duration.as_nanos().max(0) as f64 / 1e9
}
