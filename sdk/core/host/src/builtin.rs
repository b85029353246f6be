//! Models linked into this program. The host calls these models through their tables of C
//! functions.

use std::sync::{Arc, LazyLock};

use htex_model::abi::ModelTable;
use htex_model::motion_1::MotionTable;

use crate::table::TableModel;
use crate::{LoadedModel, Origin};

/// Returns the built-in models in their display order. The first call loads them.
pub(crate) fn models() -> &'static [LoadedModel] {
    static MODELS: LazyLock<Vec<LoadedModel>> = LazyLock::new(|| {
        let load = |table| LoadedModel::new(Origin::Builtin, Arc::new(table));
        // A built-in model that cannot be loaded is left out. A test checks the number of models.
        tables().into_iter().flat_map(load).collect()
    });
    &MODELS
}

/// The functions that render several voices of a model in one call, for large scenes. A program for
/// web pages leaves these functions out: a page plays only few voices, so it should not have to
/// download them.
#[cfg(not(target_family = "wasm"))]
macro_rules! voices {
    ($model:ident) => {
        Some(&$model::VOICES)
    };
}
#[cfg(target_family = "wasm")]
macro_rules! voices {
    ($model:ident) => {
        None
    };
}

/// The tables of a model's crate. Only programs that fit models contain the function `fit`. In
/// other programs, nothing refers to this function, so the linker removes it, and also the code
/// that only this function uses.
macro_rules! model {
    ($model:ident) => {{
        #[cfg(feature = "fit")]
        static TABLE: &ModelTable = &$model::TABLE;
        #[cfg(feature = "fit")]
        static MOTION: &Option<MotionTable> = &$model::MOTION;
        #[cfg(not(feature = "fit"))]
        static TABLE: &ModelTable = &ModelTable { fit: without_fits, ..$model::TABLE };
        #[cfg(not(feature = "fit"))]
        static MOTION: &Option<MotionTable> = &match $model::MOTION {
            Some(motion) => Some(MotionTable { fit: without_fits_at, ..motion }),
            None => None,
        };
        TableModel::new(TABLE, voices!($model), MOTION.as_ref())
    }};
}

/// Lists the built-in models. To add a built-in model, add it here. Then every program that links
/// this crate contains the model. The model's descriptor contains everything else that programs
/// need, as for a plugin.
fn tables() -> Vec<TableModel> {
    vec![
        model!(htex_ar),
        model!(htex_mfcc),
        model!(htex_speak),
        model!(htex_sbeta),
        model!(htex_sslope),
        model!(htex_bands),
        model!(htex_arma),
        model!(htex_map),
    ]
}

/// Every model is loaded, and states a usual range for each parameter. The studio needs these
/// ranges for its sliders.
#[cfg(test)]
#[test]
fn every_model_is_loaded_and_has_usual_ranges() {
    assert_eq!(models().len(), tables().len());
    for model in models() {
        for field in &model.descriptor().fields {
            assert!(field.usual.is_some(), "{}.{}", model.id(), field.name);
        }
    }
}

/// A fit that always fails.
#[cfg(not(feature = "fit"))]
unsafe extern "C" fn without_fits(
    _band_low_hz: f64,
    _band_high_hz: f64,
    _frequency_hz: *const f64,
    _magnitude: *const f64,
    _bins: usize,
    _signal: *const f64,
    _signal_len: usize,
    _signal_rate_hz: f64,
    _options: *const f64,
    _options_len: usize,
    _parameters: *mut f64,
    _capacity: usize,
    _level_rms: *mut f64,
) -> i64 {
    htex_model::Status::CannotFit as i64
}

/// The same as [`without_fits`], but for the extension `htex.motion/1`.
#[cfg(not(feature = "fit"))]
unsafe extern "C" fn without_fits_at(
    _band_low_hz: f64,
    _band_high_hz: f64,
    _frequency_hz: *const f64,
    _magnitude: *const f64,
    _bins: usize,
    _signal: *const f64,
    _signal_len: usize,
    _signal_rate_hz: f64,
    _options: *const f64,
    _options_len: usize,
    _speed_mm_s: f64,
    _force_n: f64,
    _parameters: *mut f64,
    _capacity: usize,
    _level_rms: *mut f64,
) -> i64 {
    htex_model::Status::CannotFit as i64
}
