//! The effects of a motion on a voice's samples: reading speed, gain, silence.

use htex_dsp::glide::Glide;
use htex_dsp::warp::Warp;

use crate::Motion;
use crate::exploration::{CONTACT_RAMP_S, Effects, Explored, slides};

/// The state of a voice's effects.
#[derive(Debug)]
pub(crate) struct Follow {
    explored: Explored,
    effects: Effects,
    /// Speed of the incoming samples, in the recorded speed.
    base: f64,
    /// Highest reading speed at which no frequency exceeds half the rate, in the recorded speed.
    fastest: f64,
    /// Reading speed of the texture, in the recorded speed.
    ratio: f64,
    gain: f64,
    /// If exactly one speed was recorded.
    warp: Option<Warp>,
    contact: Glide,
}

impl Follow {
    /// Makes the effects of a voice of `rate_hz` that starts with a motion, else as recorded. Its source has `base` times
    /// the recorded speed, and reaches half the rate at `highest` times the recorded speed.
    pub(crate) fn new(
        (explored, effects): (Explored, Effects),
        motion: Option<Motion>,
        base: f64,
        highest: f64,
        rate_hz: f64,
    ) -> Self {
        let ramp = (CONTACT_RAMP_S * rate_hz).ceil() as u32;
        let scales = effects.speed_scaling && explored.speed.is_one();
        let mut follow = Self {
            explored,
            effects,
            base,
            fastest: highest.max(base),
            ratio: base,
            gain: 1.0,
            warp: scales.then(|| Warp::when_needed((0.5 * base / highest).min(0.5))),
            contact: Glide::new(1.0, ramp),
        };
        if motion.is_some_and(|motion| !follow.set_motion(motion)) {
            follow.contact = Glide::new(0.0, ramp);
        }
        follow
    }

    /// Sets the motion; returns false if the voice is silent there, which leaves texture and level unchanged.
    pub(crate) fn set_motion(&mut self, motion: Motion) -> bool {
        let (speed_mm_s, force_n) = (motion.speed_mm_s, motion.force_n);
        let slides = slides(speed_mm_s, force_n);
        let felt = slides || !self.effects.contact;
        self.contact.set(if felt { 1.0 } else { 0.0 });
        if slides && self.effects.speed_scaling {
            self.ratio = self.explored.speed_ratio(speed_mm_s).min(self.fastest);
        }
        if felt && self.effects.force_scaling {
            self.gain = self.explored.force_gain(force_n);
        }
        felt
    }

    /// Returns the gain of the level.
    pub(crate) fn gain(&self) -> f64 {
        self.gain
    }

    /// Fades samples out while the finger does not slide.
    pub(crate) fn apply_contact(&mut self, block: &mut [f32]) {
        self.contact.apply(block);
    }

    /// Fills `out` with samples of the source, read at the speed of the motion.
    pub(crate) fn read(&mut self, out: &mut [f32], source: &mut dyn FnMut(&mut [f32])) {
        match &mut self.warp {
            // The ratio is exactly 1 at the motion for which the voice was made.
            Some(warp) => warp.process(self.ratio / self.base, out, source),
            None => source(out),
        }
    }

    /// Returns the highest reading speed, in the recorded speed.
    pub(crate) fn fastest(&self) -> f64 {
        self.fastest
    }

    /// Returns the effects that are on.
    pub(crate) fn effects(&self) -> Effects {
        self.effects
    }
}
