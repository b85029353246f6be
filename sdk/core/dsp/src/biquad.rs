//! Second-order filter sections and the cascade that runs them.

use alloc::vec::Vec;
use core::f64::consts::PI;

use crate::spectrum::Complex;

/// Threshold below which the state is set to zero, so that it does not become denormal. Some
/// processors handle denormal numbers a hundred times slower than other numbers. The threshold is
/// some 200 decades below any perceptible amplitude.
const SMALLEST_STATE: f64 = 1e-200;

/// A second-order section: `H(z) = (b0 + b1 z⁻¹ + b2 z⁻²) / (1 + a1 z⁻¹ + a2 z⁻²)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Biquad {
    /// Coefficient of z⁰ in the numerator.
    pub b0: f64,
    /// Coefficient of z⁻¹ in the numerator.
    pub b1: f64,
    /// Coefficient of z⁻² in the numerator.
    pub b2: f64,
    /// Coefficient of z⁻¹ in the denominator.
    pub a1: f64,
    /// Coefficient of z⁻² in the denominator.
    pub a2: f64,
}

impl Biquad {
    /// The section that passes its input unchanged.
    pub const IDENTITY: Self = Self { b0: 1.0, b1: 0.0, b2: 0.0, a1: 0.0, a2: 0.0 };

    /// Magnitude `|H|` at `f_hz` for the sample rate `rate_hz`, both in hertz.
    pub fn magnitude(&self, f_hz: f64, rate_hz: f64) -> f64 {
        let (sine, cosine) = crate::trig::sincos(PI * f_hz / rate_hz);
        let squared = |c0: f64, c1: f64, c2: f64| {
            if sine.abs() < cosine.abs() {
                squared_magnitude(c0, c1, c2, sine * sine)
            } else {
                // The angle is measured from the Nyquist frequency down: z -> -z changes the sign
                // of the odd coefficient.
                squared_magnitude(c0, -c1, c2, cosine * cosine)
            }
        };
        crate::root::sqrt(squared(self.b0, self.b1, self.b2) / squared(1.0, self.a1, self.a2))
    }

    /// Complex frequency response at `f_hz` for the sample rate `rate_hz`, both in hertz. Near 0
    /// Hz, [`Self::magnitude`] is more accurate.
    ///
    /// ```
    /// use htex_dsp::biquad::Biquad;
    /// let delay = Biquad { b0: 0.0, b1: 1.0, ..Biquad::IDENTITY };
    /// let response = delay.response(250.0, 1000.0);
    /// assert!(response.re.abs() < 1e-15 && (response.im + 1.0).abs() < 1e-15);
    /// ```
    pub fn response(&self, f_hz: f64, rate_hz: f64) -> Complex<f64> {
        let angle = -2.0 * PI * f_hz / rate_hz;
        let delay = Complex::new(libm::cos(angle), libm::sin(angle));
        let numerator = delay * (delay * self.b2 + self.b1) + self.b0;
        numerator / (delay * (delay * self.a2 + self.a1) + 1.0)
    }

    /// Whether both poles lie inside the unit circle.
    pub fn is_stable(&self) -> bool {
        self.a2.abs() < 1.0 && self.a1.abs() < 1.0 + self.a2
    }
}

/// `|c0 + c1 z⁻¹ + c2 z⁻²|²` from `phi = sin²(ω/2)`. Accurate near ω = 0, where the direct sum
/// cancels.
fn squared_magnitude(c0: f64, c1: f64, c2: f64, phi: f64) -> f64 {
    let sum = c0 + c1 + c2;
    let linear = c0 * c1 + 4.0 * c0 * c2 + c1 * c2;
    // At a zero on the unit circle, rounding can make this slightly negative, and its root NaN.
    (sum * sum - 4.0 * linear * phi + 16.0 * c0 * c2 * phi * phi).max(0.0)
}

