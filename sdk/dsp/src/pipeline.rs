//! Filter sections in series, side by side in vector registers.

use alloc::vec::Vec;

use crate::biquad::{Biquad, without_denormals};

/// Sections side by side, and where few are left.
const LANES: usize = 4;
const FEW: usize = 2;
/// Samples taken at once.
const PAIR: usize = 2;

/// Sections in series, as [`crate::biquad::Cascade`], but each works on the two samples that the one
/// before it finished last: all are computed at once, and the output comes later, by six samples for
/// every four sections. For streams where a delay of a few samples is nothing.
///
/// ```
/// use htex_dsp::{biquad::Biquad, pipeline::Pipeline};
/// let mut two = Pipeline::new(&[Biquad { b0: 0.5, ..Biquad::IDENTITY }; 2]);
/// let mut pairs = [[1.0; 2]; 5];
/// two.process(&mut pairs);
/// assert_eq!(pairs, [[0.0; 2], [0.25; 2], [0.25; 2], [0.25; 2], [0.25; 2]]);
/// ```
#[derive(Debug, Clone)]
pub struct Pipeline {
    rows: Vec<Row<LANES>>,
    last: Option<Row<FEW>>,
}

/// Sections side by side: transposed direct form II, written out for two samples, so that the new state
/// is a sum of what the inputs and what the old state leave, and these need not wait for each other.
#[derive(Debug, Clone, Copy)]
struct Row<const N: usize> {
    /// Product of all `b0`, by which the other numerators are divided.
    gain: f64,
    /// What the first and the second input leave in the two numbers of the state.
    first: [[f64; N]; 2],
    second: [[f64; N]; 2],
    /// What the first and the second number of the state leave in both, the second with its sign changed.
    kept: [[f64; N]; 2],
    crossed: [[f64; N]; 2],
    state: State<N>,
}

#[derive(Debug, Clone, Copy)]
struct State<const N: usize> {
    s1: [f64; N],
    s2: [f64; N],
    y: [[f64; N]; PAIR],
}

impl Pipeline {
    /// A pipeline of `sections`, whose `b0` are not 0, at rest. Rows are filled up with sections that pass
    /// their input.
    pub fn new(sections: &[Biquad]) -> Self {
        let (rows, last) = match sections.len() % LANES {
            few @ 1..=FEW => sections.split_at(sections.len() - few),
            _ => (sections, &[][..]),
        };
        Self {
            rows: rows.chunks(LANES).map(Row::new).collect(),
            last: (!last.is_empty()).then(|| Row::new(last)),
        }
    }

    /// Filters a block in place. Does not allocate.
    pub fn process(&mut self, pairs: &mut [[f64; PAIR]]) {
        for row in &mut self.rows {
            row.run(pairs);
        }
        if let Some(row) = &mut self.last {
            row.run(pairs);
        }
    }
}

impl<const N: usize> Row<N> {
    fn new(sections: &[Biquad]) -> Self {
        let lanes = |of: fn(&Biquad) -> f64| {
            core::array::from_fn(|i| of(sections.get(i).unwrap_or(&Biquad::IDENTITY)))
        };
        Self {
            gain: sections.iter().map(|s| s.b0).product(),
            first: [
                lanes(|s| s.b2 / s.b0 - s.a2 - s.a1 * (s.b1 / s.b0 - s.a1)),
                lanes(|s| -s.a2 * (s.b1 / s.b0 - s.a1)),
            ],
            second: [lanes(|s| s.b1 / s.b0 - s.a1), lanes(|s| s.b2 / s.b0 - s.a2)],
            kept: [lanes(|s| s.a1 * s.a1 - s.a2), lanes(|s| s.a1 * s.a2)],
            crossed: [lanes(|s| s.a1), lanes(|s| s.a2)],
            state: State {
                s1: [0.0; N],
                s2: [0.0; N],
                y: [[0.0; N]; PAIR],
            },
        }
    }

    fn run(&mut self, pairs: &mut [[f64; PAIR]]) {
        let mut state = self.state;
        for pair in pairs {
            *pair = self.tick(&mut state, *pair);
        }
        // What has died away is zero before it is so small that arithmetic gets slow.
        self.state = State {
            s1: state.s1.map(without_denormals),
            s2: state.s2.map(without_denormals),
            y: state.y.map(|y| y.map(without_denormals)),
        };
    }

    #[inline(always)]
    fn tick(&self, state: &mut State<N>, [first, second]: [f64; PAIR]) -> [f64; PAIR] {
        let x0 = behind(self.gain * first, &state.y[0]);
        let x1 = behind(self.gain * second, &state.y[1]);
        for i in 0..N {
            let (s1, s2) = (state.s1[i], state.s2[i]);
            state.y[0][i] = x0[i] + s1;
            let ahead = self.second[0][i] * x0[i];
            state.y[1][i] = (ahead + x1[i]) + (s2 - self.crossed[0][i] * s1);
            let left = |k: usize| self.first[k][i] * x0[i] + self.second[k][i] * x1[i];
            let kept = |k: usize| self.kept[k][i] * s1 - self.crossed[k][i] * s2;
            state.s1[i] = left(0) + kept(0);
            state.s2[i] = left(1) + kept(1);
        }
        state.y.map(|y| y[N - 1])
    }
}

/// What each section takes: the input, or what the one before it gave.
#[inline(always)]
fn behind<const N: usize>(input: f64, given: &[f64; N]) -> [f64; N] {
    core::array::from_fn(|i| if i == 0 { input } else { given[i - 1] })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::biquad::Cascade;
    use crate::butterworth::high_pass;
    use crate::noise::GaussianNoise;

    /// The same as sections one after the other, some samples late.
    #[test]
    fn a_pipeline_is_a_late_cascade() {
        for (order, late) in [(1, 2), (4, 2), (5, 6), (8, 6), (12, 8), (14, 12)] {
            let sections = high_pass(order, 17.5, 2_000.0).unwrap();
            let (mut pipeline, mut cascade) = (Pipeline::new(&sections), Cascade::new(&sections));
            let mut noise = GaussianNoise::new(1);
            let mut block: Vec<f64> = (0..3_000).map(|_| noise.next_sample().into()).collect();
            let expected: Vec<f64> = block.iter().map(|x| cascade.tick(*x)).collect();
            for pairs in block.as_chunks_mut().0.chunks_mut(33) {
                pipeline.process(pairs);
            }
            assert!(block[..late].iter().all(|y| *y == 0.0));
            for (y, x) in block[late..].iter().zip(expected) {
                assert!((y - x).abs() < 1e-9, "order {order}: {y} {x}");
            }
        }
    }
}
