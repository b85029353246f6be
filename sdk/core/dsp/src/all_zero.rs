//! All-zero filter: the inverse of an all-pole filter with the same coefficients.

use crate::wide::{Work, wide};

/// Highest order of the filter.
pub const MAX_ORDER: usize = 64;
/// Number of samples that are filtered together.
const CHUNK: usize = 128;

/// The filter `H(z) = 1 - Σ A_i z⁻ⁱ`, whose coefficients can change while it runs (f64 state).
///
/// ```
/// use htex_dsp::all_zero::AllZero;
/// let mut filter = AllZero::new(&[0.5]).ok_or("too many coefficients")?;
/// let mut block = [1.0, 0.5, 0.25, 0.125];
/// filter.process(&mut block);
/// assert_eq!(block, [1.0, 0.0, 0.0, 0.0]);
/// # Ok::<(), &str>(())
/// ```
#[derive(Debug, Clone)]
pub struct AllZero {
    coefficients: [f64; MAX_ORDER],
    order: usize,
    /// The last inputs, the newest at the end.
    past: [f64; MAX_ORDER],
}

impl AllZero {
    /// Returns a filter with zero state, or `None` if there are more than [`MAX_ORDER`]
    /// coefficients.
    pub fn new(coefficients: &[f64]) -> Option<Self> {
        let mut filter = Self {
            coefficients: [0.0; MAX_ORDER],
            order: coefficients.len(),
            past: [0.0; MAX_ORDER],
        };
        let own = filter.coefficients.get_mut(..coefficients.len())?;
        own.copy_from_slice(coefficients);
        Some(filter)
    }

    /// Raises the filter's order to at least `order`, but not above [`MAX_ORDER`]. The new
    /// coefficients are 0.
    pub fn raise_order(&mut self, order: usize) {
        self.order = self.order.max(order.min(MAX_ORDER));
    }

    /// Returns the coefficients. The caller may change the coefficients between samples.
    pub fn coefficients_mut(&mut self) -> &mut [f64] {
        &mut self.coefficients[..self.order]
    }

    /// Filters one sample. Use this function while coefficients change. The output has the same
    /// bits as the output of [`Self::process`].
    pub fn tick(&mut self, input: f64) -> f64 {
        // One product after the other, in the order of `Sums`, so that both give the same bits.
        let own = self.coefficients[..self.order].iter();
        let output = own.zip(self.past.iter().rev()).fold(input, |sum, (a, x)| sum - a * x);
        self.past.copy_within(1.., 0);
        self.past[MAX_ORDER - 1] = input;
        output
    }

    /// Filters a block in place. Does not allocate.
    pub fn process(&mut self, block: &mut [f64]) {
        // On the stack, because rendering must not allocate.
        let mut room = [0.0; MAX_ORDER + CHUNK];
        for chunk in block.chunks_mut(CHUNK) {
            room[..MAX_ORDER].copy_from_slice(&self.past);
            room[MAX_ORDER..MAX_ORDER + chunk.len()].copy_from_slice(chunk);
            wide(Sums {
                coefficients: &self.coefficients[..self.order],
                inputs: &room,
                block: chunk,
            });
            self.past.copy_from_slice(&room[chunk.len()..chunk.len() + MAX_ORDER]);
        }
    }
}

/// Subtracts the weighted past inputs from all samples of a chunk, one coefficient after the other.
struct Sums<'a> {
    coefficients: &'a [f64],
    /// The inputs before the chunk, and in the chunk.
    inputs: &'a [f64; MAX_ORDER + CHUNK],
    block: &'a mut [f64],
}

impl Work for Sums<'_> {
    #[inline(always)]
    fn run(self) {
        // The samples are the inner loop, because their sums do not depend on each other and
        // compilers can vectorise them. Each sum still has the order of `tick`.
        for (i, a) in self.coefficients.iter().enumerate() {
            let earlier = &self.inputs[MAX_ORDER - 1 - i..];
            for (sum, x) in self.block.iter_mut().zip(earlier) {
                *sum -= a * x;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::GaussianNoise;
    use alloc::vec::Vec;

    /// Single samples, blocks of any length, and a raised order all give the same bits.
    #[test]
    fn blocks_are_single_samples() {
        for order in [0, 1, 5, 18, MAX_ORDER] {
            let coefficients: Vec<f64> = (0..order).map(|i| 0.7 / (i + 1) as f64).collect();
            let mut noise = GaussianNoise::new(1);
            let input: Vec<f64> = (0..700).map(|_| noise.next_sample().into()).collect();
            let mut single = AllZero::new(&coefficients).unwrap();
            let expected: Vec<f64> = input.iter().map(|x| single.tick(*x)).collect();
            for len in [1, 7, 128, 300] {
                let mut filter = AllZero::new(&coefficients).unwrap();
                let mut block = input.clone();
                for (i, part) in block.chunks_mut(len).enumerate() {
                    if i == 1 {
                        filter.raise_order(order + 3);
                    }
                    filter.process(part);
                }
                assert_eq!(block, expected, "order {order}, blocks of {len}");
            }
        }
        assert!(AllZero::new(&[0.0; MAX_ORDER + 1]).is_none());
    }
}
