//! The functions of a module, which each engine finds by name.

use super::fault::Fault;
use super::typed::{Parameters, Returned, TypedFunc};

/// An address or length in the module's memory.
pub(super) type Usize = u32;

/// Finds the functions of an instance.
pub(super) trait Find {
    fn find<P: Parameters, R: Returned>(
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
    /// Finds all functions. `motion` says whether to include those of `htex.motion/1`.
    pub(super) fn of(module: &mut impl Find, motion: bool) -> Result<Self, Fault> {
        Ok(Self {
            abi_version: module.find("htex_model_abi_version")?,
            descriptor: module.find("htex_model_descriptor")?,
            last_error: module.find("htex_model_last_error")?,
            fit: module.find("htex_model_fit")?,
            magnitude: module.find("htex_model_magnitude")?,
            interpolate: module.find("htex_model_interpolate")?,
            voice_rate: module.find("htex_model_voice_rate")?,
            voice_new: module.find("htex_model_voice_new")?,
            voice_render: module.find("htex_model_voice_render")?,
            voice_retune: module.find("htex_model_voice_retune")?,
            voice_free: module.find("htex_model_voice_free")?,
            extension: module.find("htex_model_extension")?,
            alloc: module.find("htex_model_alloc")?,
            free: module.find("htex_model_free")?,
            motion: motion.then(|| MotionFunctions::of(module)).transpose()?,
        })
    }
}

impl MotionFunctions {
    fn of(module: &mut impl Find) -> Result<Self, Fault> {
        Ok(Self { set: module.find("htex_motion_1_set")?, fit: module.find("htex_motion_1_fit")? })
    }
}
