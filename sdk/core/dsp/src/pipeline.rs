//! Filter sections in series that run side by side in vector registers, as a pipeline.

use alloc::vec::Vec;

use crate::biquad::Biquad;
use crate::quad::{Quad, Real, VOICES, beside, part};
use crate::wide::{Work, wide};

/// Sections per row; the last row may be shorter.
const LANES: usize = 4;
const FEW: usize = 2;
/// Number of samples per step.
const PAIR: usize = 2;

/// Filter sections in series, like a [`crate::biquad::Cascade`], but pipelined: in each step, a
/// section processes the two samples that the section before it finished in the previous step. In
/// this way all sections compute at the same time. The output is delayed by six samples for every
/// four sections. Use a pipeline for streams in which a delay of a few samples does not matter.
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
    rows: Vec<Row<f64, LANES>>,
    last: Option<Row<f64, FEW>>,
}

/// Four pipelines with equally many rows of sections (a row is a group of two or four sections),
/// computed side by side. Each output is bit-identical to the output of the same pipeline run
/// alone.
#[derive(Debug)]
pub struct Pipelines<'a>([&'a mut Pipeline; VOICES]);

/// Sections side by side: transposed direct form II, unrolled for two samples. The new state is the
/// sum of contributions of the inputs and of the old state. These contributions can be computed
/// independently of each other.
#[derive(Debug, Clone, Copy)]
struct Row<T, const N: usize> {
    /// The product of the `b0` of all sections. The other numerator coefficients of each section
    /// are divided by the section's `b0`.
    gain: T,
    /// Contributions of the first and the second input to the two state variables.
    first: [[T; N]; 2],
    second: [[T; N]; 2],
    /// Contributions of the first and the second state variable to both new state variables. The
    /// sign of the second contribution is reversed.
    kept: [[T; N]; 2],
    crossed: [[T; N]; 2],
    state: State<T, N>,
}

#[derive(Debug, Clone, Copy)]
struct State<T, const N: usize> {
    s1: [T; N],
    s2: [T; N],
    y: [[T; N]; PAIR],
}

impl Pipeline {
    /// Makes a pipeline of `sections` with zero state. Every `b0` must be nonzero. Sections are
    /// computed in rows of four or two. An incomplete row is filled up with sections that pass
    /// their input unchanged.
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

impl<'a> Pipelines<'a> {
    /// Combines four pipelines. Returns `None` if their numbers of rows differ.
    pub fn new(pipelines: [&'a mut Pipeline; VOICES]) -> Option<Self> {
        let shape = |pipeline: &Pipeline| (pipeline.rows.len(), pipeline.last.is_some());
        let [first, others @ ..] = &pipelines;
        let alike = others.iter().all(|other| shape(other) == shape(first));
        alike.then_some(Self(pipelines))
    }

    /// Filters a block in place. Does not allocate.
    pub fn process(&mut self, pairs: &mut [[Quad; PAIR]]) {
        let [a, b, c, d] = self.0.each_mut();
        let rows = a.rows.iter_mut().zip(&mut b.rows);
        for ((a, b), (c, d)) in rows.zip(c.rows.iter_mut().zip(&mut d.rows)) {
            run_four([a, b, c, d], pairs);
        }
        if let (Some(a), Some(b), Some(c), Some(d)) =
            (&mut a.last, &mut b.last, &mut c.last, &mut d.last)
        {
            run_four([a, b, c, d], pairs);
        }
    }
}

/// Runs one row of each of four pipelines.
fn run_four<const N: usize>(mut rows: [&mut Row<f64, N>; VOICES], pairs: &mut [[Quad; PAIR]]) {
    let mut row = Row::NONE;
    wide(InterleaveRows(&mut row, rows.each_ref().map(|row| &**row)));
    wide(RunRows(&mut row, pairs));
    for (voice, own) in rows.iter_mut().enumerate() {
        own.state = row.state.part(voice);
    }
}

/// Interleaves four rows.
struct InterleaveRows<'a, const N: usize>(&'a mut Row<Quad, N>, [&'a Row<f64, N>; VOICES]);

impl<const N: usize> Work for InterleaveRows<'_, N> {
    #[inline(always)]
    fn run(self) {
        let Self(row, [a, b, c, d]) = self;
        row.gain = Quad([a.gain, b.gain, c.gain, d.gain]);
        for k in 0..2 {
            row.first[k] = beside([&a.first[k], &b.first[k], &c.first[k], &d.first[k]]);
            row.second[k] = beside([&a.second[k], &b.second[k], &c.second[k], &d.second[k]]);
            row.kept[k] = beside([&a.kept[k], &b.kept[k], &c.kept[k], &d.kept[k]]);
            row.crossed[k] = beside([&a.crossed[k], &b.crossed[k], &c.crossed[k], &d.crossed[k]]);
        }
        let (state, [a, b, c, d]) = (&mut row.state, [a, b, c, d].map(|row| &row.state));
        state.s1 = beside([&a.s1, &b.s1, &c.s1, &d.s1]);
        state.s2 = beside([&a.s2, &b.s2, &c.s2, &d.s2]);
        for k in 0..PAIR {
            state.y[k] = beside([&a.y[k], &b.y[k], &c.y[k], &d.y[k]]);
        }
    }
}

/// The filter loop for four pipelines. It is separate from the function that interleaves the rows,
/// because compilers would otherwise shuffle lanes inside the loop.
struct RunRows<'a, const N: usize>(&'a mut Row<Quad, N>, &'a mut [[Quad; PAIR]]);

impl<const N: usize> Work for RunRows<'_, N> {
    #[inline(always)]
    fn run(self) {
        self.0.run(self.1);
    }
}

impl<const N: usize> Row<f64, N> {
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
            state: State { s1: [0.0; N], s2: [0.0; N], y: [[0.0; N]; PAIR] },
        }
    }
}

