//! Filter sections in series, side by side in vector registers.

use alloc::vec::Vec;

use crate::biquad::{Biquad, without_denormals};

const LANES: usize = 4;
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
/// assert_eq!(pairs, [[0.0; 2], [0.0; 2], [0.0; 2], [0.25; 2], [0.25; 2]]);
/// ```
#[derive(Debug, Clone)]
pub struct Pipeline {
    quads: Vec<Quad>,
}

/// Four sections (transposed direct form II, its recursion written out for two samples).
#[derive(Debug, Clone, Copy)]
struct Quad {
    /// Product of all `b0`, by which the other numerators are divided.
    gain: f64,
    b1: Lanes,
    b2: Lanes,
    a1: Lanes,
    a2: Lanes,
    /// `a1² - a2` and `a1 a2`.
    a11: Lanes,
    a12: Lanes,
    state: State,
}

#[derive(Debug, Clone, Copy)]
struct State {
    s1: Lanes,
    s2: Lanes,
    y: [Lanes; PAIR],
}

type Lanes = [f64; LANES];

impl Pipeline {
    /// A pipeline of `sections`, whose `b0` are not 0, at rest. What four do not divide is filled up with sections that
    /// pass their input.
    pub fn new(sections: &[Biquad]) -> Self {
        Self {
            quads: sections.chunks(LANES).map(Quad::new).collect(),
        }
    }

    /// Filters a block in place. Does not allocate.
    pub fn process(&mut self, pairs: &mut [[f64; PAIR]]) {
        for quad in &mut self.quads {
            quad.run(pairs);
        }
    }
}

impl Quad {
    fn new(sections: &[Biquad]) -> Self {
        let lanes = |of: fn(&Biquad) -> f64| {
            core::array::from_fn(|i| of(sections.get(i).unwrap_or(&Biquad::IDENTITY)))
        };
        Self {
            gain: sections.iter().map(|s| s.b0).product(),
            b1: lanes(|s| s.b1 / s.b0),
            b2: lanes(|s| s.b2 / s.b0),
            a1: lanes(|s| s.a1),
            a2: lanes(|s| s.a2),
            a11: lanes(|s| s.a1 * s.a1 - s.a2),
            a12: lanes(|s| s.a1 * s.a2),
            state: State {
                s1: [0.0; LANES],
                s2: [0.0; LANES],
                y: [[0.0; LANES]; PAIR],
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
    fn tick(&self, state: &mut State, [first, second]: [f64; PAIR]) -> [f64; PAIR] {
        let [[a, b, c, _], [d, e, f, _]] = state.y;
        let (x0, x1) = ([self.gain * first, a, b, c], [self.gain * second, d, e, f]);
        for i in 0..LANES {
            // What the second output is without the first one's feedback.
            let v0 = x0[i] + state.s1[i];
            let v1 = (self.b1[i] * x0[i] + x1[i]) + state.s2[i];
            let (n1, n2) = (self.b2[i] * x0[i] + self.b1[i] * x1[i], self.b2[i] * x1[i]);
            state.y[0][i] = v0;
            state.y[1][i] = v1 - self.a1[i] * v0;
            state.s1[i] = (n1 - self.a1[i] * v1) + self.a11[i] * v0;
            state.s2[i] = (n2 - self.a2[i] * v1) + self.a12[i] * v0;
        }
        [state.y[0][LANES - 1], state.y[1][LANES - 1]]
    }
}
