//! Generator of `spec/recording-findings.md` from the table of rules.

use htex_finding::rules_page;

use super::{RULES, levels, plausible, quantile, segments, spikes, stuck};
use crate::exploration;

const HEAD: &str = "\
# Findings in recordings

Generated from the table of rules in `sdk/recording/src/rules.rs` by
`cargo xtask generate`.

`htex validate rec.csv` checks a recording (any file that is neither an asset nor a scene); `htex fit`, `process`,
`compare` and `tradeoff` print the same findings as warnings and notes, and a strict reading refuses a recording with
an error or a warning. `htex explain CODE` names the flags that set what a remedy describes.

A finding has a code, a severity, a JSON pointer and a message. The pointer is into the recording as an object of
arrays, one per signal in use, named by its role: `time`, `lateral` (or `lateral_x` and `lateral_y`), `normal`, `speed`.
`/lateral/1200` is the first affected sample, counted from 0 in the file; a pointer to a whole signal has no number, and
the pointer to the whole recording is empty. Times in messages are the sample's number over the rate. Findings are in
this order: the clock's, each lateral axis', the normal force's, friction, speed, segments, notes. A recording is valid
when no finding is an error. The meaning of a code never changes.

The findings explain two definitions. The condition's speed and force are the **median** over the
segments that are read, so that a few outliers do not change them. The rate of a time column is the
number of steps over the time they take, `(n - 1) / span`. In an otherwise even time column, steps of more than
1.5 medians are gaps and are left out.

`recording-conformance/` has a recording for every code, with its expected report.
";

/// Generates the page of all rules for recordings: `spec/recording-findings.md`.
pub fn findings_page() -> String {
    let definitions = [
        quantile::definition(),
        "\n".to_owned(),
        htex_recording::clock_definition(),
        levels::definition(),
        stuck::definition(),
        spikes::definition(),
        plausible::definition(),
        exploration::definition(),
        segments::definition(),
    ];
    rules_page(
        &format!(
            "{HEAD}\n## Thresholds\n\n{}\n## Codes\n",
            definitions.concat()
        ),
        RULES,
    )
}
