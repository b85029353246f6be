//! A grid of conditions from recordings in which speed and force change freely.
//!
//! Recordings are cut into windows of 0.2 s; those with nearly constant speed and force (`steady`) are gathered in cells
//! around the crossings of grid lines (`lines`, `cells`), and each cell with enough windows becomes a condition. Small
//! differences between the windows' motions and the crossing are corrected: windows are read over equal paths (`paths`),
//! and their energies by the texture's own dependence on speed and force (`slopes`). Lines of speed are as dense as
//! interpolating between them needs (`blur`). A player interpolates in the Delaunay mesh of the conditions, as in the Penn Haptic Texture Toolkit
//! (Culbertson, Unwin and Kuchenbecker 2014), which fits segments of nearly constant motion and places the models in the
//! plane of speed and force. `leave_out` measures that interpolation without a known truth.

mod blur;
mod cells;
mod leave_out;
mod lines;
mod paths;
mod report;
mod request;
mod slopes;
mod steady;

use htex_dsp::Band;
use htex_dsp::spectrum::Complex;
use htex_format::{Condition, Quantity};
use htex_host::FitCondition;

pub(crate) use leave_out::left_out;
pub use report::{CellStatus, GridCell, GridReport};
pub use request::Grid;

use crate::blocks::Span;
use crate::conditions::{Group, Grouped, four_digits};
use crate::recording_finding::RecordingFinding;
use crate::take::source_of;
use crate::warnings::Warnings;
use crate::{AuthorError, SpectrumOptions, Take, TextureSpectrum};
use cells::{Cell, are_full, gather};
use lines::{Lines, SPEED_RATIOS};
use paths::{Paths, Window};
use steady::{Steady, read_steady};

/// Error of the interpolation between lines of speed above which more lines are tried, decibels.
const BLURRED_DB: f64 = 1.0;

/// Cells and their spectra, for one choice of lines.
struct Gathered {
    lines: Lines,
    cells: Vec<Cell>,
    spectra: Vec<Option<TextureSpectrum>>,
}

/// Takes the spectra of the recordings' steady windows and averages those of each cell.
pub(crate) fn group_grid(
    takes: &[Take],
    grid: &Grid,
    options: &SpectrumOptions,
    strict: bool,
) -> Result<(Grouped, GridReport), AuthorError> {
    let (mut warnings, mut notes) = (Warnings::default(), Warnings::default());
    let (mut all, mut sources) = (Vec::<Steady>::new(), Vec::new());
    let mut findings = Vec::new();
    for (index, take) in takes.iter().enumerate() {
        let mut steady = read_steady(index, take, options, strict)?;
        let source = &take.recording.source;
        warnings.add(source, std::mem::take(&mut steady.warnings));
        notes.add(source, std::mem::take(&mut steady.notes));
        findings.extend(RecordingFinding::all(
            source,
            std::mem::take(&mut steady.findings),
        ));
        sources.push(source_of(take, steady.windows.len()));
        all.push(steady);
    }
    let kind = same_kind(&all)?;
    let looked_at = all.iter().map(|steady| steady.looked_at).sum();
    let windows: Vec<Window> = all.into_iter().flat_map(|steady| steady.windows).collect();
    let gathered = gather_densest(takes, grid, options, &windows, kind)?;
    let motions: Vec<[f64; 2]> = windows.iter().map(|window| window.motion).collect();
    let mut report = GridReport::new(looked_at, &motions, &gathered.lines);
    let mut grouped = Grouped {
        groups: Vec::new(),
        conditions: Vec::new(),
        sources,
        warnings: warnings.into_notices(),
        notes: notes.into_notices(),
        findings,
    };
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
        grouped.groups.push(Group {
            spectrum,
            condition,
        });
    }
    if grouped.groups.is_empty() {
        return Err(AuthorError::GridEmpty {
            segments: windows.len(),
            needed: lines::FEWEST,
            motion: report.motion_text(),
        });
    }
    report.add_mesh(&grouped.conditions);
    Ok((grouped, report))
}

/// Gathers windows around the given lines, or around chosen ones: more and more lines of speed, until interpolating between
/// them costs little, or the windows are too few for more.
fn gather_densest(
    takes: &[Take],
    grid: &Grid,
    options: &SpectrumOptions,
    windows: &[Window],
    (quantity, band): (Quantity, Band),
) -> Result<Gathered, AuthorError> {
    let motions: Vec<[f64; 2]> = windows.iter().map(|window| window.motion).collect();
    let mut paths = Paths::new(takes, options, band);
    let mut best = None;
    for ratio in SPEED_RATIOS {
        let lines = Lines::choose(grid, &motions, ratio)?;
        let cells = gather(&lines, &motions);
        if best.is_some() && !are_full(&cells) {
            break;
        }
        let mut spectra = Vec::with_capacity(cells.len());
        for cell in &cells {
            let Some(used) = cell.used() else {
                spectra.push(None);
                continue;
            };
            let corrected = slopes::corrected(&mut paths, windows, cell, &used, band)?;
            let corrected: Vec<&[Complex<f64>]> = corrected.iter().map(Vec::as_slice).collect();
            let spans: Vec<Span> = used
                .iter()
                .map(|i| paths.span(&windows[*i], cell.at[0]))
                .collect();
            let spectrum =
                TextureSpectrum::of(quantity, band, &corrected, &spans, options.averaging);
            spectra.push(Some(spectrum));
        }
        let error_db = blur::error_db(&lines, &spectra);
        best = Some(Gathered {
            lines,
            cells,
            spectra,
        });
        let is_sharp = error_db.is_none_or(|error_db| error_db <= BLURRED_DB);
        if is_sharp || grid.speed_mm_s.is_some() {
            break;
        }
    }
    best.ok_or(AuthorError::NoSegments {
        source_name: String::new(),
    })
}

/// Returns speed and force of a cell's crossing, to four digits.
fn fit_condition(cell: &Cell) -> FitCondition {
    let [speed, force] = cell.at.map(|log| four_digits(libm::exp(log)));
    FitCondition {
        speed_mm_s: Some(speed),
        force_n: Some(force),
    }
}

/// Returns quantity and band of all recordings, which must be the same.
fn same_kind(all: &[Steady]) -> Result<(Quantity, Band), AuthorError> {
    let first = all.first().ok_or(AuthorError::NoSegments {
        source_name: String::new(),
    })?;
    if all.iter().any(|one| one.quantity != first.quantity) {
        return Err(AuthorError::QuantitiesDiffer);
    }
    if all.iter().any(|one| one.band != first.band) {
        return Err(AuthorError::BandsDiffer);
    }
    Ok((first.quantity, first.band))
}
