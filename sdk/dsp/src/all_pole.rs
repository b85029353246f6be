//! The all-pole filter: quick while its coefficients stand still, stable while they change.

use crate::biquad::without_denormals;
use crate::lattice::AllPoleLattice;
use crate::linear_prediction::{step_down_in_place, step_up};
use crate::wide::{Work, wide};

/// Samples that are filtered together.
pub const GROUP: usize = 4;
/// As many samples as are filtered together.
pub type Group = [f64; GROUP];

/// Orders up to this have a direct form with all state in registers.
const MAX_DIRECT_ORDER: usize = 16;
/// Rounding of the direct form, relative to the output, is at most about 1e-16 times the sum of its
/// coefficients' sizes times the filter's gain for noise; up to this product samples of single
/// precision do not show it.
const MAX_DIRECT_ERROR: f64 = 1e7;

/// `H(z) = 1 / (1 - Σ A_i z⁻ⁱ)` with coefficients that can be moved (f64 state).
///
/// While they stand still the filter takes four samples at a time (transposed direct form II, its
/// recursion written out for four). While they move it is a lattice, which is stable for as long
/// as each reflection coefficient is. Nothing is heard of the change from one to the other: a
/// lattice whose coefficients have not moved for as many samples as it has stages holds nothing
/// but the outputs since.
///
/// ```
/// use htex_dsp::all_pole::AllPole;
/// let mut filter = AllPole::new(&[0.5]).ok_or("unstable")?;
/// let mut groups = [[1.0, 0.0, 0.0, 0.0]];
/// filter.process(&mut groups);
/// assert_eq!(groups, [[1.0, 0.5, 0.25, 0.125]]);
/// # Ok::<(), &str>(())
/// ```
#[derive(Debug, Clone)]
pub struct AllPole {
    lattice: AllPoleLattice,
    /// Samples until the lattice holds nothing but the last outputs.
    unsettled: usize,
    /// The last outputs, the newest last.
    past: [f64; MAX_DIRECT_ORDER],
    /// The direct form, while it is in charge.
    direct: Option<Direct>,
}

/// Four samples of the transposed direct form II: what each of the four inputs, with the state that
/// meets it, leaves in the outputs and in the state behind them.
#[derive(Debug, Clone, Copy)]
struct Direct {
    outputs: [Group; GROUP],
    states: [[f64; MAX_DIRECT_ORDER]; GROUP],
    state: [f64; MAX_DIRECT_ORDER],
}

/// A block while coefficients stand still, in `N` coefficients or fewer; the last outputs are kept.
struct Steady<'a, const N: usize>(
    &'a mut Direct,
    &'a mut [Group],
    &'a mut [f64; MAX_DIRECT_ORDER],
);

impl AllPole {
    /// A filter at rest; `None` if a pole lies on or outside the unit circle.
    pub fn new(coefficients: &[f64]) -> Option<Self> {
        let mut reflection = coefficients.to_vec();
        if !step_down_in_place(&mut reflection) {
            return None;
        }
        let mut filter = Self {
            lattice: AllPoleLattice::new(&reflection),
            unsettled: 0,
            past: [0.0; MAX_DIRECT_ORDER],
            direct: None,
        };
        filter.settle();
        Some(filter)
    }

    /// The order, fixed for the filter's life.
    pub fn order(&self) -> usize {
        self.lattice.order()
    }

    /// The reflection coefficients, to be moved between samples, inside (-1, 1). Does not allocate.
    pub fn reflection_mut(&mut self) -> &mut [f64] {
        if self.direct.take().is_some() {
            self.lattice.set_past(&self.past);
        }
        self.unsettled = self.order();
        self.lattice.reflection_mut()
    }

    /// Filters one sample as a lattice, while coefficients move.
    pub fn tick(&mut self, input: f64) -> f64 {
        if self.direct.is_some() {
            self.reflection_mut();
        }
        let y = self.lattice.tick(input);
        remember(&mut self.past, &[y]);
        y
    }

