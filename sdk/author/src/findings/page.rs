//! `spec/recording-findings.md`, made from the table of rules.

use htex_format::rules_page;

use super::RULES;

const HEAD: &str = "\
# Findings in recordings

Generated from the table of rules in `sdk/author/src/findings/rules.rs` by
`cargo xtask generate`.

`htex validate rec.csv` looks at a recording (any file that is neither an asset nor a scene); `htex fit`, `process`,
`compare` and `tradeoff` print the same findings as warnings and notes, and with `--strict` refuse a recording that has
an error or a warning.

A finding has a code, a severity, a JSON pointer and a message. The pointer is into the recording as an object of
arrays, one a signal in use, named by its role: `time`, `lateral` (or `lateral_x` and `lateral_y`), `normal`, `speed`.
`/lateral/1200` is the first sample concerned, counted from 0 in the file; a signal as a whole has no number, and the
recording as a whole has the empty pointer. Seconds in messages are the sample's number over the rate. Findings stand in
this order: the clock's, each lateral axis', the normal force's, friction, speed, segments, notes. A recording is valid
when no finding is an error. Codes never change their meaning.

Two things that are measured follow from what is found here. The condition's speed and force are the **median** over the
segments that are read, so that a few readings that no finger makes do not move them. The rate of a time column is the
number of steps over the time they take, `(n - 1) / span`; only where the clock is even otherwise are steps of more than
1.5 medians gaps, which take no part.

`recording-conformance/` has a recording for every code, with its report beside it.
";

/// The page that explains every rule of recordings: `spec/recording-findings.md`.
pub fn findings_page() -> String {
    rules_page(HEAD, RULES)
}
