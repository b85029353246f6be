//! Short arrays of numbers whose arithmetic compiles to vector instructions.

use core::ops::{Add, Mul, Sub};

/// Number of lanes: the f32 numbers in a register of 256 bits, or of 128 bits in a WASM module.
pub(crate) const WIDTH: usize = if cfg!(target_family = "wasm") { 4 } else { 8 };

/// Numbers in an array, which compilers turn into a vector register.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Lanes(pub(crate) [f32; WIDTH]);

// These are loops and not closures, because compilers do not always inline a closure into the
// function that is compiled for wide registers.

impl Add for Lanes {
    type Output = Self;

    #[inline(always)]
    fn add(mut self, other: Self) -> Self {
        for i in 0..WIDTH {
            self.0[i] += other.0[i];
        }
        self
    }
}

impl Sub for Lanes {
    type Output = Self;

    #[inline(always)]
    fn sub(mut self, other: Self) -> Self {
        for i in 0..WIDTH {
            self.0[i] -= other.0[i];
        }
        self
    }
}

impl Mul for Lanes {
    type Output = Self;

    #[inline(always)]
    fn mul(mut self, other: Self) -> Self {
        for i in 0..WIDTH {
            self.0[i] *= other.0[i];
        }
        self
    }
}

impl Mul<f32> for Lanes {
    type Output = Self;

    #[inline(always)]
    fn mul(mut self, factor: f32) -> Self {
        for i in 0..WIDTH {
            self.0[i] *= factor;
        }
        self
    }
}
