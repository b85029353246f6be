//! Runs in the thread that reads the samples of an open sound input.

use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::thread::sleep;
use std::time::{Duration, Instant};

use cpal::traits::{DeviceTrait, StreamTrait};
use cpal::{FromSample, InputCallbackInfo, Sample, SampleFormat, SizedSample, StreamConfig};
use htex_device::{Channel, DeviceError, Input, InputFrames, InputStream};
use rtrb::{Consumer, RingBuffer};

use crate::audio::card::Card;
use crate::audio::failure::{Failure, failed, reporter};
use crate::audio::listener::{InputState, Listener};

/// Polling interval for samples.
const LOOK: Duration = Duration::from_millis(2);
/// If the card's thread makes no call for this long, the card is considered stopped.
const STILL: Duration = Duration::from_secs(2);

pub(crate) struct Recorder {
    name: String,
    format: InputStream,
    ring: Consumer<f64>,
    heard: Arc<InputState>,
    failure: Failure,
    /// `None` after the end.
    stream: Option<cpal::Stream>,
    is_running: bool,
    delivered: u64,
    /// The card's number of calls when last polled, and the time when that number last changed.
    last_call: (u64, Instant),
}

impl Recorder {
    /// Opens a card without starting it. At most `buffered` samples may wait to be read.
    pub(crate) fn open(
        card: &Card,
        config: StreamConfig,
        format: SampleFormat,
        buffered: usize,
    ) -> Result<Self, DeviceError> {
        let (writer, ring) = RingBuffer::new(buffered);
        let heard = Arc::new(InputState::default());
        let listener = Listener::new(writer, Arc::clone(&heard));
        let (failure, lost) = (Failure::default(), Arc::clone(&heard));
        let report = reporter(failure.clone(), move || {
            lost.lost.store(true, Ordering::Release);
        });
        let build = match format {
            SampleFormat::I32 => build::<i32>,
            SampleFormat::I16 => build::<i16>,
            SampleFormat::U8 => build::<u8>,
            _ => build::<f32>,
        };
        let stream = build(&card.device, config, listener, Box::new(report));
        let channel = |number: u16| Channel::new(format!("ch{number}"), "");
        Ok(Self {
            name: card.name.clone(),
            format: InputStream {
                rate_hz: f64::from(config.sample_rate),
                channels: (1..=config.channels).map(channel).collect(),
            },
            ring,
            heard,
            failure,
            stream: Some(stream.map_err(|error| failed(&card.name, error.to_string()))?),
            is_running: false,
            delivered: 0,
            last_call: (0, Instant::now()),
        })
    }

    /// Reads the complete frames that are available now.
    fn read_now(&mut self, samples: &mut [f64]) -> usize {
        let width = self.format.channels.len();
        let frames = (self.ring.slots() / width).min(samples.len() / width);
        for sample in &mut samples[..frames * width] {
            // Cannot fail: that many samples are in the ring buffer.
            *sample = self.ring.pop().unwrap_or_default();
        }
        frames
    }

    /// Returns the error that stopped the input, if there is one. After an error, the input delivers
    /// only the samples that are still in the ring buffer.
    fn fault(&mut self) -> Option<DeviceError> {
        if let Some(what) = self.failure.peek() {
            return Some(failed(&self.name, what));
        }
        if self.heard.lost.load(Ordering::Acquire) {
            return Some(DeviceError::Overrun {
                device: self.name.clone(),
                frames: self.delivered,
                advice: "close other programs, lower `rate_hz`, or raise `buffer_s`".to_owned(),
            });
        }
        let calls = self.heard.calls.load(Ordering::Acquire);
        if calls != self.last_call.0 {
            self.last_call = (calls, Instant::now());
        }
        let is_still = self.last_call.1.elapsed() > STILL;
        let what = "it delivers no samples; it may have been pulled out";
        is_still.then(|| failed(&self.name, what.to_owned()))
    }
}

impl Input for Recorder {
    fn stream(&self) -> &InputStream {
        &self.format
    }

    fn start(&mut self) -> Result<(), DeviceError> {
        let Some(stream) = &self.stream else {
            return Err(DeviceError::Closed(self.name.clone()));
        };
        if !self.is_running {
            let played = stream.play();
            played.map_err(|error| failed(&self.name, error.to_string()))?;
            self.is_running = true;
            // The time between opening and starting does not count as a standstill.
            self.last_call.1 = Instant::now();
        }
        Ok(())
    }

    fn read(&mut self, samples: &mut [f64], timeout: Duration) -> Result<InputFrames, DeviceError> {
        if self.stream.is_none() || !self.is_running {
            return Err(DeviceError::Closed(self.name.clone()));
        }
        let since = Instant::now();
        loop {
            // The fault is read before the samples. Otherwise samples that arrived before the fault
            // could be missed.
            let fault = self.fault();
            let frames = self.read_now(samples);
            if frames > 0 {
                self.delivered += frames as u64;
                return Ok(InputFrames::Count(frames));
            }
            // A read with an empty buffer must not end the input, because samples may still wait in
            // the ring buffer.
            if let (Some(fault), false) = (fault, samples.is_empty()) {
                self.stream = None;
                return Err(fault);
            }
            if since.elapsed() >= timeout {
                return Ok(InputFrames::Count(0));
            }
            sleep(LOOK.min(timeout.saturating_sub(since.elapsed())));
        }
    }

    fn finish(&mut self) -> Result<(), DeviceError> {
        self.stream = None;
        Ok(())
    }
}

fn build<T: SizedSample>(
    device: &cpal::Device,
    config: StreamConfig,
    mut listener: Listener,
    report: Box<dyn FnMut(cpal::Error) + Send>,
) -> Result<cpal::Stream, cpal::Error>
where
    f64: FromSample<T>,
{
    let take = move |samples: &[T], _: &InputCallbackInfo| {
        listener.push(samples, f64::from_sample);
    };
    device.build_input_stream(config, take, report, None)
}
