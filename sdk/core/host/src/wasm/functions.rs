//! The functions of a module. Each engine looks them up by their names.

use htex_base::native::table_of_symbols;

use super::fault::Fault;
use super::typed::{Parameters, Returned, TypedFunc};

/// An address or length in the module's memory.
pub(super) type Usize = u32;

/// Finds the functions of an instance.
pub(super) trait Find {
    fn get<P: Parameters, R: Returned>(
        &mut self,
        name: &'static str,
    ) -> Result<TypedFunc<P, R>, Fault>;
}

/// The functions of the model ABI (`htex_model::abi`).
pub(super) struct Functions {
    pub(super) abi_version: TypedFunc<(), u32>,
    pub(super) descriptor: TypedFunc<(Usize, Usize), i64>,
    pub(super) last_error: TypedFunc<(Usize, Usize), i64>,
    pub(super) fit: TypedFunc<FitParams, i64>,
    pub(super) magnitude: TypedFunc<MagnitudeParams, i64>,
    pub(super) interpolate: TypedFunc<(Usize, Usize, Usize, Usize, Usize, Usize), i64>,
    pub(super) voice_rate: TypedFunc<(Usize, Usize, f64, f64, f64), f64>,
    pub(super) voice_new: TypedFunc<(Usize, Usize, f64, f64, f64, u64), i64>,
    pub(super) voice_render: TypedFunc<(i64, Usize, Usize), i64>,
    pub(super) voice_retune: TypedFunc<(i64, Usize, Usize), i64>,
    pub(super) voice_free: TypedFunc<i64, i64>,
    pub(super) extension: TypedFunc<(Usize, Usize), i64>,
    /// Present if the model has the extension `htex.motion/1`.
    pub(super) motion: Option<MotionFunctions>,
    pub(super) alloc: TypedFunc<Usize, Usize>,
    pub(super) free: TypedFunc<(Usize, Usize), ()>,
}

/// The functions of `htex.motion/1` (`htex_model::motion_1`).
pub(super) struct MotionFunctions {
    pub(super) set: TypedFunc<(i64, f64, f64, f64, f64, f64), i64>,
    pub(super) fit: TypedFunc<MotionFitParams, i64>,
}

type FitParams =
    (f64, f64, Usize, Usize, Usize, Usize, Usize, f64, Usize, Usize, Usize, Usize, Usize);

type MotionFitParams =
    (f64, f64, Usize, Usize, Usize, Usize, Usize, f64, Usize, Usize, f64, f64, Usize, Usize, Usize);

type MagnitudeParams = (Usize, Usize, f64, f64, Usize, Usize, Usize);

impl Functions {
    /// Finds all functions. `motion` says whether to include the functions of `htex.motion/1`.
    pub(super) fn find(module: &mut impl Find, motion: bool) -> Result<Self, Fault> {
        Ok(table_of_symbols!(
            module, Self, "htex_model_",
            abi_version descriptor last_error fit magnitude interpolate
            voice_rate voice_new voice_render voice_retune voice_free extension alloc free;
            motion: motion.then(|| MotionFunctions::find(module)).transpose()?
        ))
    }
}

impl MotionFunctions {
    fn find(module: &mut impl Find) -> Result<Self, Fault> {
        Ok(table_of_symbols!(module, Self, "htex_motion_1_", set fit))
    }
}
