//! Models linked into this program, called through their tables.

use std::sync::{Arc, LazyLock};

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

fn tables() -> [TableModel; 6] {
    [
        TableModel::new(&htex_ar::TABLE, Some(&htex_ar::VOICES)),
        TableModel::new(&htex_mfcc::TABLE, Some(&htex_mfcc::VOICES)),
        TableModel::new(&htex_speak::TABLE, Some(&htex_speak::VOICES)),
        TableModel::new(&htex_sbeta::TABLE, Some(&htex_sbeta::VOICES)),
        TableModel::new(&htex_sslope::TABLE, Some(&htex_sslope::VOICES)),
        TableModel::new(&htex_bands::TABLE, Some(&htex_bands::VOICES)),
    ]
}
