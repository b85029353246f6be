//! A grid of conditions, made from recordings in which speed and force change freely.
//!
//! Recordings are cut into windows of 0.2 s. Windows with nearly constant speed and force
//! (`steady`) are gathered in cells around the crossings of grid lines (`lines`, `cells`). Each
//! cell with enough windows becomes a condition. In a window, the speed and force differ slightly
//! from the speed and force of the crossing. Two steps correct this difference. Each window's
//! length is changed so that the finger covers the same distance as in 0.2 s at the speed of the
//! grid line (`paths`). Each window's energies are corrected for the texture's measured dependence
//! on speed and force (`slopes`). The number of speed lines is chosen so that the grid best
//! predicts left-out blocks of time (`folds`, `held_out`, `search`).
//!
//! A player interpolates in the Delaunay mesh of the conditions. This method is from the Penn
//! Haptic Texture Toolkit (Culbertson, Unwin and Kuchenbecker 2014). The toolkit fits segments of
//! nearly constant motion and places the fitted models in the plane of speed and force. For each
//! model, `leave_out` compares each left-out block with the spectrum that a player would play in
//! place of the block. The error of this comparison can be measured without knowing the true
//! texture.

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

use htex_base::finding::Findings;
use htex_format::{Condition, Source};

pub(crate) use held_out::LeftOutBlock;
pub(crate) use leave_out::{left_out, left_out_rms};
pub use report::{CellStatus, GridCell, GridReport};
pub use request::Grid;

use crate::conditions::{
    ConditionSpectra, ConditionSpectrum, RecordingsReport, contact, four_digits,
};
use crate::findings::GRID_NOT_BETTER;
use crate::law::law;
use crate::take::{sentence, source_of};
use crate::{AuthorError, SpectrumOptions, Take};
use cells::Cell;
use held_out::Kind;
use paths::Window;
use search::{Search, SearchResult};
use steady::read_steady;

/// The conditions of a grid.
pub(crate) struct GridSpectra {
    pub(crate) conditions: ConditionSpectra,
    pub(crate) report: GridReport,
    /// The grid fitted without each block of time, for the models' held-out errors.
    pub(crate) left_out: Vec<LeftOutBlock>,
}

impl GridSpectra {
    /// Computes the spectra of the recordings' steady windows and averages them cell by cell. The
    /// windows are read from the recordings again, and are not taken from spectra of segments,
    /// because each window is read over a path whose length depends on the grid.
    pub(crate) fn new(
        takes: &[Take],
        grid: &Grid,
        options: &SpectrumOptions,
        strict: bool,
    ) -> Result<Self, AuthorError> {
        let contact = contact(takes.iter().map(|take| take.recording.simulated));
        let (mut windows, mut bands) = (Vec::<Window>::new(), Vec::new());
        let mut recordings = RecordingsReport::default();
        let mut looked_at = 0;
        for (index, take) in takes.iter().enumerate() {
            let recording = &take.recording;
            let steady = read_steady(index, take, options.response.as_ref(), strict)?;
            let source = source_of(recording, steady.windows.len());
            let source = Source { blake3: recording.file.blake3(), ..source };
            recordings.add(source, recording.simulated, steady.notices, steady.findings);
            looked_at += steady.looked_at;
            windows.extend(steady.windows);
            bands.push(steady.band);
        }
        let first = takes.first().zip(bands.first());
        let (first, band) = first.ok_or(AuthorError::NoSegments { source_name: String::new() })?;
        let quantity = first.recording.quantity;
        if takes.iter().any(|take| take.recording.quantity != quantity) {
            return Err(AuthorError::QuantitiesDiffer);
        }
        if bands.iter().any(|one| one != band) {
            return Err(AuthorError::BandsDiffer);
        }
        let kind = Kind { quantity, band: *band, averaging: options.averaging, contact };
        let response = options.response.as_ref();
        let found = Search::new(takes, response, &windows, kind).best(grid)?;
        let mut report = GridReport::new(looked_at, &windows, &found);
        let worse_db = found.worse_db;
        let SearchResult { gathered, left_out, .. } = found;
        let mut all = Vec::new();
        for (cell, spectrum) in gathered.cells.iter().zip(gathered.spectra) {
            let Some(spectrum) = spectrum else {
                report.add_thin(cell);
                continue;
            };
            report.add_fitted(cell, &spectrum, all.len());
            let condition =
                Condition { segments: Some(spectrum.segments as u64), ..condition(cell) };
            all.push(ConditionSpectrum::new(condition, spectrum));
        }
        if all.is_empty() {
            return Err(AuthorError::GridEmpty {
                segments: windows.len(),
                needed: lines::FEWEST,
                motion: report.motion_text(),
            });
        }
        report.add_mesh(&all);
        judge(&report, worse_db, takes, all.len(), &mut recordings);
        let law = law(&all, contact);
        Ok(Self {
            conditions: ConditionSpectra { all, contact, law, recordings },
            report,
            left_out,
        })
    }
}

/// Adds a finding if a single condition predicts the left-out blocks better than the grid does. The
/// 95 % interval of the difference must not include 0.
fn judge(
    report: &GridReport,
    worse_db: Option<[f64; 2]>,
    takes: &[Take],
    conditions: usize,
    recordings: &mut RecordingsReport,
) {
    let (Some(grid_db), Some(one_db)) = (report.left_out_rms_db, report.one_condition_rms_db)
    else {
        return;
    };
    let Some([worse_db, half_db]) = worse_db.filter(|[mean, half]| mean > half) else {
        return;
    };
    let mut findings = Findings::default();
    findings.add(
        GRID_NOT_BETTER,
        "",
        format!(
            "one condition for all motions predicts blocks of time that were left out within {one_db:.2} dB (third octaves, \
             RMS), the {conditions} conditions of the grid within {grid_db:.2} dB; the grid is worse by {worse_db:.2} ± {half_db:.2} dB; \
             fit without a grid, or record for longer"
        ),
    );
    let names: Vec<&str> = takes.iter().map(|t| t.recording.source.as_str()).collect();
    let (name, findings) = (names.join(", "), findings.into_list());
    recordings.warnings.add(&name, findings.iter().map(|f| sentence(&name, f)).collect());
    recordings.add_findings(&name, findings);
}

/// Returns a condition with the speed and force of a cell's crossing, rounded to four digits.
fn condition(cell: &Cell) -> Condition {
    let [speed, force] = cell.at.map(|log| Some(four_digits(libm::exp(log))));
    Condition { speed_mm_s: speed, force_n: force, ..Condition::default() }
}
