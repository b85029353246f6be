//! Converts the typed arguments and results of a module's functions to and from 64-bit numbers.

use std::marker::PhantomData;

use super::fault::Fault;
use super::imports::GuestInstance;

/// Types of arguments and results.
const I32: u8 = 0;
const I64: u8 = 1;
const F64: u8 = 2;
const NONE: u8 = 3;

/// A function of an instance: its index among the requested names.
pub(super) struct TypedFunc<P, R> {
    index: u32,
    of: PhantomData<fn(P) -> R>,
}

impl<P: Parameters, R: Returned> TypedFunc<P, R> {
    pub(super) const fn new(index: u32) -> Self {
        Self { index, of: PhantomData }
    }

    pub(super) fn call(&self, instance: &GuestInstance, parameters: P) -> Result<R, Fault> {
        let mut slots = Slots::default();
        parameters.push(&mut slots);
        let (types, values) = (&slots.types[..slots.len], &slots.values[..slots.len]);
        instance.call(self.index, types, values, R::TYPE).map(R::from_bits).map_err(Fault::Trap)
    }
}

/// Maximum number of arguments of a function of the model ABI.
const MOST: usize = 16;

/// Arguments and their types.
#[derive(Default)]
pub(super) struct Slots {
    types: [u8; MOST],
    values: [u64; MOST],
    len: usize,
}

impl Slots {
    fn push(&mut self, of: u8, value: u64) {
        self.types[self.len] = of;
        self.values[self.len] = value;
        self.len += 1;
    }
}

/// One argument.
pub(super) trait Parameter {
    fn push(&self, slots: &mut Slots);
}

impl Parameter for u32 {
    fn push(&self, slots: &mut Slots) {
        slots.push(I32, u64::from(*self));
    }
}

impl Parameter for i64 {
    fn push(&self, slots: &mut Slots) {
        slots.push(I64, self.cast_unsigned());
    }
}

impl Parameter for u64 {
    fn push(&self, slots: &mut Slots) {
        slots.push(I64, *self);
    }
}

impl Parameter for f64 {
    fn push(&self, slots: &mut Slots) {
        slots.push(F64, self.to_bits());
    }
}

/// The arguments of a function: a single one, or several.
pub(super) trait Parameters {
    fn push(&self, slots: &mut Slots);
}

impl Parameters for () {
    fn push(&self, _: &mut Slots) {}
}

impl<T: Parameter> Parameters for T {
    fn push(&self, slots: &mut Slots) {
        Parameter::push(self, slots);
    }
}

macro_rules! several {
    ($($name:ident)+) => {
        impl<$($name: Parameter),+> Parameters for ($($name,)+) {
            #[allow(non_snake_case)]
            fn push(&self, slots: &mut Slots) {
                let ($($name,)+) = self;
                $($name.push(slots);)+
            }
        }
    };
}

several!(A B);
several!(A B C);
several!(A B C D);
several!(A B C D E);
several!(A B C D E F);
several!(A B C D E F G);
several!(A B C D E F G H I J K L M);
several!(A B C D E F G H I J K L M N O);

/// The result of a function.
pub(super) trait Returned {
    const TYPE: u8;

    fn from_bits(bits: u64) -> Self;
}

impl Returned for () {
    const TYPE: u8 = NONE;

    fn from_bits(_: u64) -> Self {}
}

impl Returned for u32 {
    const TYPE: u8 = I32;

    fn from_bits(bits: u64) -> Self {
        bits as Self
    }
}

impl Returned for i64 {
    const TYPE: u8 = I64;

    fn from_bits(bits: u64) -> Self {
        bits.cast_signed()
    }
}

impl Returned for f64 {
    const TYPE: u8 = F64;

    fn from_bits(bits: u64) -> Self {
        Self::from_bits(bits)
    }
}
