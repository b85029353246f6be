//! `spec/hard-cases.md`, generated from the table.

use std::fmt::Write as _;

use crate::{Case, Promise, sections};

const HEAD: &str = "\
# Hard cases

Generated from the table in `tests/hard/src/cases` by `cargo xtask generate`.

Inputs at which arithmetic breaks, and what is promised of each: a result that is finite and no farther
than a bound from a reference, or a refusal by name. *Exact* references are rational numbers without
rounding, *256 bits* is floating point of that length. An ulp is 2⁻⁵² of the number. The errors that a
machine measures are printed by `cargo test -p htex-hard-cases -- --nocapture`.
";

/// The page that lists every hard case: `spec/hard-cases.md`.
pub fn page() -> String {
    let mut page = HEAD.to_owned();
    for section in sections() {
        let _ = write!(
            page,
            "\n## {}\n\n{}\n\n| input | part | operation | promise |\n|---|---|---|---|\n",
            section.title, section.about
        );
        section.cases.iter().for_each(|case| row(&mut page, case));
    }
    page
}

fn row(page: &mut String, case: &Case) {
    let promise = match case.promise {
        Promise::Within { bound: 0.0, with, .. } => with.to_owned(),
        Promise::Within { bound, unit, with, .. } => {
            format!("{with} within {} {unit}", number(bound))
        }
        Promise::Refused { by, .. } => format!("refused: {by}"),
    };
    let _ =
        writeln!(page, "| {} | {} | {} | {} |", case.input, case.subject, case.operation, promise);
}

/// A number in its usual notation.
fn number(x: f64) -> String {
    if (1e-3..1e6).contains(&x) { format!("{x}") } else { format!("{x:e}") }
}
