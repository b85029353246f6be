//! The table of spectra: participant, texture, model, then a magnitude at 20, 25, ..., 1000 Hz.

use std::collections::{BTreeMap, BTreeSet};

use htex_dsp::Band;
use htex_format::{Findings, plain};

use super::answers::Cell;
use super::ratings::Ratings;
use super::rules::{
    SPECTRA_CELL_MISSING, SPECTRA_DUPLICATE, SPECTRA_GRID_INVALID, SPECTRA_MAGNITUDE_INVALID,
    SPECTRA_RECORDED_MISSING, SPECTRA_UNRATED,
};
use super::sheet::{Checked, Invalid, Row, Sheet, at, invalid, name};

const NAMES: [&str; 3] = ["participant", "texture", "model"];
const REPETITION: &str = "repetition";
/// The model of lines with the spectrum of the real texture.
const RECORDED: &str = "recorded";
const LARGEST: f64 = 1e9;

/// Spectra of a study: what each participant felt of each model, and the recorded spectrum of each texture.
#[derive(Debug, Clone, PartialEq)]
pub struct Spectra {
    /// By texture.
    recorded: Vec<Vec<f64>>,
    /// By participant, then texture, then model.
    felt: Vec<Vec<f64>>,
    sizes: [usize; 2],
}

/// Index and name of a column.
type Column<'s> = (usize, &'s str);
type Read = BTreeMap<Cell, BTreeMap<String, Vec<f64>>>;

impl Spectra {
    /// Reads and checks a table of spectra for the conditions of `ratings`. Lines whose model is `recorded` have the spectra of the real
    /// textures. Several lines of a condition need a column `repetition`; their magnitudes are averaged.
    ///
    /// # Errors
    /// Every finding of the table, if one of them is an error.
    pub fn read(bytes: &[u8], ratings: &Ratings) -> Result<Checked<Self>, Invalid> {
        let sheet = Sheet::read(bytes, &NAMES)?;
        let mut findings = Findings::default();
        let grid = grid_columns(&sheet, &mut findings);
        let names = NAMES.map(|name| (sheet.column(name).unwrap_or_default(), name));
        let repetition = sheet.column(REPETITION);
        let mut all = Read::new();
        if !findings.has_errors() {
            for row in &sheet.rows {
                let number = repetition.map_or("", |column| row.field(column)).to_owned();
                read_row(row, (&names, &grid), number, &mut all, &mut findings);
            }
        }
        if findings.has_errors() {
            return Err(invalid(findings));
        }
        let table = select(&all, ratings, &mut findings);
        Sheet::finish(findings, table)
    }

    /// The recorded spectrum of a texture: 197 magnitudes.
    pub fn recorded(&self, texture: usize) -> &[f64] {
        &self.recorded[texture]
    }

    /// The felt spectrum of a condition: 197 magnitudes.
    pub fn felt(&self, participant: usize, texture: usize, model: usize) -> &[f64] {
        let [textures, models] = self.sizes;
        &self.felt[(participant * textures + texture) * models + model]
    }
}

/// Finds the columns of the grid, in its order.
fn grid_columns<'s>(sheet: &'s Sheet, findings: &mut Findings) -> Vec<Column<'s>> {
    let is_name = |name: &str| NAMES.contains(&name) || name == REPETITION;
    let columns = sheet.names().iter().enumerate();
    let others = columns.filter(|(_, name)| !is_name(name));
    let mut found = BTreeMap::new();
    for (index, name) in others {
        let frequency = name
            .strip_suffix("hz")
            .unwrap_or(name)
            .trim()
            .parse::<f64>();
        let frequency = frequency
            .ok()
            .filter(|f| f.fract() == 0.0 && (0.0..1e6).contains(f));
        match frequency {
            Some(frequency) => drop(found.insert(frequency as u32, (index, &name[..]))),
            None => {
                let message = "it is no frequency in hertz";
                at(findings, SPECTRA_GRID_INVALID, 1, (index, name), message);
            }
        }
    }
    let grid = Band::TACTILE.grid_hz();
    let columns: Vec<_> = grid
        .iter()
        .filter_map(|f| found.get(&(*f as u32)).copied())
        .collect();
    if columns.len() != grid.len() || found.len() != grid.len() {
        let message = format!(
            "line 1: {} of {} frequencies are on the grid of {} from 20 to 1000 Hz in steps of 5",
            columns.len(),
            found.len(),
            grid.len()
        );
        findings.add(SPECTRA_GRID_INVALID, "/1", message);
    }
    columns
}