    /// Filters a block in place. Does not allocate.
    pub fn process(&mut self, groups: &mut [Group]) {
        let in_lattice = match (&self.direct, self.unsettled) {
            (Some(_), _) => 0,
            (None, 0) => groups.len(),
            (None, unsettled) => unsettled.div_ceil(GROUP).min(groups.len()),
        };
        let (moved, steady) = groups.split_at_mut(in_lattice);
        self.run_lattice(moved.as_flattened_mut());
        let Some(direct) = &mut self.direct else {
            return;
        };
        let past = &mut self.past;
        // State behind the order is zero: so a few lengths do.
        match self.lattice.order() {
            0..=2 => wide(Steady::<2>(direct, steady, past)),
            3..=4 => wide(Steady::<4>(direct, steady, past)),
            5..=6 => wide(Steady::<6>(direct, steady, past)),
            7..=8 => wide(Steady::<8>(direct, steady, past)),
            9..=12 => wide(Steady::<12>(direct, steady, past)),
            _ => wide(Steady::<MAX_DIRECT_ORDER>(direct, steady, past)),
        }
    }

    fn run_lattice(&mut self, block: &mut [f64]) {
        self.lattice.process(block);
        remember(&mut self.past, block);
        if self.unsettled > 0 {
            self.unsettled = self.unsettled.saturating_sub(block.len());
            if self.unsettled == 0 {
                self.settle();
            }
        }
    }

    /// Goes over to the direct form, if it may be used.
    fn settle(&mut self) {
        let order = self.order();
        if order > MAX_DIRECT_ORDER {
            return;
        }
        let mut a = [0.0; MAX_DIRECT_ORDER];
        for (m, &k) in self.lattice.reflection().iter().enumerate() {
            step_up(&mut a[..=m], k);
        }
        let sum: f64 = a.iter().map(|a| a.abs()).sum();
        let remaining = |k: &f64| (1.0 - k) * (1.0 + k);
        let power: f64 = self.lattice.reflection().iter().map(remaining).product();
        if sum <= MAX_DIRECT_ERROR * libm::sqrt(power) {
            self.direct = Some(Direct::new(&a, &self.past));
        }
    }
}

impl Direct {
    fn new(a: &[f64; MAX_DIRECT_ORDER], past: &[f64; MAX_DIRECT_ORDER]) -> Self {
        let mut direct = Self {
            outputs: [[0.0; GROUP]; GROUP],
            states: [[0.0; MAX_DIRECT_ORDER]; GROUP],
            state: [0.0; MAX_DIRECT_ORDER],
        };
        let effects = direct.outputs.iter_mut().zip(&mut direct.states);
        for (at, (outputs, state)) in effects.enumerate() {
            for (n, y) in outputs.iter_mut().enumerate() {
                *y = tick(a, state, f64::from(u8::from(n == at)));
            }
        }
        // All that the filter holds are its last outputs.
        for &y in past {
            // An input that makes the output just this.
            let input = y - direct.state[0];
            tick(a, &mut direct.state, input);
        }
        direct
    }
}

impl<const N: usize> Work for Steady<'_, N> {
    #[inline(always)]
    fn run(self) {
        let Self(direct, groups, past) = self;
        let states = direct.states.map(|state| first::<N>(&state));
        let outputs = direct.outputs;
        let mut state = first::<N>(&direct.state);
        for group in &mut *groups {
            let met: Group =
                core::array::from_fn(|i| group[i] + if i < N { state[i] } else { 0.0 });
            *group = sum(&outputs, &met);
            let left = sum(&states, &met);
            state = core::array::from_fn(|i| {
                left[i] + if i + GROUP < N { state[i + GROUP] } else { 0.0 }
            });
        }
        direct.state[..N].copy_from_slice(&state.map(without_denormals));
        remember(past, groups.as_flattened());
    }
}

/// What each number of `met` leaves, added up.
#[inline(always)]
fn sum<const N: usize>(left: &[[f64; N]; GROUP], met: &Group) -> [f64; N] {
    core::array::from_fn(|i| {
        (left[0][i] * met[0] + left[1][i] * met[1]) + (left[2][i] * met[2] + left[3][i] * met[3])
    })
}

