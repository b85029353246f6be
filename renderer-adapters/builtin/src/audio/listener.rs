//! The part of a sound input that runs in the sound card's thread.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use rtrb::Producer;

/// State shared by the sound card's thread and the reader.
#[derive(Debug, Default)]
pub(crate) struct InputState {
    /// Whether frames were lost. No frames follow the lost ones.
    pub(crate) lost: AtomicBool,
    /// How often the card has delivered samples.
    pub(crate) calls: AtomicU64,
}

/// Puts samples into the ring buffer. Does not allocate or wait.
pub(crate) struct Listener {
    ring: Producer<f64>,
    heard: Arc<InputState>,
}

impl Listener {
    pub(crate) fn new(ring: Producer<f64>, heard: Arc<InputState>) -> Self {
        Self { ring, heard }
    }

    /// Takes all of these interleaved frames. If frames do not fit into the ring buffer, they are
    /// lost, and no more frames are taken from then on.
    pub(crate) fn push<T: Copy>(&mut self, samples: &[T], convert: impl Fn(T) -> f64) {
        if self.ring.slots() < samples.len() {
            self.heard.lost.store(true, Ordering::Release);
        }
        if !self.heard.lost.load(Ordering::Acquire) {
            for sample in samples {
                // Cannot fail: there is space for all samples.
                let _ = self.ring.push(convert(*sample));
            }
        }
        self.heard.calls.fetch_add(1, Ordering::Release);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rtrb::RingBuffer;

    #[test]
    fn nothing_comes_after_a_gap() {
        let (writer, mut ring) = RingBuffer::new(6);
        let heard = Arc::new(InputState::default());
        let mut listener = Listener::new(writer, Arc::clone(&heard));
        listener.push(&[1i16, 2, 3, 4], f64::from);
        assert!(!heard.lost.load(Ordering::Relaxed));
        // Only two places are free, so these four samples and all later ones are lost.
        listener.push(&[5i16, 6, 7, 8], f64::from);
        assert!(heard.lost.load(Ordering::Relaxed));
        let mut read: Vec<f64> = (0..4).map(|_| ring.pop().unwrap()).collect();
        listener.push(&[9i16, 10], f64::from);
        read.extend(ring.pop().ok());
        assert_eq!(read, [1.0, 2.0, 3.0, 4.0]);
        assert_eq!(heard.calls.load(Ordering::Relaxed), 3);
    }
}
