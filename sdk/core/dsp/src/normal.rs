//! Seeded normal random numbers in double precision.

use crate::root::sqrt;
use crate::uniform::Uniform;

/// A seeded generator of normal random numbers with zero mean and unit variance (Marsaglia's polar
/// method). The same seed gives the same bits on every machine.
/// [`GaussianNoise`](crate::noise::GaussianNoise) is several times faster, in single precision.
///
/// ```
/// use htex_dsp::normal::Normal;
/// let mut normal = Normal::new(7);
/// let power = (0..1000).map(|_| normal.next_normal().powi(2)).sum::<f64>() / 1000.0;
/// assert!((power - 1.0).abs() < 0.2);
/// ```
#[derive(Debug, Clone)]
pub struct Normal {
    uniform: Uniform,
    spare: Option<f64>,
}

impl Normal {
    pub fn new(seed: u64) -> Self {
        Self { uniform: Uniform::new(seed), spare: None }
    }

    pub fn next_normal(&mut self) -> f64 {
        if let Some(spare) = self.spare.take() {
            return spare;
        }
        loop {
            let (a, b) = (2.0 * self.next_unit() - 1.0, 2.0 * self.next_unit() - 1.0);
            let square = a * a + b * b;
            // 0 has no logarithm.
            if square < 1.0 && square > 0.0 {
                let scale = sqrt(-2.0 * libm::log(square) / square);
                self.spare = Some(b * scale);
                return a * scale;
            }
        }
    }

    /// Returns the next uniform number in `[0, 1)` from the same generator, with 53 random bits.
    pub fn next_unit(&mut self) -> f64 {
        self.uniform.next_unit()
    }
}
