//! The values that the command line accepts for settings with a fixed list of choices. The values
//! have the same names as in recipes.

use clap::ValueEnum;
use clap::builder::PossibleValue;

use super::Preset;
use crate::{Averaging, Coding, Level, SegmentChoice};

macro_rules! choices {
    ($($choice:ty),*) => {$(
        impl ValueEnum for $choice {
            fn value_variants<'a>() -> &'a [Self] {
                Self::ALL
            }

            fn to_possible_value(&self) -> Option<PossibleValue> {
                Some(PossibleValue::new(self.name()))
            }
        }
    )*};
}

choices!(Averaging, Coding, Level, Preset, SegmentChoice);
