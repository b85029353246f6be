//! Reading of CSV tables with the places of their fields.

use std::collections::BTreeMap;

use htex_format::{Finding, Findings, Rule, plain};

use super::rules::{
    TABLE_COLUMN_DUPLICATE, TABLE_COLUMN_MISSING, TABLE_EMPTY, TABLE_FIELDS, TABLE_NAME_EMPTY,
    TABLE_NOT_UTF8, TABLE_TOO_LARGE,
};

/// Largest file that is read, bytes.
const LARGEST: usize = 256 << 20;

/// A table that was read, and what was found in it: no error.
#[derive(Debug, Clone, PartialEq)]
pub struct Checked<T> {
    /// The table.
    pub table: T,
    /// Warnings and information.
    pub findings: Vec<Finding>,
}

/// A table that cannot be analysed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("the table has errors:{}", lines(.findings))]
pub struct Invalid {
    /// All findings; at least one is an error.
    pub findings: Vec<Finding>,
}

fn lines(findings: &[Finding]) -> String {
    findings
        .iter()
        .map(|f| format!("\n  {} {f}", f.severity))
        .collect()
}

/// A table as text.
pub(super) struct Sheet {
    columns: BTreeMap<String, usize>,
    names: Vec<String>,
    pub(super) rows: Vec<Row>,
}

/// A line of a table.
pub(super) struct Row {
    /// Its number in the file, from 1.
    pub(super) line: u64,
    fields: Vec<String>,
}

impl Row {
    /// The field in a column by its index.
    pub(super) fn field(&self, column: usize) -> &str {
        self.fields.get(column).map_or("", |field| field.as_str())
    }
}

impl Sheet {
    /// Reads a table that needs the columns `needed`. Names are trimmed and compared in lower case.
    pub(super) fn read(bytes: &[u8], needed: &[&str]) -> Result<Self, Invalid> {
        let mut findings = Findings::default();
        let Some(text) = text(bytes, &mut findings) else {
            return Err(invalid(findings));
        };
        let mut rows = records(text, &mut findings);
        if rows.len() < 2 {
            let message = "there is no line after the header".to_owned();
            findings.add(TABLE_EMPTY, "", message);
            return Err(invalid(findings));
        }
        let header = rows.remove(0);
        let names: Vec<String> = header
            .fields
            .iter()
            .map(|name| name.to_lowercase())
            .collect();
        let columns = index(&header, &names, needed, &mut findings);
        for row in &rows {
            check_length(row, names.len(), &mut findings);
        }
        if findings.has_errors() {
            return Err(invalid(findings));
        }
        Ok(Self {
            columns,
            names,
            rows,
        })
    }

    /// The names of the columns, in their order.
    pub(super) fn names(&self) -> &[String] {
        &self.names
    }

    /// The index of a column, if there is one.
    pub(super) fn column(&self, name: &str) -> Option<usize> {
        self.columns.get(name).copied()
    }

    /// Ends the reading: the findings so far are an error or go with the table.
    pub(super) fn finish<T>(findings: Findings, table: T) -> Result<Checked<T>, Invalid> {
        if findings.has_errors() {
            return Err(invalid(findings));
        }
        let findings = findings.into_list();
        Ok(Checked { table, findings })
    }
}

pub(super) fn invalid(findings: Findings) -> Invalid {
    Invalid {
        findings: findings.into_list(),
    }
}

/// A finding about a field.
pub(super) fn at(
    findings: &mut Findings,
    rule: &Rule,
    line: u64,
    (index, column): (usize, &str),
    message: &str,
) {
    let pointer = format!("/{line}/{}", column.replace('~', "~0").replace('/', "~1"));
    let place = format!("line {line}, column {} (`{}`)", index + 1, plain(column));
    findings.add(rule, pointer, format!("{place}: {message}"));
}

/// Returns a name out of a table; an empty one is a finding.
pub(super) fn name(row: &Row, (index, column): (usize, &str), findings: &mut Findings) -> String {
    let name = row.field(index);
    if name.is_empty() {
        at(
            findings,
            TABLE_NAME_EMPTY,
            row.line,
            (index, column),
            "it is empty; fill it in, or remove the line",
        );
    }
    name.to_owned()
}

fn text<'b>(bytes: &'b [u8], findings: &mut Findings) -> Option<&'b str> {
    if bytes.len() > LARGEST {
        let message = format!("it has {} bytes, and {LARGEST} are the limit", bytes.len());
        findings.add(TABLE_TOO_LARGE, "", message);
        return None;
    }
    match std::str::from_utf8(bytes) {
        Ok(text) => Some(text.strip_prefix('\u{feff}').unwrap_or(text)),
        Err(error) => {
            let before = &bytes[..error.valid_up_to()];
            let line = 1 + before.iter().filter(|byte| **byte == b'\n').count();
            let message = format!("line {line}: a byte is not UTF-8");
            findings.add(TABLE_NOT_UTF8, format!("/{line}"), message);
            None
        }
    }
}

fn records(text: &str, findings: &mut Findings) -> Vec<Row> {
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .trim(csv::Trim::All)
        .from_reader(text.as_bytes());
    let mut rows = Vec::new();
    for record in reader.records() {
        match record {
            Ok(record) => rows.push(Row {
                line: record.position().map_or(0, csv::Position::line),
                fields: record.iter().map(str::to_owned).collect(),
            }),
            // Text in memory has no errors of input, and lines of any length are allowed.
            Err(error) => findings.add(TABLE_FIELDS, "", error.to_string()),
        }
    }
    rows.retain(|row| row.fields.iter().any(|field| !field.is_empty()));
    rows
}

/// Finds the columns by name.
fn index(
    header: &Row,
    names: &[String],
    needed: &[&str],
    findings: &mut Findings,
) -> BTreeMap<String, usize> {
    let mut columns = BTreeMap::new();
    for (index, name) in names.iter().enumerate() {
        let earlier = columns.insert(name.clone(), index);
        if let Some(earlier) = earlier.filter(|_| !name.is_empty()) {
            let message = format!("column {} has this name, too", earlier + 1);
            let place = (index, &name[..]);
            at(
                findings,
                TABLE_COLUMN_DUPLICATE,
                header.line,
                place,
                &message,
            );
        }
    }
    for name in needed.iter().filter(|name| !columns.contains_key(**name)) {
        let found = plain(&names.join(", ")).into_owned();
        let found = found.chars().take(200).collect::<String>();
        let message = format!(
            "line {}: there is no column `{name}`; needed are {}, and there are: {found}",
            header.line,
            needed.join(", ")
        );
        findings.add(
            TABLE_COLUMN_MISSING,
            format!("/{}/{name}", header.line),
            message,
        );
    }
    columns
}

fn check_length(row: &Row, columns: usize, findings: &mut Findings) {
    let found = row.fields.len();
    let pointer = format!("/{}", row.line);
    findings.require(found == columns, TABLE_FIELDS, pointer, || {
        let line = row.line;
        format!("line {line}: it has {found} fields, and the header has {columns}")
    });
}
