//! Models linked into this program, called through their tables.

use crate::table::TableModel;

/// The built-in models, in the order in which they are shown.
pub(crate) fn models() -> [TableModel; 6] {
    [
        TableModel::new(&htex_ar::TABLE, Some(&htex_ar::VOICES)),
        TableModel::new(&htex_mfcc::TABLE, Some(&htex_mfcc::VOICES)),
        TableModel::new(&htex_speak::TABLE, Some(&htex_speak::VOICES)),
        TableModel::new(&htex_sbeta::TABLE, Some(&htex_sbeta::VOICES)),
        TableModel::new(&htex_sslope::TABLE, Some(&htex_sslope::VOICES)),
        TableModel::new(&htex_bands::TABLE, Some(&htex_bands::VOICES)),
    ]
}
