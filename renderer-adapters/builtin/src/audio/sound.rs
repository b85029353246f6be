//! The part of an open sound output that runs in the thread that writes the samples.

use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::thread::sleep;
use std::time::{Duration, Instant};

use cpal::traits::{DeviceTrait, StreamTrait};
use cpal::{FromSample, OutputCallbackInfo, SampleFormat, SizedSample, StreamConfig};
use htex_device::{Capabilities, DeviceError, Output, Status, StreamFormat};
use rtrb::{Producer, RingBuffer};

use crate::audio::card::Card;
use crate::audio::failure::{Failure, failed, reporter};
use crate::audio::player::{Player, Shared, Wish};

/// Preferred number of channels.
const CHANNELS: u16 = 2;

/// How the channels of a card play the samples.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Channels<'a> {
    /// All channels of the card play the samples.
    All,
    /// The card has one channel for each factor. A channel plays the samples multiplied by the
    /// channel's factor.
    Factors(&'a [f32]),
}

/// Polling interval for free space.
const LOOK: Duration = Duration::from_millis(2);
/// If the card's thread makes no call for this long, the card is considered stopped.
const STILL: Duration = Duration::from_secs(2);

pub(crate) struct Sound {
    name: String,
    can: Capabilities,
    rate_hz: f64,
    ring: Producer<f32>,
    shared: Arc<Shared>,
    /// `None` after playback has ended.
    stream: Option<cpal::Stream>,
    playing: bool,
    /// The error of the card's thread.
    failure: Failure,
    written: u64,
    peak: f64,
}

impl Sound {
    pub(crate) fn open(
        card: &Card,
        buffer_s: f64,
        format: &StreamFormat,
        channels: Channels<'_>,
    ) -> Result<Self, DeviceError> {
        let preferred = match channels {
            Channels::All => CHANNELS,
            Channels::Factors(factors) => factors.len() as u16,
        };
        let (config, sample_format) = card.config(format.rate_hz, preferred)?;
        let factors = match channels {
            Channels::All => vec![1.0; usize::from(config.channels)],
            Channels::Factors(factors) => factors.to_vec(),
        };
        // The buffer has space for at least two blocks, so that one can be written while the other
        // plays.
        let buffered = (buffer_s * format.rate_hz) as usize;
        let (ring, samples) =
            RingBuffer::new(buffered.max(2 * format.block_frames as usize).max(2));
        let shared = Arc::new(Shared::default());
        let player = Player::new(samples, Arc::clone(&shared), format.rate_hz, factors);
        let failure = Failure::default();
        let counted = Arc::clone(&shared);
        let report = reporter(failure.clone(), move || {
            counted.underruns.fetch_add(1, Ordering::Relaxed);
        });
        let build = match sample_format {
            SampleFormat::I32 => build::<i32>,
            SampleFormat::I16 => build::<i16>,
            SampleFormat::U8 => build::<u8>,
            _ => build::<f32>,
        };
        let stream = build(&card.device, config, player, Box::new(report));
        Ok(Self {
            name: card.name.clone(),
            can: card.capabilities()?,
            rate_hz: format.rate_hz,
            ring,
            shared,
            stream: Some(stream.map_err(|error| failed(&card.name, error.to_string()))?),
            playing: false,
            failure,
            written: 0,
            peak: 0.0,
        })
    }

    /// Starts the card's thread.
    fn play(&mut self) -> Result<(), DeviceError> {
        if let (false, Some(stream)) = (self.playing, &self.stream) {
            let played = stream.play();
            played.map_err(|error| failed(&self.name, error.to_string()))?;
            self.playing = true;
        }
        Ok(())
    }

    fn usable(&self) -> Result<(), DeviceError> {
        match self.failure.remove() {
            Some(what) => Err(failed(&self.name, what)),
            None if self.stream.is_none() => Err(DeviceError::Closed(self.name.clone())),
            None => Ok(()),
        }
    }

    fn check(&mut self, samples: &[f32]) -> Result<(), DeviceError> {
        let checked = self.can.check_samples(samples, self.written);
        if checked.is_err() {
            self.end(Wish::Stop)?;
        }
        checked
    }

    /// Ends playback. Closes the card after it has played the last sample.
    fn end(&mut self, wish: Wish) -> Result<(), DeviceError> {
        self.shared.wish(wish);
        let ended = self.wait_for_silence();
        self.stream = None;
        ended
    }

    fn wait_for_silence(&self) -> Result<(), DeviceError> {
        let (mut calls, mut since) = (0, Instant::now());
        while self.playing && !self.shared.silent.load(Ordering::Acquire) {
            self.usable()?;
            let now = self.shared.calls.load(Ordering::Acquire);
            if now != calls {
                (calls, since) = (now, Instant::now());
            } else if since.elapsed() > STILL {
                return Err(failed(&self.name, "it asks for no samples".to_owned()));
            }
            sleep(LOOK);
        }
        Ok(())
    }
}

impl Output for Sound {
    fn write(&mut self, samples: &[f32], timeout: Duration) -> Result<usize, DeviceError> {
        let since = Instant::now();
        self.usable()?;
        self.check(samples)?;
        let mut left = samples;
        loop {
            self.usable()?;
            let (pushed, rest) = self.ring.push_partial_slice(left);
            let peak = pushed.iter().fold(0.0f32, |peak, x| peak.max(x.abs()));
            self.peak = self.peak.max(f64::from(peak));
            self.written += pushed.len() as u64;
            left = rest;
            // Playback starts when half of the buffer is full.
            if 2 * self.ring.slots() <= self.ring.buffer().capacity() {
                self.play()?;
            }
            let time = timeout.saturating_sub(since.elapsed());
            if left.is_empty() || time.is_zero() {
                return Ok(samples.len() - left.len());
            }
            sleep(LOOK.min(time));
        }
    }

    fn status(&self) -> Status {
        let taken = self.shared.taken.load(Ordering::Relaxed);
        let delay = match &self.stream {
            Some(_) => self.shared.delay.load(Ordering::Relaxed),
            None => 0,
        };
        // The card plays a frame only after its delay.
        Status {
            frames_written: self.written,
            frames_played: taken.saturating_sub(delay),
            underruns: self.shared.underruns.load(Ordering::Relaxed),
            latency_s: (self.written.saturating_sub(taken) + delay) as f64 / self.rate_hz,
            peak: self.peak,
        }
    }

    fn finish(&mut self) -> Result<(), DeviceError> {
        self.usable()?;
        // Set before the ring buffer can become empty, because an empty ring would count as an
        // underrun.
        self.shared.wish(Wish::Drain);
        if self.written > 0 {
            self.play()?;
        }
        self.end(Wish::Drain)
    }
}

impl Drop for Sound {
    fn drop(&mut self) {
        if self.stream.is_some() {
            let _ = self.end(Wish::Stop);
        }
    }
}

fn build<T: SizedSample + FromSample<f32>>(
    device: &cpal::Device,
    config: StreamConfig,
    mut player: Player,
    report: Box<dyn FnMut(cpal::Error) + Send>,
) -> Result<cpal::Stream, cpal::Error> {
    let rate_hz = f64::from(config.sample_rate);
    let fill = move |out: &mut [T], info: &OutputCallbackInfo| {
        let at = info.timestamp();
        let delay = at.playback.duration_since(at.callback).as_secs_f64() * rate_hz;
        player.fill(out, delay as u64, T::from_sample);
    };
    device.build_output_stream(config, fill, report, None)
}
