//! What a voice does with a motion beside retuning its source: reading faster, a gain, silence.

use htex_dsp::glide::Glide;
use htex_dsp::warp::Warp;

use crate::Motion;
use crate::exploration::{CONTACT_RAMP_S, Effects, Explored, slides};

/// Follows a finger.
#[derive(Debug)]
pub(crate) struct Follow {
    explored: Explored,
    effects: Effects,
    /// How many times as fast as recorded the incoming samples are.
    base: f64,
    /// Fastest reading at which nothing comes to lie above half the rate.
    fastest: f64,
    /// How many times as fast as recorded the texture is to be read.
    ratio: f64,
    gain: f64,
    /// Where there is one speed to read in proportion to.
    warp: Option<Warp>,
    contact: Glide,
}

impl Follow {
    /// For a voice of `rate_hz` that starts with a motion, else as recorded. Its samples come in read `base` times as fast
    /// as recorded, and can be read `highest` times as fast until they reach half the rate.
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

    /// Follows to a motion; false where there is nothing to feel, and texture and level stay as they are.
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

    /// Gain on the level.
    pub(crate) fn gain(&self) -> f64 {
        self.gain
    }

    /// Silences samples where the finger does not slide.
    pub(crate) fn apply_contact(&mut self, block: &mut [f32]) {
        self.contact.apply(block);
    }

    /// Fills `out` with samples read as fast as the finger moves.
    pub(crate) fn read(&mut self, out: &mut [f32], source: &mut dyn FnMut(&mut [f32])) {
        match &mut self.warp {
            // Exactly 1 as long as the motion is the one the voice was made for.
            Some(warp) => warp.process(self.ratio / self.base, out, source),
            None => source(out),
        }
    }

    /// Fastest reading, in the recorded speed.
    pub(crate) fn fastest(&self) -> f64 {
        self.fastest
    }

    /// What it does.
    pub(crate) fn effects(&self) -> Effects {
        self.effects
    }
}
