//! The effects of a motion on a voice's samples: slower or faster playback, the gain, and silence.

use htex_dsp::glide::Glide;
use htex_dsp::warp::Warp;

use crate::Motion;
use crate::exploration::{CONTACT_RAMP_S, Effects, HOLD_S, RecordedRange, Scaling, slides};

/// The state of a voice's effects.
#[derive(Debug)]
pub(crate) struct Follow {
    effects: Effects,
    /// Speed at which the source delivers samples, as a multiple of the recorded speed.
    base: f64,
    /// Highest reading speed at which no frequency exceeds half the sample rate, as a multiple of
    /// the recorded speed.
    fastest: f64,
    /// Reading speed of the texture, as a multiple of the recorded speed.
    ratio: f64,
    gain: f64,
    /// Present if frequencies follow the motion.
    warp: Option<Warp>,
    contact: Glide,
    /// Number of frames for which the last valid motion is held while readings are out of range.
    hold: u64,
    /// The frame at which the voice stops holding the last motion.
    ends: Option<u64>,
}

impl Follow {
    /// Makes the effects of a voice at `rate_hz`. The voice first plays as recorded. Its source
    /// delivers samples at `base` times the recorded speed. At `highest` times the recorded speed,
    /// the highest frequency of the texture equals half the sample rate.
    pub(crate) fn new(
        range: &RecordedRange,
        effects: Effects,
        base: f64,
        highest: f64,
        rate_hz: f64,
    ) -> Self {
        let ramp = (CONTACT_RAMP_S * rate_hz).ceil() as u32;
        let scales = effects.frequency_scaling && range.moves_frequencies();
        Self {
            effects,
            base,
            fastest: highest.max(base),
            ratio: base,
            gain: 1.0,
            warp: scales.then(|| Warp::when_needed((0.5 * base / highest).min(0.5))),
            contact: Glide::new(1.0, ramp),
            hold: (HOLD_S * rate_hz) as u64,
            ends: None,
        }
    }

    /// Starts with a motion, without a ramp, instead of playing as recorded.
    pub(crate) fn start(&mut self, motion: Motion, scaling: Scaling) {
        let felt = self.is_felt(motion) && motion.is_plausible();
        if felt {
            self.scale(motion, scaling);
        } else {
            self.contact.restart(0.0);
        }
    }

    /// Returns whether the voice is audible at a motion. An inaudible motion leaves the spectrum
    /// and the level unchanged.
    pub(crate) fn is_felt(&self, motion: Motion) -> bool {
        slides(motion.speed_mm_s, motion.force_n) || !self.effects.contact
    }

    /// Fades in or out, depending on whether the motion is felt.
    pub(crate) fn set_contact(&mut self, felt: bool) {
        self.ends = None;
        self.contact.set(if felt { 1.0 } else { 0.0 });
    }

    /// Sets reading speed and gain for a motion that is felt.
    pub(crate) fn scale(&mut self, motion: Motion, scaling: Scaling) {
        let Scaling { frequency, level } = scaling.with(self.effects);
        // Without the effect `contact`, the voice is audible even for a resting finger. Its speed
        // of 0 must not change the reading speed.
        if slides(motion.speed_mm_s, motion.force_n) {
            self.ratio = frequency.min(self.fastest);
        }
        self.gain = level;
    }

    /// Holds the last valid motion, because the reading at `frame` is out of range.
    pub(crate) fn hold(&mut self, frame: u64) {
        self.ends.get_or_insert(frame + self.hold);
    }

    /// Returns the gain of the level.
    pub(crate) fn gain(&self) -> f64 {
        self.gain
    }

    /// Returns the reading speed of the texture, as a multiple of the recorded speed.
    pub(crate) fn ratio(&self) -> f64 {
        self.ratio
    }

    /// Returns the offset within the next `len` samples (starting at `frame`) at which the voice
    /// falls silent. From there on its samples are 0 until the motion is felt again.
    pub(crate) fn sounding(&self, len: usize, frame: u64) -> usize {
        let until_zero = match (self.contact.until_zero(), self.ends) {
            (Some(left), _) => u64::from(left),
            // The fade begins where the hold ends.
            (None, Some(end)) => end.saturating_sub(frame) + u64::from(self.contact.ramp()),
            (None, None) => return len,
        };
        usize::try_from(until_zero).map_or(len, |left| left.min(len))
    }

    /// Returns whether the voice is silent.
    pub(crate) fn rests(&self) -> bool {
        self.contact.rests_at(0.0)
    }

    /// Fades the samples out while the finger does not slide, or its motion is unknown. The block
    /// starts at `frame`.
    pub(crate) fn apply_contact(&mut self, block: &mut [f32], frame: u64) {
        let left = self.ends.map(|end| end.saturating_sub(frame));
        let held = left.map_or(block.len(), |left| {
            usize::try_from(left).map_or(block.len(), |left| left.min(block.len()))
        });
        let (held, lost) = block.split_at_mut(held);
        self.contact.apply(held);
        // The hold may end inside a block. The fade begins at the sample at which the hold ends, so
        // that samples do not depend on the sizes of blocks.
        if !lost.is_empty() {
            self.contact.set(0.0);
            self.contact.apply(lost);
        }
    }

    /// Fills `out` with samples of the source, read at the speed that the motion requires.
    pub(crate) fn read(&mut self, out: &mut [f32], source: &mut dyn FnMut(&mut [f32])) {
        match &mut self.warp {
            // At the motion for which the voice was made, the ratio is exactly 1.
            Some(warp) => warp.process(self.ratio / self.base, out, source),
            None => source(out),
        }
    }

    /// Returns the highest reading speed, as a multiple of the recorded speed.
    pub(crate) fn fastest(&self) -> f64 {
        self.fastest
    }

    /// Returns the effects that are on.
    pub(crate) fn effects(&self) -> Effects {
        self.effects
    }
}
