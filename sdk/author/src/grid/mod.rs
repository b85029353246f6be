//! A grid of conditions, from recordings in which speed and force change freely.
//!
//! Recordings are cut into windows of 0.2 s. Windows with nearly constant speed and force
//! (`steady`) are gathered in cells around the crossings of grid lines (`lines`, `cells`), and each
//! cell with enough windows becomes a condition. Small differences between a window's motion and
//! the crossing are corrected: windows are read over equal paths (`paths`), and their energies are
//! corrected by the texture's own dependence on speed and force (`slopes`). The number of speed
//! lines is the one that best predicts blocks of time that were left out (`folds`, `held_out`,
//! `search`). A player interpolates in the Delaunay mesh of the conditions, as in the Penn Haptic
//! Texture Toolkit (Culbertson, Unwin and Kuchenbecker 2014), which fits segments of nearly
//! constant motion and places the models in the plane of speed and force. `leave_out` measures the
//! error of what a player makes of the conditions with a model, without knowing the true texture.

mod cells;
mod folds;
mod held_out;
mod leave_out;
mod lines;
mod paths;
mod played;
mod report;
mod request;
mod search;
mod slopes;
mod steady;

use htex_base::finding::{Findings, Notice};
use htex_dsp::Band;
use htex_format::{Condition, Contact, Quantity};
use htex_host::FitCondition;

pub(crate) use held_out::LeftOutBlock;
pub(crate) use leave_out::left_out;
pub use report::{CellStatus, GridCell, GridReport};
pub use request::Grid;

use crate::conditions::{Group, Grouped, four_digits};
use crate::findings::GRID_NOT_BETTER;
use crate::recording_finding::RecordingFinding;
use crate::take::source_of;
use crate::warnings::Warnings;
use crate::{AuthorError, SpectrumOptions, Take};
use cells::Cell;
use held_out::Kind;
use paths::Window;
use search::{Search, Searched};
use steady::{Steady, read_steady};

/// The conditions of a grid.
pub(crate) struct Gridded {
    pub(crate) grouped: Grouped,
    pub(crate) report: GridReport,
    /// The grid fitted without each block of time, for the models' held-out errors.
    pub(crate) left_out: Vec<LeftOutBlock>,
}

/// Computes the spectra of the recordings' steady windows and averages them cell by cell.
pub(crate) fn group_grid(
    takes: &[Take],
    grid: &Grid,
    options: &SpectrumOptions,
    strict: bool,
    contact: Contact,
) -> Result<Gridded, AuthorError> {
    let (mut warnings, mut notes) = (Warnings::default(), Warnings::default());
    let (mut all, mut sources) = (Vec::<Steady>::new(), Vec::new());
    let mut findings = Vec::new();
    for (index, take) in takes.iter().enumerate() {
        let mut steady = read_steady(index, take, options, strict)?;
        let source = &take.recording.source;
        warnings.add(source, std::mem::take(&mut steady.warnings));
        notes.add(source, std::mem::take(&mut steady.notes));
        findings.extend(RecordingFinding::all(source, std::mem::take(&mut steady.findings)));
        sources.push(source_of(take, steady.windows.len()));
        all.push(steady);
    }
    let (quantity, band) = same_kind(&all)?;
    let kind = Kind { quantity, band, averaging: options.averaging, contact };
    let looked_at = all.iter().map(|steady| steady.looked_at).sum();
    let windows: Vec<Window> = all.into_iter().flat_map(|steady| steady.windows).collect();
    let searched = Search::new(takes, options, &windows, kind).best(grid)?;
    let mut report = GridReport::new(looked_at, &windows, &searched);
    let mut grouped = Grouped {
        groups: Vec::new(),
        conditions: Vec::new(),
        sources,
        warnings: warnings.into_notices(),
        notes: notes.into_notices(),
        findings,
    };
    let Searched { gathered, left_out, .. } = searched;
    for (cell, spectrum) in gathered.cells.iter().zip(gathered.spectra) {
        let Some(spectrum) = spectrum else {
            report.add_thin(cell);
            continue;
        };
        report.add_fitted(cell, &spectrum, grouped.groups.len());
        let condition = fit_condition(cell);
        grouped.conditions.push(Condition {
            speed_mm_s: condition.speed_mm_s,
            force_n: condition.force_n,
            repeatability_rms_db: spectrum.repeatability_rms_db,
            segments: Some(spectrum.segments as u64),
        });
        grouped.groups.push(Group { spectrum, condition });
    }
    if grouped.groups.is_empty() {
        return Err(AuthorError::GridEmpty {
            segments: windows.len(),
            needed: lines::FEWEST,
            motion: report.motion_text(),
        });
    }
    report.add_mesh(&grouped.conditions);
    judge(&report, takes, &mut grouped);
    Ok(Gridded { grouped, report, left_out })
}

/// Adds a finding if a single condition predicts the left-out blocks as well as the grid does.
fn judge(report: &GridReport, takes: &[Take], grouped: &mut Grouped) {
    let (Some(grid_db), Some(one_db)) = (report.left_out_rms_db, report.one_condition_rms_db)
    else {
        return;
    };
    if one_db > grid_db {
        return;
    }
    let mut findings = Findings::default();
    let conditions = grouped.conditions.len();
    findings.add(
        GRID_NOT_BETTER,
        "",
        format!(
            "one condition for all motions predicts blocks of time that were left out within {one_db:.2} dB (third octaves, \
             RMS), the {conditions} conditions of the grid within {grid_db:.2} dB; fit without a grid, or record for longer"
        ),
    );
    let names: Vec<&str> = takes.iter().map(|t| t.recording.source.as_str()).collect();
    let name = names.join(", ");
    for finding in findings.into_list() {
        let text = format!("{name}: {}: {}", finding.code, finding.message);
        grouped.warnings.push(Notice::new(text, finding.hint));
        let found = RecordingFinding::all(&name, vec![finding]);
        grouped.findings.extend(found);
    }
}

/// Returns speed and force at a cell's crossing, to four digits.
fn fit_condition(cell: &Cell) -> FitCondition {
    let [speed, force] = cell.at.map(|log| four_digits(libm::exp(log)));
    FitCondition { speed_mm_s: Some(speed), force_n: Some(force) }
}

/// Returns the quantity and band of the recordings, which must be the same for all.
fn same_kind(all: &[Steady]) -> Result<(Quantity, Band), AuthorError> {
    let first = all.first().ok_or(AuthorError::NoSegments { source_name: String::new() })?;
    if all.iter().any(|one| one.quantity != first.quantity) {
        return Err(AuthorError::QuantitiesDiffer);
    }
    if all.iter().any(|one| one.band != first.band) {
        return Err(AuthorError::BandsDiffer);
    }
    Ok((first.quantity, first.band))
}
