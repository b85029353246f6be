//! The lines of a table of ratings.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::RangeInclusive;

use htex_format::{Findings, plain};

use super::rules::{
    RATING_DUPLICATE, RATING_INVALID, RATING_OFF_SCALE, RATINGS_ATTRIBUTES,
    RATINGS_HIDDEN_REFERENCE, TABLE_COLUMN_UNKNOWN,
};
use super::sheet::{Invalid, Row, Sheet, at, invalid, name};

const COLUMNS: [&str; 5] = ["participant", "texture", "model", "repetition", "rating"];
/// Marks answers of simulated participants.
const SIMULATED: &str = "simulated";
/// Marks comparisons of the real texture with itself.
const HIDDEN_REFERENCE: &str = "hidden_reference";
/// What was rated.
const ATTRIBUTE: &str = "attribute";
/// Columns that studies export and no analysis needs.
const UNUSED: [&str; 2] = ["response_ms", "gain_db"];
/// Largest size of a rating; sums of squares of larger ones lose their digits.
const LARGEST_RATING: f64 = 1e9;

/// Participant, texture, model.
pub(super) type Cell = (String, String, String);
/// Ratings by condition, then repetition.
pub(super) type Answers = BTreeMap<Cell, BTreeMap<String, f64>>;

/// What the lines of a table say.
pub(super) struct Rated {
    pub(super) answers: Answers,
    /// Participants whose answers are simulated.
    pub(super) simulated: BTreeSet<String>,
}

/// Reads the lines of a table of ratings.
pub(super) fn read_answers(
    bytes: &[u8],
    scale: Option<&RangeInclusive<f64>>,
    findings: &mut Findings,
) -> Result<Rated, Invalid> {
    let sheet = Sheet::read(bytes, &COLUMNS)?;
    let columns = COLUMNS.map(|name| (sheet.column(name).unwrap_or_default(), name));
    let is_yes = |row: &Row, name: &str| {
        let mark = sheet.column(name).map_or("", |column| row.field(column));
        ["yes", "true", "1"].contains(&&mark.to_lowercase()[..])
    };
    name_unknown_columns(&sheet, findings);
    one_attribute(&sheet, findings);
    let (mut answers, mut simulated) = (Answers::new(), BTreeSet::new());
    let mut hidden = 0;
    for row in &sheet.rows {
        if is_yes(row, HIDDEN_REFERENCE) {
            hidden += 1;
            continue;
        }
        if is_yes(row, SIMULATED) {
            simulated.insert(row.field(columns[0].0).to_owned());
        }
        read_row(row, &columns, scale, &mut answers, findings);
    }
    findings.require(hidden == 0, RATINGS_HIDDEN_REFERENCE, "", || {
        format!("{hidden} lines are hidden references and are not analysed")
    });
    if findings.has_errors() {
        return Err(invalid(std::mem::take(findings)));
    }
    Ok(Rated { answers, simulated })
}

fn name_unknown_columns(sheet: &Sheet, findings: &mut Findings) {
    let known = [SIMULATED, HIDDEN_REFERENCE, ATTRIBUTE];
    for (index, name) in sheet.names().iter().enumerate() {
        let name = &name[..];
        if !COLUMNS.contains(&name) && !known.contains(&name) && !UNUSED.contains(&name) {
            let message = "it is not used";
            at(findings, TABLE_COLUMN_UNKNOWN, 1, (index, name), message);
        }
    }
}

fn one_attribute(sheet: &Sheet, findings: &mut Findings) {
    let Some(column) = sheet.column(ATTRIBUTE) else {
        return;
    };
    let first = sheet.rows.first().map_or("", |row| row.field(column));
    let other = sheet.rows.iter().find(|row| row.field(column) != first);
    if let Some(row) = other {
        let message = format!(
            "it is `{}`, and `{}` in the first line; keep the lines of one attribute",
            plain(row.field(column)),
            plain(first)
        );
        at(
            findings,
            RATINGS_ATTRIBUTES,
            row.line,
            (column, ATTRIBUTE),
            &message,
        );
    }
}

fn read_row(
    row: &Row,
    columns: &[(usize, &str); 5],
    scale: Option<&RangeInclusive<f64>>,
    answers: &mut Answers,
    findings: &mut Findings,
) {
    let [participant, texture, model, repetition, rating] = *columns;
    let cell = (
        name(row, participant, findings),
        name(row, texture, findings),
        name(row, model, findings),
    );
    let number = name(row, repetition, findings);
    let text = row.field(rating.0);
    let value = text
        .parse()
        .ok()
        .filter(|v: &f64| v.abs() <= LARGEST_RATING);
    let Some(value) = value else {
        let message = format!(
            "`{}` is not a number; correct it, or remove the line",
            plain(text)
        );
        at(findings, RATING_INVALID, row.line, rating, &message);
        return;
    };
    if let Some(scale) = scale.filter(|scale| !scale.contains(&value)) {
        let message = format!(
            "{value} is not on the scale from {} to {}; correct it, or remove the line",
            scale.start(),
            scale.end()
        );
        at(findings, RATING_OFF_SCALE, row.line, rating, &message);
    }
    if answers
        .entry(cell)
        .or_default()
        .insert(number, value)
        .is_some()
    {
        let message =
            "an earlier line rates the same participant, texture, model and repetition; remove one";
        at(findings, RATING_DUPLICATE, row.line, repetition, message);
    }
}
