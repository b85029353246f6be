//! Numbers side by side, compiled to vector instructions.

use core::ops::{Add, Mul, Sub};

/// One number, or several side by side.
pub(crate) trait Number:
    Copy + Default + Add<Output = Self> + Sub<Output = Self> + Mul<f32, Output = Self>
{
    const LEN: usize;
    /// Array of the numbers side by side.
    type Group: Copy;
    fn groups(from: &[f32]) -> &[Self::Group];
    fn groups_mut(to: &mut [f32]) -> &mut [Self::Group];
    fn load(from: Self::Group) -> Self;
    fn store(self) -> Self::Group;
    fn number(self, i: usize) -> f32;
    /// Element-wise product.
    fn times(self, other: Self) -> Self;
}

impl Number for f32 {
    const LEN: usize = 1;
    type Group = f32;

    #[inline(always)]
    fn groups(from: &[f32]) -> &[f32] {
        from
    }

    #[inline(always)]
    fn groups_mut(to: &mut [f32]) -> &mut [f32] {
        to
    }

    #[inline(always)]
    fn load(from: f32) -> Self {
        from
    }

    #[inline(always)]
    fn store(self) -> f32 {
        self
    }

    #[inline(always)]
    fn number(self, _: usize) -> f32 {
        self
    }

    #[inline(always)]
    fn times(self, other: f32) -> f32 {
        self * other
    }
}

/// Several numbers, compiled to one vector register.
#[derive(Clone, Copy)]
pub(crate) struct Lanes<const N: usize>(pub(crate) [f32; N]);

impl<const N: usize> Default for Lanes<N> {
    #[inline(always)]
    fn default() -> Self {
        Self([0.0; N])
    }
}

impl<const N: usize> Number for Lanes<N> {
    const LEN: usize = N;
    type Group = [f32; N];

    #[inline(always)]
    fn groups(from: &[f32]) -> &[[f32; N]] {
        from.as_chunks().0
    }

    #[inline(always)]
    fn groups_mut(to: &mut [f32]) -> &mut [[f32; N]] {
        to.as_chunks_mut().0
    }

    #[inline(always)]
    fn load(from: [f32; N]) -> Self {
        Self(from)
    }

    #[inline(always)]
    fn store(self) -> [f32; N] {
        self.0
    }

    #[inline(always)]
    fn number(self, i: usize) -> f32 {
        self.0[i]
    }

    #[inline(always)]
    fn times(mut self, other: Self) -> Self {
        for i in 0..N {
            self.0[i] *= other.0[i];
        }
        self
    }
}

// Loops, as closures are not always compiled into the function that has the wide registers.

impl<const N: usize> Add for Lanes<N> {
    type Output = Self;

    #[inline(always)]
    fn add(mut self, other: Self) -> Self {
        for i in 0..N {
            self.0[i] += other.0[i];
        }
        self
    }
}

impl<const N: usize> Sub for Lanes<N> {
    type Output = Self;

    #[inline(always)]
    fn sub(mut self, other: Self) -> Self {
        for i in 0..N {
            self.0[i] -= other.0[i];
        }
        self
    }
}

impl<const N: usize> Mul<f32> for Lanes<N> {
    type Output = Self;

    #[inline(always)]
    fn mul(mut self, factor: f32) -> Self {
        for i in 0..N {
            self.0[i] *= factor;
        }
        self
    }
}
