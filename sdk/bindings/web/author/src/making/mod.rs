//! The table of the functions that make textures, with the names by which JavaScript calls them.

mod bake;
mod describe;
#[cfg(feature = "import")]
mod export;
mod felt;
mod fit;
#[cfg(feature = "import")]
mod import;
mod libraries;
mod made;
mod models;
mod process;
mod progress;
mod recorded;
mod recordings;
mod refusal;
mod represented;
mod rights;
mod validate;

use crate::answer::Function;

pub(crate) const FUNCTIONS: &[(&str, Function)] = &[
    ("bake", bake::bake),
    ("columns", process::columns),
    ("edit", made::edit),
    ("explain", validate::explain),
    ("felt", felt::felt),
    ("fit", fit::fit),
    ("library", libraries::pack),
    ("make", made::make),
    ("mix", made::mix),
    ("models", models::models),
    ("process", process::process),
    ("recorded", recorded::recorded),
    ("rights", rights::rights),
    ("threshold", felt::threshold),
    ("validate", validate::validate),
];

/// Functions that make textures from files of other formats, and such files from textures.
#[cfg(feature = "import")]
pub(crate) const EXCHANGE: &[(&str, Function)] = &[
    ("asks", import::asks),
    ("export", export::export),
    ("formats", import::formats),
    ("import", import::import),
];

/// Program and version for the provenance of assets. It is the same text that the command writes.
const TOOL: &str = concat!("htex ", env!("CARGO_PKG_VERSION"));
