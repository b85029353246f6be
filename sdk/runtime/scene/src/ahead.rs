//! A buffer of samples rendered in advance, for scenes whose motion is constant.

/// Number of samples rendered in advance at a time. We tried 256, 512 and 1,024 samples: with
/// 1,024, one core can play the most renderers in turn (the example `chains`, mode `voices`).
const AHEAD: usize = 1024;

/// The buffer. Samples from index `taken` on have not been played yet.
pub(crate) struct Ahead {
    samples: Vec<f32>,
    taken: usize,
    /// Length of the first buffer, from 1 to [`AHEAD`]. It is derived from the seed, so that
    /// renderers started together fill their buffers at different times.
    first: usize,
}

impl Ahead {
    /// Makes an empty buffer, which has memory only if `wanted` is true.
    pub(crate) fn new(wanted: bool, seed: u64) -> Self {
        // Multiplying by 2⁶⁴ / φ spreads successive seeds evenly.
        let part = seed.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 32;
        let first = (part * AHEAD as u64) >> 32;
        Self {
            samples: Vec::with_capacity(if wanted { AHEAD } else { 0 }),
            taken: 0,
            first: 1 + first as usize,
        }
    }

    /// Whether all samples have been played.
    pub(crate) fn is_empty(&self) -> bool {
        self.taken == self.samples.len()
    }

    /// Copies buffered samples to the start of `out` and returns their number.
    pub(crate) fn read(&mut self, out: &mut [f32]) -> usize {
        let ready = &self.samples[self.taken..];
        let frames = out.len().min(ready.len());
        out[..frames].copy_from_slice(&ready[..frames]);
        self.taken += frames;
        frames
    }

    /// Moves the buffer out, resized to the next length but at most `left` samples. [`Self::end`]
    /// moves it back.
    pub(crate) fn begin(&mut self, left: u64) -> Vec<f32> {
        // The buffer is moved out, because the renderer borrows all of itself while it fills the
        // samples. An empty vector takes its place, which allocates nothing.
        let mut samples = std::mem::take(&mut self.samples);
        let frames = match samples.len() {
            0 => self.first,
            _ => AHEAD,
        };
        // Within the capacity, so this does not allocate.
        samples.resize((frames as u64).min(left) as usize, 0.0);
        samples
    }

    /// Takes the filled buffer back.
    pub(crate) fn end(&mut self, samples: Vec<f32>) {
        (self.samples, self.taken) = (samples, 0);
    }
}