impl<const N: usize> Row<Quad, N> {
    const NONE: Self = {
        let zeros = [Quad::ZERO; N];
        Self {
            gain: Quad::ZERO,
            first: [zeros; 2],
            second: [zeros; 2],
            kept: [zeros; 2],
            crossed: [zeros; 2],
            state: State { s1: zeros, s2: zeros, y: [zeros; PAIR] },
        }
    };
}

impl<const N: usize> State<Quad, N> {
    #[inline(always)]
    fn part(&self, voice: usize) -> State<f64, N> {
        State {
            s1: part(&self.s1, voice),
            s2: part(&self.s2, voice),
            y: [part(&self.y[0], voice), part(&self.y[1], voice)],
        }
    }
}

// These are loops and not closures, because closures would not be compiled for the wider registers.
impl<T: Real, const N: usize> Row<T, N> {
    #[inline(always)]
    fn run(&mut self, pairs: &mut [[T; PAIR]]) {
        let mut state = self.state;
        for pair in pairs {
            *pair = self.tick(&mut state, *pair);
        }
        // Small values become zero before they become denormal, which would slow down the
        // arithmetic.
        self.state = State {
            s1: state.s1.map(T::without_denormals),
            s2: state.s2.map(T::without_denormals),
            y: state.y.map(|y| y.map(T::without_denormals)),
        };
    }

    #[inline(always)]
    fn tick(&self, state: &mut State<T, N>, [first, second]: [T; PAIR]) -> [T; PAIR] {
        let x0 = behind(self.gain * first, &state.y[0]);
        let x1 = behind(self.gain * second, &state.y[1]);
        for i in 0..N {
            let (s1, s2) = (state.s1[i], state.s2[i]);
            state.y[0][i] = x0[i] + s1;
            let ahead = self.second[0][i] * x0[i];
            state.y[1][i] = (ahead + x1[i]) + (s2 - self.crossed[0][i] * s1);
            state.s1[i] = (self.first[0][i] * x0[i] + self.second[0][i] * x1[i])
                + (self.kept[0][i] * s1 - self.crossed[0][i] * s2);
            state.s2[i] = (self.first[1][i] * x0[i] + self.second[1][i] * x1[i])
                + (self.kept[1][i] * s1 - self.crossed[1][i] * s2);
        }
        [state.y[0][N - 1], state.y[1][N - 1]]
    }
}

/// Returns the inputs of all sections. The first section gets the input of the row, and each other
/// section gets the last output of the section before it.
#[inline(always)]
#[allow(clippy::manual_memcpy)] // A copied slice goes through memory, and takes a quarter longer.
fn behind<T: Copy, const N: usize>(input: T, given: &[T; N]) -> [T; N] {
    let mut taken = [input; N];
    for i in 1..N {
        taken[i] = given[i - 1];
    }
    taken
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::biquad::Cascade;
    use crate::butterworth::high_pass;
    use crate::noise::GaussianNoise;

    /// Equals sections that run one after the other, apart from the delay.
    #[test]
    fn a_pipeline_is_a_delayed_cascade() {
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

    /// Four pipelines side by side give the same bits as each on its own. Different numbers of rows
    /// are rejected.
    #[test]
    fn four_pipelines_are_bit_identical_to_single_ones() {
        for order in [2, 4, 6, 8, 12] {
            let edges = [10.0, 17.5, 20.0, 40.0];
            let mut alone = edges.map(|f| Pipeline::new(&high_pass(order, f, 2_000.0).unwrap()));
            let mut beside = alone.clone();
            let mut noise = GaussianNoise::new(4);
            for pairs in [1, 3, 40] {
                let mut next = || f64::from(noise.next_sample());
                let mut block: Vec<[Quad; PAIR]> = (0..pairs)
                    .map(|_| [(); PAIR].map(|()| Quad([(); VOICES].map(|()| next()))))
                    .collect();
                let expected = core::array::from_fn::<_, VOICES, _>(|voice| {
                    let own = |pair: &[Quad; PAIR]| pair.map(|x| x.0[voice]);
                    let mut own: Vec<[f64; PAIR]> = block.iter().map(own).collect();
                    alone[voice].process(&mut own);
                    own
                });
                let mut four = Pipelines::new(beside.each_mut()).unwrap();
                four.process(&mut block);
                for (voice, expected) in expected.iter().enumerate() {
                    let same = |(y, x): (&[Quad; PAIR], &[f64; PAIR])| y.map(|y| y.0[voice]) == *x;
                    assert!(block.iter().zip(expected).all(same), "{order} {voice}");
                }
            }
            beside[1] = Pipeline::new(&high_pass(order + 8, 20.0, 2_000.0).unwrap());
            assert!(Pipelines::new(beside.each_mut()).is_none());
        }
    }
}
