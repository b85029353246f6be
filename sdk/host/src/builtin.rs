//! Models linked into this program, called through their tables.

use std::sync::{Arc, LazyLock};

use htex_model::abi::ModelTable;

use crate::table::TableModel;
use crate::{LoadedModel, Origin};

/// Returns the built-in models in their display order. They are loaded once.
pub(crate) fn models() -> &'static [LoadedModel] {
    static MODELS: LazyLock<Vec<LoadedModel>> = LazyLock::new(|| {
        let load = |table| LoadedModel::new(Origin::Builtin, Arc::new(table));
        // A built-in model that cannot be loaded is left out; a test checks their number.
        tables().into_iter().flat_map(load).collect()
    });
    &MODELS
}

/// The table of a model's crate, with the fit only in programs that fit: otherwise nothing links it, nor what it computes with.
macro_rules! model {
    ($model:ident) => {{
        #[cfg(feature = "fit")]
        static TABLE: &ModelTable = &$model::TABLE;
        #[cfg(not(feature = "fit"))]
        static TABLE: &ModelTable = &ModelTable {
            fit: without_fits,
            ..$model::TABLE
        };
        TableModel::new(TABLE, Some(&$model::VOICES))
    }};
    ($model:ident, knobs) => {{
        let model = model!($model);
        #[cfg(feature = "fit")]
        let model = model.with_knobs(&$model::KNOBS);
        model
    }};
}

/// The models. One that is added here is in every program that links this crate. Without `knobs` a sweep spans the ranges of its
/// options.
fn tables() -> Vec<TableModel> {
    vec![
        model!(htex_ar, knobs),
        model!(htex_mfcc, knobs),
        model!(htex_speak, knobs),
        model!(htex_sbeta, knobs),
        model!(htex_sslope, knobs),
        model!(htex_bands, knobs),
    ]
}

#[cfg(test)]
#[test]
fn every_model_is_loaded() {
    assert_eq!(models().len(), tables().len());
}

/// A fit that fails.
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
