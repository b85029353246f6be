//! Models linked into this program, called through their tables.

use htex_model::abi::ModelTable;

/// The tables of the built-in models, in the order in which they are shown.
pub(crate) fn tables() -> [&'static ModelTable; 6] {
    [
        &htex_ar::TABLE,
        &htex_mfcc::TABLE,
        &htex_speak::TABLE,
        &htex_sbeta::TABLE,
        &htex_sslope::TABLE,
        &htex_bands::TABLE,
    ]
}
