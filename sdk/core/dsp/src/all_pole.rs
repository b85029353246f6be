//! All-pole filter that runs as a direct form while its coefficients are constant, and as a lattice
//! while they change. The direct form is fast; the lattice stays stable.
//!
//! The direct form computes four samples at a time. The lattice and the direct form give the same
//! output, up to rounding, once the coefficients have been constant for as many samples as the
//! lattice has stages. The lattice moves from one filter to another by interpolating their line
//! spectral frequencies. This keeps every filter in between stable.

pub use crate::direct_form::GROUP;
use crate::direct_form::{Direct, MAX_ORDER as MAX_DIRECT_ORDER};
use crate::lattice::AllPoleLattice;
use crate::linear_prediction::{step_down_in_place, step_up};
use crate::quad::{Quad, VOICES};

/// [`GROUP`] samples that are filtered together.
pub type Group = [f64; GROUP];

/// Limit for the use of the direct form: the largest product of the sum of the absolute
/// coefficients and the filter's gain for noise. The rounding error of the direct form, relative to
/// the output, is at most about 1e-16 times this product. Up to this limit, the error is below the
/// resolution of single-precision samples.
const MAX_DIRECT_ERROR: f64 = 1e7;

/// The all-pole filter `H(z) = 1 / (1 - Σ A_i z⁻ⁱ)`, whose coefficients can change while it runs
/// (f64 state).
///
/// While the coefficients are constant, the filter computes four samples at a time (transposed
/// direct form II, the recursion unrolled for four samples). While the coefficients change, the
/// filter runs as a lattice, which is stable if each reflection coefficient is inside (-1, 1). The
/// switch from the lattice to the direct form is inaudible. The filter switches only after the
/// coefficients have been constant for at least as many samples as the lattice has stages. After
/// this time, the state of the lattice depends only on its last outputs, from which the direct form
/// can continue.
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
    /// Number of samples until the state of the lattice depends only on the last outputs.
    unsettled: usize,
    /// The last outputs, the newest at the end.
    past: [f64; MAX_DIRECT_ORDER],
    /// The direct form, while it is in use.
    direct: Option<Direct>,
}

/// Four all-pole filters with constant coefficients, computed side by side. Each output is
/// bit-identical to the output of the same filter run alone.
#[derive(Debug)]
pub struct AllPoles<'a>([&'a mut AllPole; VOICES]);

impl AllPole {
    /// Returns a filter with zero state, or `None` if a pole lies on or outside the unit circle.
    /// [`Self::raise_order`] can raise the order up to `max_order` without an allocation.
    pub fn with_max_order(coefficients: &[f64], max_order: usize) -> Option<Self> {
        let mut filter = Self::new(coefficients)?;
        filter.lattice.reserve(max_order);
        Some(filter)
    }

    /// Returns a filter with zero state, or `None` if a pole lies on or outside the unit circle.
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
        // At rest the state of both forms is zero, so the direct form can start at once.
        filter.settle();
        Some(filter)
    }

    /// Raises the filter's order to at least `order`. The new reflection coefficients are 0.
    pub fn raise_order(&mut self, order: usize) {
        if order > self.order() {
            // First get the state of the lattice at the present order.
            self.reflection_mut();
            self.lattice.raise_order(order);
            // The new stages hold zeros. After `order` samples, they hold the same values as if
            // they had been there from the start.
            self.unsettled = order;
        }
    }

    pub fn order(&self) -> usize {
        self.lattice.order()
    }

    /// Returns the reflection coefficients. The caller may change the coefficients between samples;
    /// each coefficient must stay inside (-1, 1). Does not allocate.
    pub fn reflection_mut(&mut self) -> &mut [f64] {
        if self.direct.take().is_some() {
            self.lattice.set_past(&self.past);
        }
        self.unsettled = self.order();
        self.lattice.reflection_mut()
    }

    /// Filters one sample as a lattice. Use this function while coefficients change.
    pub fn tick(&mut self, input: f64) -> f64 {
        if self.direct.is_some() {
            self.reflection_mut();
        }
        // `unsettled` is not counted down here, because the coefficients usually change again
        // before the next sample.
        let y = self.lattice.tick(input);
        remember(&mut self.past, &[y]);
        y
    }

    /// Filters a block in place. Does not allocate.
    pub fn process(&mut self, groups: &mut [Group]) {
        let in_lattice = match (&self.direct, self.unsettled) {
            (Some(_), _) => 0,
            (None, 0) => groups.len(),
            // The number is rounded up to whole groups, because the direct form takes only whole
            // groups. So the switch does not depend on the block length.
            (None, unsettled) => unsettled.div_ceil(GROUP).min(groups.len()),
        };
        let (moved, steady) = groups.split_at_mut(in_lattice);
        self.run_lattice(moved.as_flattened_mut());
        if let Some(direct) = &mut self.direct {
            direct.process(self.lattice.order(), steady);
            remember(&mut self.past, steady.as_flattened());
        } else {
            // The filter has settled, but the direct form would be too inaccurate for its
            // coefficients.
            self.run_lattice(steady.as_flattened_mut());
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

    /// Switches to the direct form, if its rounding error is small enough.
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
        // Not `1 - k * k`, which would cancel for |k| near 1.
        let remaining = |k: &f64| (1.0 - k) * (1.0 + k);
        let power: f64 = self.lattice.reflection().iter().map(remaining).product();
        // The gain for noise is `1 / sqrt(power)`. If the numbers are NaN, the filter stays a
        // lattice.
        if sum <= MAX_DIRECT_ERROR * crate::root::sqrt(power) {
            self.direct = Some(Direct::new(&a, &self.past));
        }
    }
}

