//! The result of a run: a matrix of classes and parts, the differences, and a badge.

use std::collections::BTreeMap;
use std::fmt::{self, Write as _};

use serde::Serialize;

use super::compare::Outcome;
use super::line::CommandLine;
use super::run::Options;
use super::tasks::Task;
use super::{Class, Part};

/// Maximum number of differences that the text lists.
const MOST_LISTED: usize = 50;

/// The result of running a reader on the conformance files.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Report {
    /// The command line of the reader.
    pub command: String,
    /// Whether the reader answered every question correctly.
    pub passed: bool,
    /// Number of runs.
    pub runs: usize,
    pub matrix: Matrix,
    pub differences: Vec<Difference>,
    /// Files that the runner left out: they need options, but the reader's command line has no
    /// `{options}`.
    pub left_out: Vec<Left>,
}

/// Counts by class and part.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Matrix {
    /// The columns of the matrix: the parts that have files.
    pub parts: Vec<Part>,
    pub rows: Vec<Row>,
}

/// The counts of a class.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    pub class: Class,
    /// The count of each part. Parts that do not concern the class are missing.
    pub counts: BTreeMap<Part, Count>,
}

/// Number of tests that passed, and number of all tests. A test is a file or, for a player, a
/// motion.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct Count {
    pub passed: usize,
    pub all: usize,
}

/// A file for which the reader's answer is wrong.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Difference {
    pub part: Part,
    pub file: String,
    /// The classes that fail because of the wrong answer.
    pub classes: Vec<Class>,
    /// States the reader's answer and the expected answer.
    pub message: String,
}

/// A file that the runner left out.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Left {
    pub part: Part,
    pub file: String,
}

impl fmt::Display for Count {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} of {}", self.passed, self.all)
    }
}

impl Report {
    pub(super) fn new(
        line: &CommandLine,
        options: &Options,
        tasks: &[Task],
        outcomes: Vec<Outcome>,
        left_out: &[Task],
    ) -> Self {
        let mut counts: BTreeMap<Class, BTreeMap<Part, Count>> = BTreeMap::new();
        let mut differences = Vec::new();
        let is_counted = |class: &Class| options.classes.contains(class);
        for (task, outcome) in tasks.iter().zip(outcomes) {
            for (class, passed, all) in outcome.counts {
                if is_counted(&class) {
                    let count = counts.entry(class).or_default().entry(task.part).or_default();
                    count.passed += passed;
                    count.all += all;
                }
            }
            for (classes, message) in outcome.wrong {
                let classes: Vec<Class> = classes.into_iter().filter(is_counted).collect();
                if !classes.is_empty() {
                    let file = task.name.clone();
                    differences.push(Difference { part: task.part, file, classes, message });
                }
            }
        }
        let parts = Part::ALL.into_iter().filter(|part| tasks.iter().any(|t| t.part == *part));
        let rows = counts.into_iter().map(|(class, counts)| Row { class, counts });
        let left_out =
            left_out.iter().map(|task| Left { part: task.part, file: task.name.clone() });
        Self {
            command: line.text().to_owned(),
            passed: differences.is_empty(),
            runs: tasks.len(),
            matrix: Matrix { parts: parts.collect(), rows: rows.collect() },
            differences,
            left_out: left_out.collect(),
        }
    }

    /// Returns the sums of the counts of all rows.
    pub fn total(&self) -> Count {
        let all = self.matrix.rows.iter().flat_map(|row| row.counts.values());
        all.fold(Count::default(), |sum, one| Count {
            passed: sum.passed + one.passed,
            all: sum.all + one.all,
        })
    }

    /// Returns the matrix and the differences as Markdown.
    pub fn to_markdown(&self) -> String {
        let names: String = self.matrix.parts.iter().map(|part| format!(" {part} |")).collect();
        let mut text =
            format!("| class |{names}\n|---|{}\n", "---|".repeat(self.matrix.parts.len()));
        for row in self.matrix.cells() {
            let _ = writeln!(text, "| {} |", row.join(" | "));
        }
        if !self.differences.is_empty() {
            text.push('\n');
        }
        for one in &self.differences {
            let place = format!("{}/{}", one.part.folder(), one.file).replace('`', "'");
            let message = one.message.replace('`', "'").replace(['\n', '\r'], " ");
            let _ = writeln!(text, "- `{place}`, {}: `{message}`", joined(&one.classes));
        }
        text
    }

    /// Returns a badge as SVG. The badge shows how many tests passed, and is green if all tests
    /// passed.
    pub fn to_badge(&self) -> String {
        let count = self.total();
        let right = if self.passed { format!("{} passed", count.all) } else { count.to_string() };
        let colour = if self.passed { "#2e7d32" } else { "#b71c1c" };
        let left = "htex conformance";
        // About the width of a character of 11 px; `textLength` makes it exact.
        let width = |text: &str| 7 * text.len();
        let (a, b) = (width(left), width(&right));
        let (start, total) = (a + 12, a + b + 24);
        format!(
            r##"<svg xmlns="http://www.w3.org/2000/svg" width="{total}" height="20" role="img" aria-label="{left}: {right}"><title>{left}: {right}</title><rect width="{start}" height="20" fill="#444"/><rect x="{start}" width="{rest}" height="20" fill="{colour}"/><g fill="#fff" font-family="Verdana,DejaVu Sans,sans-serif" font-size="11"><text x="6" y="14" textLength="{a}">{left}</text><text x="{text}" y="14" textLength="{b}">{right}</text></g></svg>
"##,
            rest = b + 12,
            text = start + 6,
        )
    }
}

impl Matrix {
    /// Returns the rows as texts: the class, then its count for each part.
    fn cells(&self) -> impl Iterator<Item = Vec<String>> {
        self.rows.iter().map(|row| {
            let count = |part| row.counts.get(part).map_or("–".to_owned(), Count::to_string);
            let counts = self.parts.iter().map(count);
            std::iter::once(row.class.to_string()).chain(counts).collect()
        })
    }
}

fn joined(classes: &[Class]) -> String {
    classes.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for one in self.differences.iter().take(MOST_LISTED) {
            let classes = joined(&one.classes);
            writeln!(f, "{}/{} ({classes}): {}", one.part.folder(), one.file, one.message)?;
        }
        if let more @ 1.. = self.differences.len().saturating_sub(MOST_LISTED) {
            writeln!(f, "and {more} more differences; --json lists all")?;
        }
        let head = std::iter::once("class".to_owned());
        let head = head.chain(self.matrix.parts.iter().map(ToString::to_string)).collect();
        let rows: Vec<Vec<String>> = std::iter::once(head).chain(self.matrix.cells()).collect();
        for row in &rows {
            for (column, cell) in row.iter().enumerate() {
                let width = rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
                let gap = if column + 1 < row.len() { width - cell.chars().count() + 2 } else { 0 };
                write!(f, "{cell}{}", " ".repeat(gap))?;
            }
            writeln!(f)?;
        }
        if !self.left_out.is_empty() {
            let count = self.left_out.len();
            writeln!(
                f,
                "{count} files are left out: the command has no {{options}} to tell limits"
            )?;
        }
        Ok(())
    }
}
