//! Numbers side by side, compiled to vector instructions.

use core::ops::{Add, Mul, Sub};

/// Numbers side by side: those of a register of 256 bits, or, in a WASM module, of 128.
pub(crate) const WIDTH: usize = if cfg!(target_family = "wasm") { 4 } else { 8 };

/// What compilers make vector registers of.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Lanes(pub(crate) [f32; WIDTH]);

// Loops, as closures are not always compiled into the function that has the wide registers.

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