impl<'a> AllPoles<'a> {
    /// Combines four filters. Returns `None` if one of the filters still runs as a lattice because
    /// its coefficients changed.
    pub fn new(filters: [&'a mut AllPole; VOICES]) -> Option<Self> {
        let direct = filters.iter().all(|filter| filter.direct.is_some());
        direct.then_some(Self(filters))
    }

    /// Filters a block in place. Does not allocate.
    pub fn process(&mut self, groups: &mut [[Quad; GROUP]]) {
        // The tables have zeros beyond a filter's own order, so the largest order serves all four.
        let order = self.0.iter().map(|filter| filter.order()).max();
        let forms = self.0.each_mut().map(|filter| filter.direct.as_mut());
        if let [Some(a), Some(b), Some(c), Some(d)] = forms {
            Direct::process_four([a, b, c, d], order.unwrap_or_default(), groups);
        }
        let outputs = groups.as_flattened();
        let new = outputs.len().min(MAX_DIRECT_ORDER);
        let outputs = &outputs[outputs.len() - new..];
        for (voice, filter) in self.0.iter_mut().enumerate() {
            filter.past.copy_within(new.., 0);
            let past = filter.past[MAX_DIRECT_ORDER - new..].iter_mut();
            past.zip(outputs).for_each(|(y, x)| *y = x.0[voice]);
        }
    }
}

/// Appends outputs to `past` and drops the oldest ones.
fn remember(past: &mut [f64; MAX_DIRECT_ORDER], outputs: &[f64]) {
    if let Some(last) = outputs.last_chunk() {
        *past = *last;
        return;
    }
    past.copy_within(outputs.len().., 0);
    past[MAX_DIRECT_ORDER - outputs.len()..].copy_from_slice(outputs);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::GaussianNoise;
    use alloc::vec::Vec;

    /// Alternates constant and changing coefficients. The output always equals a lattice's output.
    #[test]
    fn switching_forms_matches_the_lattice() {
        for coefficients in [&[1.2, -0.8, 0.3, -0.1, 0.05, 0.02, -0.3][..], &[0.9]] {
            let mut filter = AllPole::new(coefficients).unwrap();
            let mut lattice = filter.lattice.clone();
            let mut noise = GaussianNoise::new(1);
            for n in 0..2_000 {
                let mut group: Group = [(); GROUP].map(|()| noise.next_sample().into());
                let expected = if n % 300 < 40 {
                    group.map(|x| {
                        let moved = |k: &f64| (k + 0.01 * libm::sin(n as f64)).clamp(-0.99, 0.99);
                        lattice.reflection_mut().iter_mut().for_each(|k| *k = moved(k));
                        lattice.tick(x)
                    })
                } else {
                    group.map(|x| lattice.tick(x))
                };
                if n % 300 < 40 {
                    group = group.map(|x| {
                        let moved = |k: &f64| (k + 0.01 * libm::sin(n as f64)).clamp(-0.99, 0.99);
                        filter.reflection_mut().iter_mut().for_each(|k| *k = moved(k));
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

    /// A filter of a raised order equals a lattice that had this order from the start.
    #[test]
    fn a_raised_order_changes_nothing() {
        for (low, high) in [(1, 4), (3, 16), (8, 40), (20, 64)] {
            let coefficients: Vec<f64> = (0..low).map(|i| 0.5 / (i + low) as f64).collect();
            let mut filter = AllPole::with_max_order(&coefficients, 64).unwrap();
            let mut padded = coefficients.clone();
            assert!(step_down_in_place(&mut padded));
            padded.resize(high, 0.0);
            let mut lattice = AllPoleLattice::new(&padded);
            let mut noise = GaussianNoise::new(4);
            for n in 0..200 {
                if n == 50 {
                    filter.raise_order(high);
                }
                if n >= 70 {
                    for all in [filter.reflection_mut(), lattice.reflection_mut()] {
                        all[high - 1] = 0.3;
                    }
                }
                let mut group: Group = [(); GROUP].map(|()| noise.next_sample().into());
                let expected = group.map(|x| lattice.tick(x));
                filter.process(core::slice::from_mut(&mut group));
                for (y, x) in group.iter().zip(expected) {
                    assert!((y - x).abs() < 1e-11, "{low} to {high}, {n}: {y} {x}");
                }
            }
        }
    }

    /// A filter stays a lattice if its order or its rounding error is too large for the direct
    /// form.
    #[test]
    fn the_direct_form_is_used_only_where_it_is_accurate() {
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

    /// Blocks of any length give the same bits as single groups, even if a filter stays a lattice
    /// and settles within a block.
    #[test]
    fn blocks_of_any_length_are_single_groups() {
        for order in [1, 7, 16, 17, 40] {
            let coefficients: Vec<f64> = (0..order).map(|i| 0.5 / (i + order) as f64).collect();
            let mut single = AllPole::new(&coefficients).unwrap();
            let mut whole = single.clone();
            let mut noise = GaussianNoise::new(5);
            for groups in [3, 32, 5, 32] {
                for filter in [&mut single, &mut whole] {
                    filter.reflection_mut()[0] *= 0.9;
                }
                let mut next = || f64::from(noise.next_sample());
                let mut block: Vec<Group> =
                    (0..groups).map(|_| [(); GROUP].map(|()| next())).collect();
                let mut expected = block.clone();
                for group in &mut expected {
                    single.process(core::slice::from_mut(group));
                }
                whole.process(&mut block);
                assert_eq!(block, expected, "order {order}, {groups} groups");
            }
        }
    }

    /// Four filters side by side give the same bits as each on its own, for all block lengths. A
    /// lattice is rejected.
    #[test]
    fn four_filters_are_bit_identical_to_single_ones() {
        let order = |n: usize| -> Vec<f64> { (0..n).map(|i| 0.5 / (i + n) as f64).collect() };
        for orders in [[1, 2, 2, 1], [4, 3, 1, 2], [6; 4], [7, 1, 8, 2], [12, 9, 3, 4], [16; 4]] {
            let mut alone = orders.map(|n| AllPole::new(&order(n)).unwrap());
            let mut beside = alone.clone();
            let mut noise = GaussianNoise::new(3);
            for groups in [1, 2, 7, 30] {
                let mut next = || f64::from(noise.next_sample());
                let mut block: Vec<[Quad; GROUP]> = (0..groups)
                    .map(|_| [(); GROUP].map(|()| Quad([(); VOICES].map(|()| next()))))
                    .collect();
                let expected = core::array::from_fn::<_, VOICES, _>(|voice| {
                    let own = |group: &[Quad; GROUP]| group.map(|x| x.0[voice]);
                    let mut own: Vec<Group> = block.iter().map(own).collect();
                    alone[voice].process(&mut own);
                    own
                });
                let mut four = AllPoles::new(beside.each_mut()).unwrap();
                four.process(&mut block);
                for (voice, expected) in expected.iter().enumerate() {
                    let same = |(y, x): (&[Quad; GROUP], &Group)| y.map(|y| y.0[voice]) == *x;
                    assert!(block.iter().zip(expected).all(same), "{orders:?} {voice}");
                }
                // Compares the past outputs, from which a lattice would continue.
                for (own, alone) in beside.iter().zip(&alone) {
                    assert_eq!(own.past, alone.past);
                }
            }
            beside[2].reflection_mut();
            assert!(AllPoles::new(beside.each_mut()).is_none());
        }
    }
}
