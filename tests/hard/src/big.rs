//! 256-bit floating point numbers, as a reference.

use std::cell::RefCell;
use std::ops::{Add, Div, Mul, Neg, Sub};

use astro_float::{BigFloat, Consts, Radix, RoundingMode};

const BITS: usize = 256;
const ROUND: RoundingMode = RoundingMode::ToEven;

thread_local! {
    static CONSTS: RefCell<Consts> = RefCell::new(Consts::new().unwrap());
}

/// A 256-bit number.
#[derive(Debug, Clone)]
pub struct Big(BigFloat);

/// Converts a number without rounding.
pub fn big(x: f64) -> Big {
    Big(BigFloat::from_f64(x, BITS))
}

fn with(call: impl FnOnce(&mut Consts) -> BigFloat) -> Big {
    CONSTS.with(|consts| Big(call(&mut consts.borrow_mut())))
}

impl Big {
    pub fn pi() -> Self {
        with(|consts| consts.pi(BITS, ROUND))
    }

    /// Sine, radians.
    pub fn sin(&self) -> Self {
        with(|consts| self.0.sin(BITS, ROUND, consts))
    }

    /// Cosine, radians.
    pub fn cos(&self) -> Self {
        with(|consts| self.0.cos(BITS, ROUND, consts))
    }

    /// Natural logarithm.
    pub fn ln(&self) -> Self {
        with(|consts| self.0.ln(BITS, ROUND, consts))
    }

    /// Exponential.
    pub fn exp(&self) -> Self {
        with(|consts| self.0.exp(BITS, ROUND, consts))
    }

    /// Any power of a positive number.
    pub fn pow(&self, exponent: &Self) -> Self {
        (exponent.clone() * self.ln()).exp()
    }

    /// Square root.
    pub fn sqrt(&self) -> Self {
        Self(self.0.sqrt(BITS, ROUND))
    }

    /// Rounds to f64, through decimals.
    pub fn to_f64(&self) -> f64 {
        let text = CONSTS.with(|consts| {
            let consts = &mut consts.borrow_mut();
            self.0.format(Radix::Dec, ROUND, consts).unwrap()
        });
        text.parse().unwrap()
    }

    /// `|x - self| / |self|`.
    pub fn relative_error(&self, x: f64) -> f64 {
        if !x.is_finite() {
            return f64::NAN;
        }
        let off = ((big(x) - self.clone()) / self.clone()).to_f64();
        off.abs()
    }
}

impl Add for Big {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self(self.0.add(&other.0, BITS, ROUND))
    }
}

impl Sub for Big {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self(self.0.sub(&other.0, BITS, ROUND))
    }
}

impl Mul for Big {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self(self.0.mul(&other.0, BITS, ROUND))
    }
}

impl Div for Big {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        Self(self.0.div(&other.0, BITS, ROUND))
    }
}

impl Neg for Big {
    type Output = Self;
    fn neg(self) -> Self {
        Self(self.0.neg())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_hundred_bits_are_right() {
        let third = big(1.0) / big(3.0);
        let back = (third * big(3.0) - big(1.0)).to_f64();
        assert!(back.abs() < 1e-70, "{back}");
        let angle = Big::pi() / big(6.0);
        assert!((angle.sin() - big(0.5)).to_f64().abs() < 1e-70);
        assert!((big(2.0).ln().exp() - big(2.0)).to_f64().abs() < 1e-70);
        assert_eq!(big(4.0).pow(&big(0.5)).to_f64(), 2.0);
    }
}
