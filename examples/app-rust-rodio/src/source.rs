//! A texture as a source of rodio.

use std::num::NonZero;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Duration;

use htex::{Motion, Texture, Voice, VoiceOptions};
use rodio::{ChannelCount, Sample, SampleRate, Source, nz};

/// Number of samples between two readings of the finger: 1.3 ms at 48 kHz.
const BLOCK: usize = 64;

/// The speed and the force of a finger. One thread sets them, and the audio thread reads them. The
/// finger is away until the first call of [`Finger::slide`].
#[derive(Clone, Default)]
pub struct Finger(Arc<[AtomicU32; 2]>);

impl Finger {
    /// Sets the speed, mm/s, and the force, newtons.
    pub fn slide(&self, speed_mm_s: f32, force_n: f32) {
        // The audio thread may read the new speed with the old force. A voice takes 10 ms to follow,
        // so this does not matter.
        self.0[0].store(speed_mm_s.to_bits(), Ordering::Relaxed);
        self.0[1].store(force_n.to_bits(), Ordering::Relaxed);
    }

    fn motion(&self) -> Motion {
        let [speed_mm_s, force_n] =
            [0, 1].map(|index| f32::from_bits(self.0[index].load(Ordering::Relaxed)));
        Motion::new(speed_mm_s.into(), force_n.into())
    }
}

/// Plays a texture at the motion of a finger: one channel, without an end.
pub struct TextureSource {
    voice: Voice,
    finger: Finger,
    rate: SampleRate,
    block: [f32; BLOCK],
    next: usize,
}

impl TextureSource {
    /// Makes a source with the sample rate of the sound card, so that rodio need not resample.
    pub fn new(texture: &Texture, finger: Finger, rate: NonZero<u32>) -> Result<Self, htex::Error> {
        // Samples are in the unit of the texture, such as newtons. A sound card expects samples from
        // -1 to 1.
        let options = VoiceOptions::default()
            .with_rate_hz(rate.get().into())
            .with_gain(0.1 / texture.level_rms(None)?)
            .with_limit(0.9);
        let voice = texture.voice(&options)?;
        Ok(Self { voice, finger, rate, block: [0.0; BLOCK], next: BLOCK })
    }
}

impl Iterator for TextureSource {
    type Item = Sample;

    fn next(&mut self) -> Option<Sample> {
        if self.next == BLOCK {
            // After an error, the voice plays on as before, or is silent.
            let _ = self.voice.set_motion(self.finger.motion());
            let _ = self.voice.render(&mut self.block);
            self.next = 0;
        }
        self.next += 1;
        Some(self.block[self.next - 1])
    }
}

impl Source for TextureSource {
    fn current_span_len(&self) -> Option<usize> {
        None
    }

    fn channels(&self) -> ChannelCount {
        nz!(1)
    }

    fn sample_rate(&self) -> SampleRate {
        self.rate
    }

    fn total_duration(&self) -> Option<Duration> {
        None
    }
}