fn read_row(
    row: &Row,
    (names, grid): (&[Column<'_>; 3], &[Column<'_>]),
    repetition: String,
    all: &mut Read,
    findings: &mut Findings,
) {
    let [participant, texture, model] = names.map(|column| name(row, column, findings));
    let mut magnitudes = Vec::with_capacity(grid.len());
    for column in grid {
        let text = row.field(column.0);
        match text.parse::<f64>() {
            Ok(value) if (0.0..=LARGEST).contains(&value) => magnitudes.push(value),
            _ => {
                let message = format!(
                    "`{}` is not a number of at least 0; correct it, or remove the line",
                    plain(text)
                );
                at(
                    findings,
                    SPECTRA_MAGNITUDE_INVALID,
                    row.line,
                    *column,
                    &message,
                );
                return;
            }
        }
    }
    let participant = if model == RECORDED {
        RECORDED.to_owned()
    } else {
        participant
    };
    let cell = all.entry((participant, texture, model)).or_default();
    if cell.insert(repetition, magnitudes).is_some() {
        let message = "an earlier line has the same spectrum; remove one, or number them in a column `repetition`";
        at(findings, SPECTRA_DUPLICATE, row.line, names[0], message);
    }
}

/// Picks the spectra of the rated conditions.
fn select(all: &Read, ratings: &Ratings, findings: &mut Findings) -> Spectra {
    let mut used = BTreeSet::new();
    let mut take = |participant: &str, texture: &str, model: &str| {
        let cell = (participant.to_owned(), texture.to_owned(), model.to_owned());
        let found = all.get(&cell).map(average);
        used.insert(cell);
        found
    };
    let mut recorded = Vec::new();
    for texture in &ratings.textures {
        match take(RECORDED, texture, RECORDED) {
            Some(spectrum) => recorded.push(spectrum),
            None => {
                let message = format!(
                    "there is no recorded spectrum of texture {texture}; add a line with `recorded` as participant and as model"
                );
                findings.add(SPECTRA_RECORDED_MISSING, "", message);
            }
        }
    }
    let mut felt = Vec::new();
    for participant in &ratings.participants {
        for texture in &ratings.textures {
            for model in &ratings.models {
                match take(participant, texture, model) {
                    Some(spectrum) => felt.push(spectrum),
                    None => {
                        let message = format!(
                            "there is no spectrum that participant {participant} felt of model {model} in texture {texture}"
                        );
                        findings.add(SPECTRA_CELL_MISSING, "", message);
                    }
                }
            }
        }
    }
    for (participant, texture, model) in all.keys().filter(|cell| !used.contains(*cell)) {
        let message = format!(
            "the spectrum of participant {participant}, texture {texture}, model {model} has no rating"
        );
        findings.add(SPECTRA_UNRATED, "", message);
    }
    Spectra {
        recorded,
        felt,
        sizes: [ratings.textures.len(), ratings.models.len()],
    }
}

fn average(lines: &BTreeMap<String, Vec<f64>>) -> Vec<f64> {
    let bins = Band::TACTILE.bins();
    let mean = |bin: usize| {
        let sum: f64 = lines.values().filter_map(|line| line.get(bin)).sum();
        sum / lines.len() as f64
    };
    (0..bins).map(mean).collect()
}
