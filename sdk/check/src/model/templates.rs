//! The project templates that `htex plugin new` writes for a new model. A template is a list of
//! files with their contents, which contain placeholders (`templates/README.md`).

/// A project in Rust: paths relative to the project's folder, and file contents.
pub const RUST: &[(&str, &str)] = &[
    ("README.md", include_str!("../../templates/rust/README.md.in")),
    ("Cargo.toml", include_str!("../../templates/rust/Cargo.toml.in")),
    ("src/lib.rs", include_str!("../../templates/rust/src/lib.rs")),
    ("src/follow.rs", include_str!("../../templates/rust/src/follow.rs")),
];

/// A project in C: paths relative to the project's folder, and file contents.
pub const C: &[(&str, &str)] = &[
    ("README.md", include_str!("../../templates/c/README.md.in")),
    ("model.c", include_str!("../../templates/c/model.c")),
    ("resonance.h", include_str!("../../templates/c/resonance.h")),
    ("build.sh", include_str!("../../templates/c/build.sh")),
    ("htex_model.h", include_str!("../../templates/include/htex_model.h")),
    ("htex_model_parts.h", include_str!("../../templates/include/htex_model_parts.h")),
    ("htex_model_wasm.h", include_str!("../../templates/include/htex_model_wasm.h")),
    ("htex_motion_1.h", include_str!("../../templates/include/htex_motion_1.h")),
];
