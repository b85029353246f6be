//! Direct form of an all-pole filter, four samples at a time, for one voice or for four voices.

use crate::biquad::without_denormals;
use crate::quad::{Quad, Real, VOICES, beside, part};
use crate::wide::{Work, wide};

/// Number of samples that are filtered together.
pub const GROUP: usize = 4;

/// Highest order for which the direct form keeps all state in registers.
pub(crate) const MAX_ORDER: usize = 16;

/// Transposed direct form II, unrolled for four samples. Each of the four inputs is first added to
/// an element of the state. The tables contain the contributions of these sums to the four outputs
/// and to the next state. Entries beyond the order are zero.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Direct {
    outputs: [[f64; GROUP]; GROUP],
    states: [[f64; MAX_ORDER]; GROUP],
    state: [f64; MAX_ORDER],
}

impl Direct {
    /// Makes the direct form from the coefficients and the last outputs; the newest output is at
    /// the end.
    pub(crate) fn new(a: &[f64; MAX_ORDER], past: &[f64; MAX_ORDER]) -> Self {
        let mut direct = Self {
            outputs: [[0.0; GROUP]; GROUP],
            states: [[0.0; MAX_ORDER]; GROUP],
            state: [0.0; MAX_ORDER],
        };
        let effects = direct.outputs.iter_mut().zip(&mut direct.states);
        for (at, (outputs, state)) in effects.enumerate() {
            for (n, y) in outputs.iter_mut().enumerate() {
                *y = tick(a, state, f64::from(u8::from(n == at)));
            }
        }
        // The last outputs determine the state of the filter.
        for &y in past {
            // This input gives the output `y`.
            let input = y - direct.state[0];
            tick(a, &mut direct.state, input);
        }
        direct
    }

    /// Filters a block in place. `order` is at least the order of the filter.
    pub(crate) fn process(&mut self, order: usize, groups: &mut [[f64; GROUP]]) {
        match order {
            0..=2 => wide(RunVoice::<2>(self, groups)),
            3..=4 => wide(RunVoice::<4>(self, groups)),
            // Not 6: this would be one and a half vectors, for which compilers make a loop that
            // shuffles lanes. A voice would then take a quarter longer.
            5..=8 => wide(RunVoice::<8>(self, groups)),
            9..=12 => wide(RunVoice::<12>(self, groups)),
            _ => wide(RunVoice::<MAX_ORDER>(self, groups)),
        }
    }

    /// Filters one block of each of four voices in place, side by side. Otherwise the same as
    /// [`Self::process`].
    pub(crate) fn process_four(
        four: [&mut Self; VOICES],
        order: usize,
        groups: &mut [[Quad; GROUP]],
    ) {
        match order {
            0..=2 => run_four::<2>(four, groups),
            3..=4 => run_four::<4>(four, groups),
            5..=6 => run_four::<6>(four, groups),
            7..=8 => run_four::<8>(four, groups),
            9..=12 => run_four::<12>(four, groups),
            _ => run_four::<MAX_ORDER>(four, groups),
        }
    }

    /// The first `N` entries of all tables, for an order up to `N`.
    #[inline(always)]
    fn short<const N: usize>(&self) -> Short<f64, N> {
        let mut states = [[0.0; N]; GROUP];
        for at in 0..GROUP {
            states[at] = first(&self.states[at]);
        }
        Short { outputs: self.outputs, states, state: first(&self.state) }
    }

    #[inline(always)]
    fn keep<const N: usize>(&mut self, state: &[f64; N]) {
        for i in 0..N {
            // This is checked once for a block and not for each sample, because 1e-200 is far above
            // denormal numbers.
            self.state[i] = without_denormals(state[i]);
        }
    }
}

#[inline(always)]
fn first<const N: usize>(of: &[f64; MAX_ORDER]) -> [f64; N] {
    let mut first = [0.0; N];
    first.copy_from_slice(&of[..N]);
    first
}

/// One voice and its block.
struct RunVoice<'a, const N: usize>(&'a mut Direct, &'a mut [[f64; GROUP]]);

impl<const N: usize> Work for RunVoice<'_, N> {
    #[inline(always)]
    fn run(self) {
        let Self(direct, groups) = self;
        let mut short = direct.short::<N>();
        short.run(groups);
        direct.keep(&short.state);
    }
}

