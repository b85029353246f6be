//! All-pole lattice filter. Unlike a direct form, it stays stable while its coefficients change, as
//! long as each reflection coefficient is inside (-1, 1).
//!
//! A WASM module checks its time limit at the start of every iteration of a loop. At each check,
//! the values that one iteration passes to the next are stored in memory and loaded again. To avoid
//! these memory accesses, the crate contains the code of the lattice for a few fixed lengths. This
//! code has no inner loop over the stages, so all state stays in registers. [`crate::biquad`] and
//! [`crate::sine_bank`] are unrolled for the same reason.

use alloc::vec::Vec;

use crate::biquad::without_denormals;

/// The filter `H(z) = 1 / (1 - Σ A_i z⁻ⁱ)`, given by reflection coefficients (two-multiplier
/// lattice, f64 state).
///
/// ```
/// use htex_dsp::lattice::AllPoleLattice;
/// let mut filter = AllPoleLattice::new(&[0.5]);
/// assert_eq!([1.0, 0.0, 0.0].map(|x| filter.tick(x)), [1.0, 0.5, 0.25]);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct AllPoleLattice {
    reflection: Vec<f64>,
    /// Backward errors of the stages 0, 1, ... at the previous sample.
    delayed: Vec<f64>,
}

impl AllPoleLattice {
    /// Makes a filter with zero state. The filter is stable if all reflection coefficients are
    /// inside (-1, 1).
    pub fn new(reflection: &[f64]) -> Self {
        Self { reflection: reflection.to_vec(), delayed: alloc::vec![0.0; reflection.len()] }
    }

    /// Raises the filter's order to at least `order`. The new coefficients are 0, so the filter
    /// stays the same. Does not allocate after [`Self::reserve`] with this order.
    pub fn raise_order(&mut self, order: usize) {
        let order = order.max(self.order());
        self.reflection.resize(order, 0.0);
        self.delayed.resize(order, 0.0);
    }

    /// Reserves memory for filters up to this order.
    pub fn reserve(&mut self, max_order: usize) {
        let more = max_order.saturating_sub(self.order());
        self.reflection.reserve_exact(more);
        self.delayed.reserve_exact(more);
    }

    pub fn order(&self) -> usize {
        self.reflection.len()
    }

    /// The reflection coefficients.
    pub fn reflection(&self) -> &[f64] {
        &self.reflection
    }

    /// Returns the reflection coefficients. The caller may change the coefficients between samples;
    /// this does not change the state.
    pub fn reflection_mut(&mut self) -> &mut [f64] {
        &mut self.reflection
    }

    /// Filters one sample.
    pub fn tick(&mut self, input: f64) -> f64 {
        let mut block = [input];
        self.process(&mut block);
        block[0]
    }

    /// Filters a block in place.
    pub fn process(&mut self, block: &mut [f64]) {
        // Additional stages with zero coefficients change nothing. Therefore, a few fixed lengths,
        // with all state in registers, are enough for all orders up to 16.
        match self.order() {
            0..=2 => self.run::<2>(block),
            3..=4 => self.run::<4>(block),
            5..=6 => self.run::<6>(block),
            7..=8 => self.run::<8>(block),
            9..=12 => self.run::<12>(block),
            13..=16 => self.run::<16>(block),
            _ => self.run_any(block),
        }
    }

    /// Filters a block as [`Self::run_any`] does, but only for an order of at most `N`.
    fn run<const N: usize>(&mut self, block: &mut [f64]) {
        let order = self.order();
        let (mut k, mut delayed) = ([0.0; N], [0.0; N]);
        k[..order].copy_from_slice(&self.reflection);
        delayed[..order].copy_from_slice(&self.delayed);
        for sample in block {
            *sample = stages(*sample, &k, &mut delayed);
        }
        self.keep(&delayed);
    }

    fn run_any(&mut self, block: &mut [f64]) {
        for sample in block {
            *sample = stages(*sample, &self.reflection, &mut self.delayed);
        }
        self.delayed.iter_mut().for_each(|x| *x = without_denormals(*x));
    }

    /// Stores the state after a block. Small values become zero before they become denormal, which
    /// would slow down the arithmetic.
    fn keep(&mut self, delayed: &[f64]) {
        for (kept, x) in self.delayed.iter_mut().zip(delayed) {
            *kept = without_denormals(*x);
        }
    }

    /// Sets the state that a filter with these coefficients has after the outputs `past`. The
    /// newest output is at the end. `past` has at least as many elements as the order.
    pub(crate) fn set_past(&mut self, past: &[f64]) {
        self.reset();
        for &y in past {
            // This is the inverse filter, from outputs to inputs. With constant coefficients it
            // gives the same backward errors as the filter, and these errors are the state.
            let mut forward = y;
            let mut backward = y;
            for (k, delayed) in self.reflection.iter().zip(&mut self.delayed) {
                let before = core::mem::replace(delayed, backward);
                backward = before - k * forward;
                forward -= k * before;
            }
        }
    }

    /// Sets the state to zero.
    pub fn reset(&mut self) {
        self.delayed.fill(0.0);
    }
}

/// Filters one sample by all stages, from the last to the first.
#[inline(always)]
fn stages(input: f64, k: &[f64], delayed: &mut [f64]) -> f64 {
    let mut forward = input;
    for stage in (0..k.len()).rev() {
        let before = delayed[stage];
        forward += k[stage] * before;
        // No stage uses the backward error of the last one.
        if stage + 1 < k.len() {
            delayed[stage + 1] = before - k[stage] * forward;
        }
    }
    if let Some(first) = delayed.first_mut() {
        *first = forward;
    }
    forward
}