/// Filters a block by `N` sections, with their state in registers.
fn run<const N: usize>(sections: &mut [Section; N], block: &mut [f64]) {
    let mut own = *sections;
    for sample in block {
        *sample = own.iter_mut().fold(*sample, |x, section| section.tick(x));
    }
    *sections = own;
}

/// A section with its state (transposed direct form II).
#[derive(Debug, Clone, Copy)]
struct Section {
    biquad: Biquad,
    s1: f64,
    s2: f64,
}

impl Section {
    fn at_rest(biquad: Biquad) -> Self {
        Self { biquad, s1: 0.0, s2: 0.0 }
    }

    #[inline]
    fn tick(&mut self, x: f64) -> f64 {
        let c = &self.biquad;
        let y = c.b0 * x + self.s1;
        self.s1 = without_denormals(c.b1 * x - c.a1 * y + self.s2);
        self.s2 = without_denormals(c.b2 * x - c.a2 * y);
        y
    }
}

#[inline]
pub(crate) fn without_denormals(state: f64) -> f64 {
    if state.abs() < SMALLEST_STATE { 0.0 } else { state }
}

/// A cascade: second-order sections in series, with f64 state. Does not allocate after
/// construction.
///
/// The output does not depend on the sizes of the blocks.
///
/// ```
/// use htex_dsp::{biquad::Cascade, butterworth};
/// let sections = butterworth::low_pass(2, 200.0, 20_000.0).ok_or("above Nyquist")?;
/// let mut filter = Cascade::new(&sections);
/// let mut block = [1.0; 64];
/// filter.process(&mut block);
/// assert!(block[63] > block[0]);
/// # Ok::<(), &str>(())
/// ```
#[derive(Debug, Clone)]
pub struct Cascade {
    sections: Vec<Section>,
}

impl Cascade {
    /// Makes a cascade of `sections` with zero state.
    pub fn new(sections: &[Biquad]) -> Self {
        Self { sections: sections.iter().map(|&b| Section::at_rest(b)).collect() }
    }

    /// Filters one sample.
    #[inline]
    pub fn tick(&mut self, input: f64) -> f64 {
        self.sections.iter_mut().fold(input, |x, section| section.tick(x))
    }

    /// Filters a block in place.
    pub fn process(&mut self, block: &mut [f64]) {
        // Four sections at a time, sample by sample: the processor computes one section while
        // another waits for its own previous output.
        let (fours, rest) = self.sections.as_chunks_mut::<4>();
        for four in fours {
            run(four, block);
        }
        let (twos, rest) = rest.as_chunks_mut::<2>();
        for two in twos {
            run(two, block);
        }
        for one in rest {
            run(core::array::from_mut(one), block);
        }
    }

    /// Sets the state of every section to zero.
    pub fn reset(&mut self) {
        for section in &mut self.sections {
            (section.s1, section.s2) = (0.0, 0.0);
        }
    }

    /// Magnitude `|H|` of the whole cascade at `f_hz` for the sample rate `rate_hz`, both in hertz.
    pub fn magnitude(&self, f_hz: f64, rate_hz: f64) -> f64 {
        self.sections.iter().map(|section| section.biquad.magnitude(f_hz, rate_hz)).product()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_section_is_stable_if_both_poles_lie_inside() {
        let holds = |a1, a2| {
            let section = Biquad { a1, a2, ..Biquad::IDENTITY };
            section.is_stable()
        };
        // Real poles, (z - p) (z - q), and a pair at a radius.
        for (p, q, stable) in [
            (0.9, -0.9, true),
            (0.9, 0.8, true),
            (1.1, 0.5, false),
            (-1.1, 0.5, false),
            (1.1, -0.9, false),
            (1.5, 1.5, false),
        ] {
            assert_eq!(holds(-(p + q), p * q), stable, "{p} {q}");
        }
        for (radius, stable) in [(0.99, true), (1.01, false)] {
            assert_eq!(holds(radius * 0.6, radius * radius), stable, "{radius}");
        }
        assert!(!holds(f64::NAN, 0.0) && !holds(0.0, f64::NAN));
    }
}
