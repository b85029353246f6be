//! A gain that changes without a click.

/// A gain that goes to each new target in a straight line of a fixed length.
#[derive(Debug, Clone)]
pub struct Glide {
    value: f32,
    target: f32,
    step: f32,
    len: u32,
    left: u32,
}

impl Glide {
    /// Stands at `value`; later changes take `len` samples (at least one).
    pub fn new(value: f32, len: u32) -> Self {
        Self {
            value,
            target: value,
            step: 0.0,
            len: len.max(1),
            left: 0,
        }
    }

    /// Whether the gain stands still at `value`.
    pub fn rests_at(&self, value: f32) -> bool {
        self.left == 0 && self.value == value
    }

    /// Begins to go to `target`; a target that is not new changes nothing.
    pub fn set(&mut self, target: f32) {
        self.set_within(target, self.len);
    }

    /// As [`Self::set`], in `len` samples (at least one) instead of the usual length.
    pub fn set_within(&mut self, target: f32, len: u32) {
        if target != self.target {
            self.target = target;
            self.left = len.max(1);
            self.step = (target - self.value) / self.left as f32;
        }
    }

    /// Goes one sample on, and answers the gain there.
    #[inline]
    pub fn advance(&mut self) -> f32 {
        if self.left > 0 {
            self.left -= 1;
            self.value = if self.left == 0 {
                self.target
            } else {
                self.value + self.step
            };
        }
        self.value
    }

    /// Multiplies the next samples; the first by the gain as it stands.
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
    fn it_goes_straight_lands_exactly_and_stays() {
        let mut glide = Glide::new(1.0, 4);
        glide.set(0.0);
        assert!(!glide.rests_at(1.0));
        let mut block = [1.0f32; 6];
        glide.apply(&mut block[..3]);
        glide.apply(&mut block[3..]);
        assert_eq!(block, [1.0, 0.75, 0.5, 0.25, 0.0, 0.0]);
        assert!(glide.rests_at(0.0) && !glide.rests_at(1.0));
        glide.set_within(2.0, 1);
        assert_eq!(glide.advance(), 2.0);
    }
}
