//! Samples rendered ahead of time, where nothing changes.

/// Samples rendered at a time where nothing changes. Of 256, 512 and 1,024 the last let one core play the most
/// renderers in turn (`--example chains -- voices`).
const AHEAD: usize = 1024;

/// A buffer of samples: those from `taken` on are still to come.
pub(crate) struct Ahead {
    samples: Vec<f32>,
    taken: usize,
    /// Samples of the first time: fewer than of the others, as the seed has it, so that renderers that begin together
    /// do not all render at the same time later.
    first: usize,
}

impl Ahead {
    /// `wanted`: the renderer will render ahead.
    pub(crate) fn new(wanted: bool, seed: u64) -> Self {
        // Multiples of the golden ratio spread evenly.
        let part = seed.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 32;
        let first = (part * AHEAD as u64) >> 32;
        Self {
            samples: Vec::with_capacity(if wanted { AHEAD } else { 0 }),
            taken: 0,
            first: 1 + first as usize,
        }
    }

    /// All samples are taken.
    pub(crate) fn is_empty(&self) -> bool {
        self.taken == self.samples.len()
    }

    /// Copies what there is to the front of `out`; returns how many samples.
    pub(crate) fn take(&mut self, out: &mut [f32]) -> usize {
        let ready = &self.samples[self.taken..];
        let frames = out.len().min(ready.len());
        out[..frames].copy_from_slice(&ready[..frames]);
        self.taken += frames;
        frames
    }

    /// The buffer to fill, of at most `left` samples; it comes back by [`Self::end`].
    pub(crate) fn begin(&mut self, left: u64) -> Vec<f32> {
        let mut samples = std::mem::take(&mut self.samples);
        let frames = match samples.len() {
            0 => self.first,
            _ => AHEAD,
        };
        samples.resize((frames as u64).min(left) as usize, 0.0);
        samples
    }

    /// Takes the buffer back, filled.
    pub(crate) fn end(&mut self, samples: Vec<f32>) {
        (self.samples, self.taken) = (samples, 0);
    }
}