#[inline(always)]
fn first<const N: usize>(of: &[f64; MAX_DIRECT_ORDER]) -> [f64; N] {
    core::array::from_fn(|i| of[i])
}

/// One sample: the output, and the state behind it.
fn tick(a: &[f64], state: &mut [f64], input: f64) -> f64 {
    let y = input + state[0];
    for i in 0..a.len() {
        state[i] = a[i] * y + state.get(i + 1).copied().unwrap_or(0.0);
    }
    y
}

/// Keeps the last of some more outputs.
fn remember(past: &mut [f64; MAX_DIRECT_ORDER], outputs: &[f64]) {
    let new = outputs.len().min(past.len());
    past.copy_within(new.., 0);
    let kept = past.len() - new;
    past[kept..].copy_from_slice(&outputs[outputs.len() - new..]);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::GaussianNoise;
    use alloc::vec::Vec;

    /// Standing still, moving, and standing still again: the same as a lattice all the time.
    #[test]
    fn moving_and_standing_still_are_one_filter() {
        for coefficients in [&[1.2, -0.8, 0.3, -0.1, 0.05, 0.02, -0.3][..], &[0.9]] {
            let mut filter = AllPole::new(coefficients).unwrap();
            let mut lattice = filter.lattice.clone();
            let mut noise = GaussianNoise::new(1);
            for n in 0..2_000 {
                let mut group: Group = [(); GROUP].map(|()| noise.next_sample().into());
                let expected = if n % 300 < 40 {
                    group.map(|x| {
                        let moved = |k: &f64| (k + 0.01 * libm::sin(n as f64)).clamp(-0.99, 0.99);
                        lattice
                            .reflection_mut()
                            .iter_mut()
                            .for_each(|k| *k = moved(k));
                        lattice.tick(x)
                    })
                } else {
                    group.map(|x| lattice.tick(x))
                };
                if n % 300 < 40 {
                    group = group.map(|x| {
                        let moved = |k: &f64| (k + 0.01 * libm::sin(n as f64)).clamp(-0.99, 0.99);
                        filter
                            .reflection_mut()
                            .iter_mut()
                            .for_each(|k| *k = moved(k));
                        filter.tick(x)
                    });
                } else {
                    filter.process(core::slice::from_mut(&mut group));
                    assert_eq!(
                        filter.direct.is_some(),
                        n % 300 >= 39 + coefficients.len().div_ceil(GROUP),
                        "{n}"
                    );
                }
                for (y, x) in group.iter().zip(expected) {
                    assert!((y - x).abs() < 1e-11, "{n}: {y} {x}");
                }
            }
        }
    }

    /// What is too long for the direct form, or would lose digits in it, stays a lattice.
    #[test]
    fn the_direct_form_is_left_where_it_would_not_do() {
        let coefficients_of = |poles: usize, radius: f64| {
            let mut polynomial = alloc::vec![1.0];
            for _ in 0..poles {
                polynomial.resize(polynomial.len() + 1, 0.0);
                for i in (1..polynomial.len()).rev() {
                    polynomial[i] -= radius * polynomial[i - 1];
                }
            }
            polynomial[1..].iter().map(|c| -c).collect::<Vec<f64>>()
        };
        for (poles, radius, direct) in [(12, 0.4, true), (12, 0.7, false), (17, 0.1, false)] {
            let mut filter = AllPole::new(&coefficients_of(poles, radius)).unwrap();
            assert_eq!(filter.direct.is_some(), direct, "{poles} poles at {radius}");
            let mut lattice = filter.lattice.clone();
            let mut noise = GaussianNoise::new(2);
            for _ in 0..100 {
                let mut group: Group = [(); GROUP].map(|()| noise.next_sample().into());
                let expected = group.map(|x| lattice.tick(x));
                filter.process(core::slice::from_mut(&mut group));
                for (y, x) in group.iter().zip(expected) {
                    assert!((y - x).abs() <= 1e-8 * x.abs().max(1.0), "{poles}: {y} {x}");
                }
            }
        }
    }
}
