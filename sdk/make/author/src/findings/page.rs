//! Generator of `spec/recording-findings.md` from the table of rules.

use htex_base::finding::{colophon, rules_page};

use super::{
    RULES, band, coefficient, course, differing, levels, plausible, quantile, segments, spikes,
    stuck,
};
use crate::exploration;
use crate::segments::definition as chosen;

const HEAD: &str = "\
# Findings in recordings

`htex validate rec.csv` checks a recording (any file that is neither an asset nor a scene); `htex fit`, `process`,
`compare` and `tradeoff` print the same findings as warnings and notes, and a strict reading refuses a recording with
an error or a warning. `htex explain CODE` names the flags that set what a remedy describes.

A finding has a code, a severity, a JSON pointer and a message. The pointer is into the recording as an object of
arrays, one per signal in use, named by its role: `time`, `lateral` (or `lateral_x` and `lateral_y`), `normal`, `speed`.
`/lateral/1200` is the first affected sample, counted from 0 in the file; a pointer to a whole signal has no number, and
the pointer to the whole recording is empty. Times in messages are the sample's number over the rate. Findings are in
this order: the clock's, each lateral axis', the band's, the normal force's, friction, speed, segments (off their target, sweeps cut off, windows, uneven, unsteady), that the
recording is unusable, notes. `RECORDING_OFF_TARGET` points to the whole recording, `RECORDING_UNSTEADY` to `/speed` or `/normal`, friction to `/normal` if
implausible and to the first lateral axis if a coefficient. A recording is valid when no finding is an error. The meaning of a code never changes.

The findings explain two definitions. The condition's speed and force are the **median** over the
segments that are read, so that a few outliers do not change them. The rate of a time column is the
number of steps over the time they take, `(n - 1) / span`. In an otherwise even time column, steps of more than
1.5 medians are gaps and are left out.

`recording-conformance/` has a recording for every code, with its expected report; `arguments` are those of `htex validate`. Another reader SHOULD have the same
findings of the same codes, pointers and order, except `RECORDING_NOTED`, of which a reader has as many as it has assumptions. The files are CSV: lines that begin with `#` are comments,
the first other line names the columns. `t_s` is the time in seconds, `lateral_n` and `friction` are the lateral force, `fz_n` is the normal force, in newtons, and `speed_mm_s` is the
speed in mm/s; other columns are not used.
";

/// Generates `spec/recording-findings.md`: the page of all rules for recordings.
pub fn findings_page() -> String {
    let definitions = [
        chosen(),
        quantile::definition(),
        "\n".to_owned(),
        htex_recording::clock_definition(),
        levels::definition(),
        course::definition(),
        stuck::definition(),
        spikes::definition(),
        band::definition(),
        plausible::definition(),
        coefficient::definition(),
        exploration::definition(),
        segments::definition(),
        differing::definition(),
    ];
    let head = format!("{HEAD}\n## Thresholds\n\n{}\n## Codes\n", definitions.concat());
    rules_page(&head, RULES) + &colophon("sdk/make/recording/src/rules.rs")
}
