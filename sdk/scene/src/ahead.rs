//! Rendering ahead while nothing changes.

/// Samples rendered ahead at a time. Of 256, 512 and 1,024 the last one let one core play the most renderers
/// in turn (`--example chains -- voices`).
const AHEAD: usize = 1024;

/// A buffer of rendered samples; those from `taken` on are not played yet.
pub(crate) struct Ahead {
    samples: Vec<f32>,
    taken: usize,
    /// Samples of the first buffer: fewer than of later ones, by an amount drawn from the seed, so that
    /// renderers started together do not all fill their buffers at the same time.
    first: usize,
}

impl Ahead {
    /// `wanted`: whether the renderer renders ahead.
    pub(crate) fn new(wanted: bool, seed: u64) -> Self {
        // Multiples of the golden ratio, which are evenly distributed.
        let part = seed.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 32;
        let first = (part * AHEAD as u64) >> 32;
        Self {
            samples: Vec::with_capacity(if wanted { AHEAD } else { 0 }),
            taken: 0,
            first: 1 + first as usize,
        }
    }

    /// Whether all samples are played.
    pub(crate) fn is_empty(&self) -> bool {
        self.taken == self.samples.len()
    }

    /// Copies buffered samples to the start of `out`; returns their number.
    pub(crate) fn take(&mut self, out: &mut [f32]) -> usize {
        let ready = &self.samples[self.taken..];
        let frames = out.len().min(ready.len());
        out[..frames].copy_from_slice(&ready[..frames]);
        self.taken += frames;
        frames
    }

    /// Takes the buffer out to be filled with at most `left` samples; [`Self::end`] returns it.
    pub(crate) fn begin(&mut self, left: u64) -> Vec<f32> {
        let mut samples = std::mem::take(&mut self.samples);
        let frames = match samples.len() {
            0 => self.first,
            _ => AHEAD,
        };
        samples.resize((frames as u64).min(left) as usize, 0.0);
        samples
    }

    /// Returns the filled buffer.
    pub(crate) fn end(&mut self, samples: Vec<f32>) {
        (self.samples, self.taken) = (samples, 0);
    }
}
