//! Results of fuzzing, as lines of a table.

use std::path::PathBuf;

/// Number of log lines that are shown with a finding.
const TOLD: usize = 12;

/// The head of the table.
pub(super) const HEAD: &str =
    "target            executions  per second  coverage    corpus  findings";

/// The result of running a target.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Outcome {
    target: String,
    executions: u64,
    per_second: u64,
    /// Number of edges in the program's control flow that were reached.
    coverage: u64,
    corpus: u64,
    /// The failing input, or the log if there is none.
    pub(super) finding: Option<PathBuf>,
    /// The last lines of the log.
    tail: String,
}

impl Outcome {
    /// Reads libFuzzer's log.
    pub(super) fn read(target: &str, log: &str, finding: Option<PathBuf>) -> Self {
        let status = log.lines().rev().find(|line| line.contains(" cov: ")).unwrap_or_default();
        let said = |line: &&str| line.contains("panicked at") || line.contains("ERROR:");
        let first = log.lines().position(|line| said(&line)).unwrap_or(0);
        let tail: Vec<&str> = log.lines().skip(first).take(TOLD).collect();
        Self {
            target: target.to_owned(),
            // The log of a run that was cut off has no `stat::` lines. The last status line then
            // has the numbers.
            executions: after(log, "stat::number_of_executed_units:")
                .or_else(|| number(status.trim_start_matches('#')))
                .unwrap_or(0),
            per_second: after(log, "stat::average_exec_per_sec:")
                .or_else(|| after(status, "exec/s:"))
                .unwrap_or(0),
            coverage: after(status, "cov:").unwrap_or(0),
            corpus: after(status, "corp:").unwrap_or(0),
            finding,
            tail: tail.join("\n"),
        }
    }

    pub(super) fn line(&self) -> String {
        let Self { target, executions, per_second, coverage, corpus, .. } = self;
        let findings = u8::from(self.finding.is_some());
        format!(
            "{target:<16}{executions:>12}{per_second:>12}{coverage:>10}{corpus:>10}{findings:>10}"
        )
    }
}

/// Returns the totals, and each finding with instructions.
pub(super) fn end(outcomes: &[Outcome]) -> String {
    let executions: u64 = outcomes.iter().map(|outcome| outcome.executions).sum();
    let found: Vec<&Outcome> = outcomes.iter().filter(|o| o.finding.is_some()).collect();
    let mut text = format!("{executions} executions, {} findings\n", found.len());
    for outcome in found {
        let Outcome { target, tail, .. } = outcome;
        let place = outcome.finding.clone().unwrap_or_default();
        let place = place.display();
        text += &format!(
            "\n{target}: {place}\n{tail}\n\
             When it is fixed, keep it as a regression: cp {place} tests/regressions/{target}/NAME,\n\
             with a NAME that describes the fault, and `cargo test -p htex-tests --test it regressions::`.\n"
        );
    }
    text
}

fn after(text: &str, word: &str) -> Option<u64> {
    number(text.rsplit_once(word)?.1.trim_start())
}

/// Returns the integer at the start of a text.
fn number(text: &str) -> Option<u64> {
    let end = text.find(|c: char| !c.is_ascii_digit()).unwrap_or(text.len());
    text[..end].parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    const LOG: &str = "\
INFO: Running with entropic power schedule
#2	INITED cov: 12 ft: 13 corp: 1/1b exec/s: 0 rss: 30Mb
#4096	pulse  cov: 345 ft: 400 corp: 17/1Kb lim: 8 exec/s: 2048 rss: 31Mb
thread '<unnamed>' panicked at src/x.rs:1:1:
sample[3] is NaN
";

    #[test]
    fn the_log_is_read_with_and_without_its_end() {
        let end = "stat::number_of_executed_units: 5000\nstat::average_exec_per_sec:     1000\n";
        let whole = Outcome::read("csv", &(LOG.to_owned() + end), None);
        assert_eq!(
            whole.line().split_whitespace().collect::<Vec<_>>(),
            ["csv", "5000", "1000", "345", "17", "0"]
        );
        let cut = Outcome::read("csv", LOG, Some("fuzz/artifacts/csv/crash-1".into()));
        assert_eq!(
            cut.line().split_whitespace().collect::<Vec<_>>(),
            ["csv", "4096", "2048", "345", "17", "1"]
        );
        let text = super::end(&[whole, cut]);
        for part in [
            "9096 executions, 1 findings",
            "sample[3] is NaN",
            "cp fuzz/artifacts/csv/crash-1 tests/regressions/csv/NAME",
        ] {
            assert!(text.contains(part), "{part} is not in {text}");
        }
    }
}