/// Filters one block of each of four voices.
fn run_four<const N: usize>(mut four: [&mut Direct; VOICES], groups: &mut [[Quad; GROUP]]) {
    let mut short = Short::<Quad, N> {
        outputs: [Quad::ZERO; GROUP],
        states: [[Quad::ZERO; N]; GROUP],
        state: [Quad::ZERO; N],
    };
    wide(InterleaveVoices(&mut short, four.each_ref().map(|one| &**one)));
    wide(RunVoices(&mut short, groups));
    for (voice, own) in four.iter_mut().enumerate() {
        own.keep(&part(&short.state, voice));
    }
}

/// The filter loop for four voices. It is separate from the function that interleaves the voices,
/// because compilers would otherwise shuffle lanes inside the loop.
struct RunVoices<'a, const N: usize>(&'a mut Short<Quad, N>, &'a mut [[Quad; GROUP]]);

impl<const N: usize> Work for RunVoices<'_, N> {
    #[inline(always)]
    fn run(self) {
        self.0.run(self.1);
    }
}

/// [`Direct`] with `N` coefficients, for one voice or for four.
struct Short<T: Lane, const N: usize> {
    outputs: T::Outputs,
    states: [[T; N]; GROUP],
    state: [T; N],
}

/// Interleaves four voices.
struct InterleaveVoices<'a, const N: usize>(&'a mut Short<Quad, N>, [&'a Direct; VOICES]);

impl<const N: usize> Work for InterleaveVoices<'_, N> {
    #[inline(always)]
    fn run(self) {
        let Self(short, [a, b, c, d]) = self;
        short.outputs = beside([&a.outputs[0], &b.outputs[0], &c.outputs[0], &d.outputs[0]]);
        short.state = beside([&a.state, &b.state, &c.state, &d.state]);
        for at in 0..GROUP {
            let states = [&a.states[at], &b.states[at], &c.states[at], &d.states[at]];
            short.states[at] = beside(states);
        }
    }
}

/// What the lanes of a vector register contain: samples of one voice, or one sample of each voice.
trait Lane: Real {
    type Outputs: Copy;
    /// Computes the four outputs from the four inputs, which already include the state.
    fn outputs(left: &Self::Outputs, met: &[Self; GROUP]) -> [Self; GROUP];
}

impl Lane for f64 {
    type Outputs = [[f64; GROUP]; GROUP];

    #[inline(always)]
    fn outputs(left: &Self::Outputs, met: &[Self; GROUP]) -> [Self; GROUP] {
        sum(left, met)
    }
}

impl Lane for Quad {
    /// Contributions of the first input. The contributions of the other inputs are the same
    /// numbers, shifted.
    type Outputs = [Quad; GROUP];

    /// The same sums without multiplications by 0 or 1.
    #[inline(always)]
    fn outputs(&[_, h1, h2, h3]: &Self::Outputs, met: &[Self; GROUP]) -> [Self; GROUP] {
        // The brackets are the same as in `sum`. The omitted products by 0 and 1 change no finite
        // number. So one voice and four voices have the same bits.
        let [a, b, c, d] = *met;
        [a, h1 * a + b, (h2 * a + h1 * b) + c, (h3 * a + h2 * b) + (h1 * c + d)]
    }
}

// The functions use loops and not closures, because closures would not be compiled for the wider
// registers.
impl<T: Lane, const N: usize> Short<T, N> {
    /// Filters a block in place.
    #[inline(always)]
    fn run(&mut self, groups: &mut [[T; GROUP]]) {
        let (outputs, states, mut state) = (self.outputs, self.states, self.state);
        for group in groups {
            let mut met = *group;
            // With `N = 2` there are fewer states than inputs.
            for i in 0..GROUP.min(N) {
                met[i] = met[i] + state[i];
            }
            *group = T::outputs(&outputs, &met);
            let mut next = sum(&states, &met);
            for i in GROUP..N {
                next[i - GROUP] = next[i - GROUP] + state[i];
            }
            state = next;
        }
        self.state = state;
    }
}

/// Sums the contributions of each element of `met`.
#[inline(always)]
fn sum<T: Real, const N: usize>(left: &[[T; N]; GROUP], met: &[T; GROUP]) -> [T; N] {
    let mut sum = [T::ZERO; N];
    for i in 0..N {
        // The terms are summed in pairs, because this shortens the chain of additions.
        // `Quad::outputs` must keep this order.
        sum[i] = (left[0][i] * met[0] + left[1][i] * met[1])
            + (left[2][i] * met[2] + left[3][i] * met[3]);
    }
    sum
}

/// Filters one sample: returns the output and updates the state.
fn tick(a: &[f64], state: &mut [f64], input: f64) -> f64 {
    let y = input + state[0];
    for i in 0..a.len() {
        state[i] = a[i] * y + state.get(i + 1).copied().unwrap_or(0.0);
    }
    y
}
