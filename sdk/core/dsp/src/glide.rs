//! A gain that changes linearly over some samples, so that a change is not audible as a click.

/// A gain that moves to each new target along a straight line of fixed duration.
///
/// ```
/// use htex_dsp::glide::Glide;
/// let mut gain = Glide::new(0.0, 4);
/// gain.set(1.0);
/// assert_eq!([(); 5].map(|()| gain.advance()), [0.25, 0.5, 0.75, 1.0, 1.0]);
/// ```
#[derive(Debug, Clone)]
pub struct Glide {
    value: f32,
    target: f32,
    step: f32,
    len: u32,
    left: u32,
}

impl Glide {
    /// Makes a constant gain of `value`. Later changes take `len` samples (at least one).
    pub fn new(value: f32, len: u32) -> Self {
        Self { value, target: value, step: 0.0, len: len.max(1), left: 0 }
    }

    /// Sets the gain to `value` at once, without a ramp.
    pub fn restart(&mut self, value: f32) {
        (self.value, self.target, self.left) = (value, value, 0);
    }

    /// Returns whether the gain is `value` and is not changing.
    pub fn rests_at(&self, value: f32) -> bool {
        self.left == 0 && self.value == value
    }

    /// Ends a change at once: sets the gain to its target.
    pub fn finish(&mut self) {
        self.restart(self.target);
    }

    /// Returns the number of samples after which the gain has reached 0, or `None` if its target is
    /// not 0.
    pub fn until_zero(&self) -> Option<u32> {
        (self.target == 0.0 && (self.left > 0 || self.value == 0.0)).then_some(self.left)
    }

    /// Number of samples that a change takes.
    pub fn ramp(&self) -> u32 {
        self.len
    }

    /// Starts a change to `target`. Has no effect if the gain already has the target `target`.
    pub fn set(&mut self, target: f32) {
        self.set_within(target, self.len);
    }

    /// Starts a change to `target` that takes `len` samples (at least one). Otherwise works as
    /// [`Self::set`].
    pub fn set_within(&mut self, target: f32, len: u32) {
        // A host may set the same target with every block. If each call restarted the ramp, it
        // would never end.
        if target != self.target {
            self.target = target;
            self.left = len.max(1);
            self.step = (target - self.value) / self.left as f32;
        }
    }

    /// Advances by one sample and returns the new gain.
    #[inline]
    pub fn advance(&mut self) -> f32 {
        if self.left > 0 {
            self.left -= 1;
            // The steps have rounding errors, so the last one is replaced by the target itself.
            self.value = if self.left == 0 { self.target } else { self.value + self.step };
        }
        self.value
    }

    /// Multiplies `block` by the gain. The first sample is multiplied by the current gain.
    pub fn apply(&mut self, block: &mut [f32]) {
        let moving = block.len().min(self.left as usize);
        let (moving, steady) = block.split_at_mut(moving);
        for sample in moving {
            *sample *= self.value;
            self.advance();
        }
        let gain = self.value;
        if gain != 1.0 {
            steady.iter_mut().for_each(|sample| *sample *= gain);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_gain_is_linear_and_ends_exactly_at_the_target() {
        let mut glide = Glide::new(1.0, 4);
        glide.set(0.0);
        assert!(!glide.rests_at(1.0));
        assert_eq!(glide.until_zero(), Some(4));
        let mut block = [1.0f32; 6];
        glide.apply(&mut block[..3]);
        glide.apply(&mut block[3..]);
        assert_eq!(block, [1.0, 0.75, 0.5, 0.25, 0.0, 0.0]);
        assert!(glide.rests_at(0.0) && !glide.rests_at(1.0));
        assert_eq!(glide.until_zero(), Some(0));
        glide.set_within(2.0, 1);
        assert_eq!(glide.until_zero(), None);
        assert_eq!(glide.advance(), 2.0);
    }
}
