//! Numbers side by side, of which compilers make vector instructions.

use core::ops::{Add, Mul, Sub};

/// One number, or several side by side.
pub(crate) trait Number:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<f32, Output = Self>
{
    const LEN: usize;
    /// As many numbers as stand side by side.
    type Group: Copy;
    fn groups(from: &[f32]) -> &[Self::Group];
    fn groups_mut(to: &mut [f32]) -> &mut [Self::Group];
    fn load(from: Self::Group) -> Self;
    fn store(self) -> Self::Group;
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
}

pub(crate) const LANES: usize = 4;

/// What compilers make vector registers of.
#[derive(Clone, Copy, Default)]
pub(crate) struct Lanes(pub(crate) [f32; LANES]);

impl Number for Lanes {
    const LEN: usize = LANES;
    type Group = [f32; LANES];

    #[inline(always)]
    fn groups(from: &[f32]) -> &[[f32; LANES]] {
        from.as_chunks().0
    }

    #[inline(always)]
    fn groups_mut(to: &mut [f32]) -> &mut [[f32; LANES]] {
        to.as_chunks_mut().0
    }

    #[inline(always)]
    fn load(from: [f32; LANES]) -> Self {
        Self(from)
    }

    #[inline(always)]
    fn store(self) -> [f32; LANES] {
        self.0
    }
}

impl Add for Lanes {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self(core::array::from_fn(|i| self.0[i] + other.0[i]))
    }
}

impl Sub for Lanes {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self(core::array::from_fn(|i| self.0[i] - other.0[i]))
    }
}

impl Mul<f32> for Lanes {
    type Output = Self;

    #[inline(always)]
    fn mul(self, factor: f32) -> Self {
        Self(self.0.map(|x| x * factor))
    }
}

impl Mul for Lanes {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self(core::array::from_fn(|i| self.0[i] * other.0[i]))
    }
}
