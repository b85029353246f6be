//! Normal random numbers that are equal on every machine.

use htex_dsp::uniform::Uniform;

/// A stream of random numbers; streams of one seed with different labels are independent.
#[derive(Debug, Clone)]
pub(super) struct Random {
    uniform: Uniform,
    spare: Option<f64>,
}

impl Random {
    pub(super) fn new(seed: u64, label: u64) -> Self {
        // The odd factor spreads small labels over all bits; the generator mixes further when it is seeded.
        let mixed = seed ^ label.wrapping_mul(0x9E37_79B9_7F4A_7C15);
        Self {
            uniform: Uniform::new(mixed),
            spare: None,
        }
    }

    /// Returns a number uniform on [0, 1).
    pub(super) fn uniform(&mut self) -> f64 {
        self.uniform.next_unit()
    }

    /// Returns a number of zero mean and unit variance (Marsaglia's polar method).
    pub(super) fn normal(&mut self) -> f64 {
        if let Some(spare) = self.spare.take() {
            return spare;
        }
        loop {
            let (a, b) = (2.0 * self.uniform() - 1.0, 2.0 * self.uniform() - 1.0);
            let square = a * a + b * b;
            if square < 1.0 && square > 0.0 {
                let scale = libm::sqrt(-2.0 * libm::log(square) / square);
                self.spare = Some(b * scale);
                return a * scale;
            }
        }
    }
}
