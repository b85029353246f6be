//! A stream of points: `XR_EXT_haptic_parametric`.
#![allow(unsafe_code)] // The runtime's functions are C.

use std::ptr::null;
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::motor::{Block, Motor, Plan};
use htex_device::DeviceError;
use htex_dsp::reduced::{Point, Points, Scale};
use openxr_sys as xr;

use crate::parametric::element::Element;
use crate::parametric::structures::{
    FREQUENCIES_HZ, Frame, MOST_POINTS, Properties, VIBRATION, Vibration, XrPoint,
};

/// The frequency range that is used if neither the user nor the runtime states one, hertz. It
/// begins a little below the lowest frequencies of wideband actuators, and ends a little above the
/// frequencies that a finger feels best.
const USUAL_HZ: (f64, f64) = (50.0, 500.0);
pub(crate) struct Stream {
    element: Element,
    scale: Scale,
    rate_hz: f64,
    points: Points,
    /// Points that have not been passed to the runtime yet.
    waiting: Vec<Point>,
    /// Duration of the samples that were passed to the runtime, seconds.
    sent_s: f64,
    /// Minimum duration of the first frame, seconds. The first frame is at least one block longer
    /// than the other frames, because each frame is passed on one block before the runtime needs
    /// it.
    first_s: f64,
    /// Minimum duration of every other frame, seconds.
    frame_s: f64,
    block_s: f64,
    /// When the first frame was passed on. This moment is the runtime's time 0.
    since: Option<Instant>,
}

impl Stream {
    /// Opens the haptic element. Nothing plays yet.
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
            return Err(DeviceError::setting(
                "block_ms",
                format!(
                    "the runtime asks for frames of {:.0} ms, and a frame has at most {MOST_POINTS} points; choose longer blocks",
                    1e3 * first_s
                ),
            ));
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

    /// Returns the duration of the samples that the points cover, seconds.
    fn there_s(&self) -> f64 {
        self.points.frames as f64 / self.rate_hz
    }

    /// After a delay of this thread, skips to the runtime's current time. The runtime has then
    /// played all its points, but its time has continued.
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
        // Add half a sample, because the durations are rounded.
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

/// Returns the frequency range that the points cover: the range that the user states, limited to
/// the range that the haptic element supports.
fn range(stated_hz: Option<(f64, f64)>, properties: &Properties) -> (f64, f64) {
    let element = (f64::from(properties.min_frequency_hz), f64::from(properties.max_frequency_hz));
    let is_told = element.0 >= FREQUENCIES_HZ.0 && element.0 <= element.1;
    match (stated_hz, is_told) {
        (None, false) => USUAL_HZ,
        (None, true) => element,
        (Some(stated), false) => stated,
        // The runtime does the same with both ends of the range.
        (Some((low, high)), true) => {
            (low.clamp(element.0, element.1), high.clamp(element.0, element.1))
        }
    }
}

fn seconds(duration: xr::Duration) -> f64 {
    duration.as_nanos().max(0) as f64 / 1e9
}
