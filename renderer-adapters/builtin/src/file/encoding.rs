//! Encodings of the samples in a file.

/// How a sample is encoded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Encoding {
    /// Each sample is the quantity itself, as a 32-bit float.
    F32,
    /// Each sample is an integer number of steps, in two's complement.
    Integer {
        /// 16 or 24.
        bits: u16,
        /// Size of one step, in the quantity's unit.
        step: f64,
    },
}

impl Encoding {
    /// Makes an encoding as integers of `bits` bits, where `full_scale` is 2^(bits-1) steps.
    pub(crate) fn integer(bits: u16, full_scale: f64) -> Self {
        let steps = f64::from(1_i32 << (bits - 1));
        Self::Integer { bits, step: full_scale / steps }
    }

    /// Returns the number of bytes per sample.
    pub(crate) fn bytes(self) -> u16 {
        match self {
            Self::F32 => 4,
            Self::Integer { bits, .. } => bits / 8,
        }
    }

    /// Returns the step, and the largest magnitude that can be encoded with either sign.
    pub(crate) fn step_and_limit(self) -> Option<(f64, f64)> {
        match self {
            Self::F32 => None,
            Self::Integer { bits, step } => {
                // The lowest code has no positive counterpart.
                let most = (1_i32 << (bits - 1)) - 1;
                Some((step, f64::from(most) * step))
            }
        }
    }
}

/// Rounds to the nearest integer number of steps. Ties go to the even number. The caller has
/// checked that the result is within the range of the encoding.
pub(crate) fn code(sample: f32, step: f64) -> i32 {
    (f64::from(sample) / step).round_ties_even() as i32
}

#[cfg(test)]
mod tests {
    use super::*;
    use htex_device::{Capabilities, Quantity, Rates};
    use proptest::prelude::*;

    #[test]
    fn ties_go_to_the_even_code() {
        let step = 0.25;
        let codes = [0.125, 0.375, -0.125, -0.375, 0.13].map(|x| code(x, step));
        assert_eq!(codes, [0, 2, 0, -2, 1]);
    }

    proptest! {
        /// Every sample within the limit has a code, and a quantised sample keeps its code.
        #[test]
        fn every_sample_within_the_limit_has_a_code(
            full_scale in 1e-6..1e3_f64, at in -1.0..=1.0_f64, bits in prop_oneof![Just(16), Just(24)]
        ) {
            let (step, limit) = Encoding::integer(bits, full_scale).step_and_limit().unwrap();
            let most = (1_i32 << (bits - 1)) - 1;
            let capabilities = Capabilities {
                quantity: Quantity::LateralForce,
                rates: Rates::List(vec![1e4]),
                default_rate_hz: 1e4,
                limit: Some(limit),
                step: Some(step),
                carrier_hz: None,
                paced: false,
                block_frames: 1,
            };
            for at in [at, 1.0, -1.0] {
                let wanted = (at * f64::from(most)).round() as i32;
                let sample = (f64::from(wanted) * step) as f32;
                prop_assert!(capabilities.check_samples(&[sample], 0).is_ok());
                prop_assert_eq!(code(sample, step), wanted);
            }
        }
    }
}
