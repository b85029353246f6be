//! The part of a sound output that runs in the sound card's thread.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU8, AtomicU64, Ordering};

use rtrb::Consumer;

/// Duration of the fade when samples are missing, seconds.
const FADE_S: f64 = 0.005;

/// A request from the writer to the player.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Wish {
    /// Play the samples in the ring buffer. If a sample is missing, count an underrun.
    Play = 0,
    /// Play the samples that are still in the ring buffer, and then silence.
    Drain = 1,
    /// Fade out now.
    Stop = 2,
}

/// State shared by the sound card's thread and the writer.
#[derive(Debug, Default)]
pub(crate) struct Shared {
    wish: AtomicU8,
    /// Number of frames taken from the ring buffer.
    pub(crate) taken: AtomicU64,
    /// How often the ring buffer was empty.
    pub(crate) underruns: AtomicU64,
    /// Latency from taking a frame out of the ring buffer to playing it, frames.
    pub(crate) delay: AtomicU64,
    /// Whether the last sample has been played after [`Wish::Drain`] or [`Wish::Stop`].
    pub(crate) silent: AtomicBool,
    /// How often the card has asked for samples.
    pub(crate) calls: AtomicU64,
}

impl Shared {
    pub(crate) fn wish(&self, wish: Wish) {
        self.wish.store(wish as u8, Ordering::Release);
    }
}

/// Plays samples from the ring buffer. Does not allocate or wait.
pub(crate) struct Player {
    ring: Consumer<f32>,
    /// The factor of each channel. A channel plays each sample multiplied by its factor.
    factors: Vec<f32>,
    shared: Arc<Shared>,
    last: f32,
    gain: f32,
    step: f32,
    dry: bool,
    /// Number of silent frames since the last sample.
    quiet: u64,
}

impl Player {
    pub(crate) fn new(
        ring: Consumer<f32>,
        shared: Arc<Shared>,
        rate_hz: f64,
        factors: Vec<f32>,
    ) -> Self {
        Self {
            ring,
            factors,
            shared,
            last: 0.0,
            gain: 1.0,
            step: (1.0 / (FADE_S * rate_hz)) as f32,
            dry: false,
            quiet: 0,
        }
    }

    /// Fills interleaved frames. The card plays `delay` frames before them.
    pub(crate) fn fill<T: Copy>(&mut self, out: &mut [T], delay: u64, convert: impl Fn(f32) -> T) {
        let wish = self.shared.wish.load(Ordering::Acquire);
        let channels = self.factors.len().max(1);
        // Waits one block longer than the delay, because some systems only estimate the delay.
        let silent = self.quiet > delay + (out.len() / channels) as u64;
        for frame in out.chunks_mut(channels) {
            let sample = self.next(wish);
            for (to, factor) in frame.iter_mut().zip(&self.factors) {
                *to = convert(sample * factor);
            }
        }
        self.shared.delay.store(delay, Ordering::Relaxed);
        self.shared.silent.store(silent, Ordering::Release);
        self.shared.calls.fetch_add(1, Ordering::Release);
    }

    fn next(&mut self, wish: u8) -> f32 {
        let wanted = wish != Wish::Stop as u8;
        // After a stop, samples are discarded, and the last played sample fades out.
        match self.ring.pop().ok().filter(|_| wanted) {
            Some(sample) => {
                self.shared.taken.fetch_add(1, Ordering::Relaxed);
                (self.last, self.dry) = (sample, false);
                // Samples after a gap would begin with a click, so they fade in.
                self.gain = (self.gain + self.step).min(1.0);
            }
            None => {
                // A run of missing samples counts as one underrun.
                if !self.dry && wish == Wish::Play as u8 {
                    self.shared.underruns.fetch_add(1, Ordering::Relaxed);
                }
                self.dry = true;
                self.gain = (self.gain - self.step).max(0.0);
            }
        }
        let ended = self.gain == 0.0 && wish != Wish::Play as u8;
        self.quiet = if ended { self.quiet + 1 } else { 0 };
        self.last * self.gain
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rtrb::{Producer, RingBuffer};

    /// At 1 kHz a fade is five frames.
    fn player() -> (Producer<f32>, Arc<Shared>, Player) {
        let (writer, ring) = RingBuffer::new(64);
        let shared = Arc::new(Shared::default());
        let player = Player::new(ring, Arc::clone(&shared), 1_000.0, vec![1.0, -0.5]);
        (writer, shared, player)
    }

    fn played(player: &mut Player, frames: usize, delay: u64) -> Vec<f32> {
        let mut out = vec![9.0; 2 * frames];
        player.fill(&mut out, delay, |x| x);
        assert!(out.chunks(2).all(|frame| frame[1] == -0.5 * frame[0]));
        out.into_iter().step_by(2).collect()
    }

    fn near(played: &[f32], wanted: &[f32]) {
        let close = |(a, b): (&f32, &f32)| (a - b).abs() < 1e-6;
        assert!(played.iter().zip(wanted).all(close), "{played:?}");
    }

    #[test]
    fn a_gap_fades_and_is_counted_once() {
        let (mut writer, shared, mut player) = player();
        writer.push_entire_slice(&[0.5, 1.0]).unwrap();
        let faded = [0.5, 1.0, 0.8, 0.6, 0.4, 0.2, 0.0, 0.0];
        near(&played(&mut player, 8, 0), &faded);
        writer.push_entire_slice(&[1.0; 7]).unwrap();
        near(&played(&mut player, 7, 0), &[0.2, 0.4, 0.6, 0.8, 1.0, 1.0, 1.0]);
        let counts =
            (shared.underruns.load(Ordering::Relaxed), shared.taken.load(Ordering::Relaxed));
        assert_eq!(counts, (1, 9));
    }

    #[test]
    fn the_end_is_no_gap_and_is_silent_when_it_has_come_out() {
        let (mut writer, shared, mut player) = player();
        writer.push_entire_slice(&[0.25, 0.0]).unwrap();
        shared.wish(Wish::Drain);
        near(&played(&mut player, 11, 3), &[0.25, 0.0, 0.0]);
        assert!(!shared.silent.load(Ordering::Relaxed));
        played(&mut player, 1, 9);
        assert!(!shared.silent.load(Ordering::Relaxed), "nine frames are under way");
        played(&mut player, 1, 3);
        assert!(shared.silent.load(Ordering::Relaxed));
        assert_eq!(shared.underruns.load(Ordering::Relaxed), 0);
    }

    #[test]
    fn a_stop_fades_without_what_waits() {
        let (mut writer, shared, mut player) = player();
        writer.push_entire_slice(&[1.0; 40]).unwrap();
        near(&played(&mut player, 1, 0), &[1.0]);
        shared.wish(Wish::Stop);
        near(&played(&mut player, 7, 0), &[0.8, 0.6, 0.4, 0.2, 0.0, 0.0, 0.0]);
        assert_eq!(shared.taken.load(Ordering::Relaxed), 1);
    }
}
