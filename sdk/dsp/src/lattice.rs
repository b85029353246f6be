//! The all-pole filter as a lattice: stable for as long as each reflection coefficient is, even
//! while they change, which a direct form is not.

use alloc::vec::Vec;

use crate::biquad::without_denormals;

/// `H(z) = 1 / (1 - Σ A_i z⁻ⁱ)` in reflection coefficients (two-multiplier lattice, f64 state).
///
/// ```
/// use htex_dsp::lattice::AllPoleLattice;
/// let mut filter = AllPoleLattice::new(&[0.5]);
/// assert_eq!([1.0, 0.0, 0.0].map(|x| filter.tick(x)), [1.0, 0.5, 0.25]);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct AllPoleLattice {
    reflection: Vec<f64>,
    /// Backward errors of stage 0, 1, ..., one sample ago.
    delayed: Vec<f64>,
}

impl AllPoleLattice {
    /// A filter at rest. Coefficients inside (-1, 1) make it stable.
    pub fn new(reflection: &[f64]) -> Self {
        Self {
            reflection: reflection.to_vec(),
            delayed: alloc::vec![0.0; reflection.len()],
        }
    }

    /// The order, fixed for the filter's life.
    pub fn order(&self) -> usize {
        self.reflection.len()
    }

    /// The coefficients, to be changed in place between samples; the state stays.
    pub fn reflection_mut(&mut self) -> &mut [f64] {
        &mut self.reflection
    }

    /// Filters one sample.
    #[inline]
    pub fn tick(&mut self, input: f64) -> f64 {
        let mut forward = input;
        for stage in (0..self.reflection.len()).rev() {
            let (k, delayed) = (self.reflection[stage], self.delayed[stage]);
            forward += k * delayed;
            if let Some(above) = self.delayed.get_mut(stage + 1) {
                *above = without_denormals(delayed - k * forward);
            }
        }
        if let Some(first) = self.delayed.first_mut() {
            *first = without_denormals(forward);
        }
        forward
    }

    /// Filters a block in place.
    pub fn process(&mut self, block: &mut [f64]) {
        for sample in block {
            *sample = self.tick(*sample);
        }
    }

    /// Puts the filter at rest.
    pub fn reset(&mut self) {
        self.delayed.fill(0.0);
    }
}
