//! Generates `spec/model-checks.md` from the table of checks.

use std::fmt::Write;

use crate::model::CHECKS;

const HEAD: &str = "\
# Checks of a model

Generated from the table of checks in `sdk/check/src/model/table.rs` by
`cargo xtask generate`.

`htex plugin check FILE` runs these on a native library or a WASM module, each in a separate
process. A check *passes*, ends with a *warning*, is *skipped* (it does not apply, or a check that
it needs did not pass), *fails*, *crashes* or is *timed-out*; after the last three the exit status is 1.
`--fuzz SECONDS` gives the check `fuzz` more time.
`htex plugin check --help` shows how to run one check in a single process, for a debugger.

| check | guarantee |
|---|---|
";

/// Returns the page that documents every check: `spec/model-checks.md`.
pub fn model_checks_page() -> String {
    let mut page = HEAD.to_owned();
    // Writing to a string cannot fail.
    for check in CHECKS {
        let _ = writeln!(page, "| {} | {} |", check.name, check.summary);
    }
    for check in CHECKS {
        let _ = write!(page, "\n## {}\n\n{}\n\n{}\n", check.name, check.summary, check.method);
        if !check.needs.is_empty() {
            let _ = writeln!(page, "\nNeeds: {}.", check.needs.join(", "));
        }
    }
    page
}
