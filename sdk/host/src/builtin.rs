//! Models linked into this program, called through their tables.

use std::sync::{Arc, LazyLock};

use htex_model::abi::ModelTable;
use htex_model::motion_1::MotionTable;

use crate::table::TableModel;
use crate::{LoadedModel, Origin};

/// Returns the built-in models in their display order. They are loaded once.
pub(crate) fn models() -> &'static [LoadedModel] {
    static MODELS: LazyLock<Vec<LoadedModel>> = LazyLock::new(|| {
        let load = |table| LoadedModel::new(Origin::Builtin, Arc::new(table));
        // A built-in model that cannot be loaded is left out. A test checks the number of models.
        tables().into_iter().flat_map(load).collect()
    });
    &MODELS
}

/// The functions that render several voices of a model in one call, for large scenes. Web pages
/// have few voices and should not download these functions.
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

/// The table of a model's crate, with any of `knobs`, `usual` and `motion`. The fit is included
/// only in programs that fit. In other programs nothing refers to it, so the linker drops it with
/// everything it uses.
macro_rules! model {
    ($model:ident $(, $part:ident)*) => {{
        #[cfg(feature = "fit")]
        static TABLE: &ModelTable = &$model::TABLE;
        #[cfg(not(feature = "fit"))]
        static TABLE: &ModelTable = &ModelTable {
            fit: without_fits,
            ..$model::TABLE
        };
        let model = TableModel::new(TABLE, voices!($model));
        $(let model = part!(model, $model, $part);)*
        model
    }};
}

/// Adds one of these parts of its crate to a model.
macro_rules! part {
    ($table:ident, $model:ident, knobs) => {{
        #[cfg(feature = "fit")]
        let $table = $table.with_knobs(&$model::KNOBS);
        $table
    }};
    ($table:ident, $model:ident, usual) => {{
        #[cfg(feature = "fit")]
        let $table = $table.with_usual($model::USUAL);
        $table
    }};
    ($table:ident, $model:ident, motion) => {{
        #[cfg(feature = "fit")]
        static MOTION: &MotionTable = &$model::MOTION;
        #[cfg(not(feature = "fit"))]
        static MOTION: &MotionTable = &MotionTable { fit: without_fits_at, ..$model::MOTION };
        $table.with_motion(MOTION)
    }};
}

/// Lists the built-in models. A model that is added here is in every program that links this crate.
///
/// - `usual`: the ranges of its parameters' sliders, which a test requires.
/// - `knobs`: the values of its options in a sweep. Without them, a sweep spans the options'
///   ranges.
/// - `motion`: it has the extension `htex.motion/1`.
/// - `only_named`: it is fitted only if the user names it, and not chosen by default.
fn tables() -> Vec<TableModel> {
    vec![
        model!(htex_ar, knobs, usual),
        model!(htex_mfcc, knobs, usual),
        model!(htex_speak, knobs, usual),
        model!(htex_sbeta, knobs, usual),
        model!(htex_sslope, knobs, usual),
        model!(htex_bands, knobs, usual),
        model!(htex_arma, knobs, usual).only_named(),
        model!(htex_map, usual, motion).only_named(),
    ]
}

#[cfg(test)]
#[test]
fn every_model_is_loaded() {
    assert_eq!(models().len(), tables().len());
}

/// Each parameter of a model must have a usual range within the range that may be stored.
#[cfg(all(test, feature = "fit"))]
#[test]
fn usual_ranges_are_within_the_descriptors() {
    for model in models() {
        let usual = model.usual();
        for field in &model.descriptor().fields {
            let own = usual.iter().find(|usual| usual.field == field.name);
            let is_within = own.is_some_and(|own| {
                field.min <= own.min && own.min < own.max && own.max <= field.max
            });
            assert!(is_within, "{}.{}: {own:?}", model.id(), field.name);
            let starts = own.map_or(0.0, |own| own.min);
            let is_log = own.is_some_and(|own| own.scale == htex_model::Scale::Log);
            assert!(!is_log || starts > 0.0, "{}.{}", model.id(), field.name);
        }
        assert_eq!(usual.len(), model.descriptor().fields.len());
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

/// The [`without_fits`] of the extension `htex.motion/1`.
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
