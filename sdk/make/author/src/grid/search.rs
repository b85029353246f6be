//! Choice of a grid's lines: a grid with more lines is chosen only if it predicts the left-out
//! blocks of time better.

use htex_dsp::bands::rms;
use htex_format::Condition;

use super::cells::{Cell, are_full, gather};
use super::condition;
use super::folds::{Fold, folds};
use super::held_out::{
    HeldOutWindows, Kind, LeftOutBlock, averaged, errors_db, held_out_windows, rms_db,
};
use super::lines::Lines;
use super::paths::{Paths, Window};
use super::played::PlayedSpectra;
use super::request::Grid;
use super::slopes::{WindowSpectrum, corrected, read_around};
use crate::conditions::{ConditionSpectrum, four_digits};
use crate::findings::quantile;
use crate::law::law;
use crate::{AuthorError, SetupResponse, Take, TextureSpectrum};

/// Ratios of neighbouring speeds that are tried, from an octave down to a twelfth of an octave. A
/// player treats speeds that differ by at most 5 % as equal.
const SPEED_RATIOS: [f64; 5] = [2.0, 1.41, 1.19, 1.12, 1.06];
/// Left-out windows are gathered around lines whose neighbouring speeds have this ratio, so that
/// all grids are compared with the same windows. Denser lines are tried only if there are enough
/// windows for them.
const COMPARED_RATIO: f64 = 1.19;
/// A denser grid is chosen only if its error is smaller by this many decibels.
const WORTH_DB: f64 = 0.02;
/// A grid is compared with a single condition only if there are at least this many groups of
/// left-out windows.
const FEWEST_GROUPS: usize = 4;

/// The cells and their spectra for one choice of lines.
pub(super) struct CellSpectra {
    pub(super) lines: Lines,
    pub(super) cells: Vec<Cell>,
    pub(super) spectra: Vec<Option<TextureSpectrum>>,
    /// For each left-out block, the spectra of the cells without it.
    without: Vec<Vec<Option<TextureSpectrum>>>,
}

/// The chosen lines and their error.
pub(super) struct SearchResult {
    pub(super) gathered: CellSpectra,
    /// RMS difference in third octaves between left-out blocks and the spectra that are played for
    /// them, decibels.
    pub(super) left_out_rms_db: Option<f64>,
    /// The same error if a single condition is played at all motions.
    pub(super) one_condition_rms_db: Option<f64>,
    /// Two numbers, in decibels: how much the grid's error exceeds the error of a single condition,
    /// and half the width of the 95 % interval of this difference.
    pub(super) worse_db: Option<[f64; 2]>,
    pub(super) left_out: Vec<LeftOutBlock>,
}

/// The windows of the recordings from which grids are gathered.
pub(super) struct Search<'a> {
    paths: Paths<'a>,
    windows: &'a [Window],
    motions: Vec<[f64; 2]>,
    folds: Vec<Fold>,
    kind: Kind,
}

impl<'a> Search<'a> {
    pub(super) fn new(
        takes: &'a [Take],
        response: Option<&'a SetupResponse>,
        windows: &'a [Window],
        kind: Kind,
    ) -> Self {
        Self {
            paths: Paths::new(takes, response, kind.band),
            windows,
            motions: windows.iter().map(|window| window.motion).collect(),
            folds: folds(takes, windows).into(),
            kind,
        }
    }

    /// Gathers windows around the given lines. If no speeds are given, it chooses the speed lines
    /// that best predict left-out blocks. If there are also no left-out windows, the speed lines
    /// are a quarter of an octave apart.
    pub(super) fn best(mut self, grid: &Grid) -> Result<SearchResult, AuthorError> {
        let lines = Lines::choose(grid, &self.motions, COMPARED_RATIO)?;
        let all: Vec<usize> = (0..self.windows.len()).collect();
        let cells = gather(&lines, &self.motions, &all);
        // All candidates are compared with the same windows. If each candidate used its own cells,
        // denser grids would be compared with fewer and better placed windows.
        let compared = self.all_held_out(&cells)?;
        let one_condition = self.one_condition_db(&compared)?;
        let is_chosen = grid.speed_mm_s.is_none() && compared.iter().any(|held| !held.is_empty());
        let ratios = if is_chosen { &SPEED_RATIOS[..] } else { &[COMPARED_RATIO] };
        let mut best: Option<(CellSpectra, Vec<Vec<f64>>, f64)> = None;
        for ratio in ratios {
            let lines = Lines::choose(grid, &self.motions, *ratio)?;
            let cells = gather(&lines, &self.motions, &all);
            if *ratio < COMPARED_RATIO && !are_full(&cells) {
                break;
            }
            let gathered = self.gathered(lines, cells)?;
            let errors = self.errors_db(&gathered, &compared).unwrap_or_default();
            let error_db = rms_db(&errors).unwrap_or(f64::INFINITY);
            let least = best.as_ref().map(|(.., least)| least - WORTH_DB);
            if least.is_none_or(|least| error_db < least) {
                best = Some((gathered, errors, error_db));
            } else if *ratio < COMPARED_RATIO {
                // All coarse grids are tried, but the search for denser grids ends when a grid does
                // not reduce the error.
                break;
            }
        }
        let (gathered, errors, error_db) =
            best.ok_or(AuthorError::NoSegments { source_name: String::new() })?;
        Ok(SearchResult {
            left_out: self.left_out(&gathered)?,
            left_out_rms_db: Some(error_db).filter(|db| db.is_finite()),
            gathered,
            one_condition_rms_db: rms_db(&one_condition),
            worse_db: worse_db(&errors, &one_condition),
        })
    }

    /// Averages the left-out windows of each block, cell by cell.
    fn all_held_out(&mut self, cells: &[Cell]) -> Result<Vec<Vec<HeldOutWindows>>, AuthorError> {
        let (paths, windows, kind) = (&mut self.paths, self.windows, self.kind);
        let folds = self.folds.iter();
        folds.map(|fold| held_out_windows(paths, windows, fold, cells, kind)).collect()
    }

    /// Averages the windows of all cells: once over the whole time, and then for each block without
    /// this block.
    fn gathered(&mut self, lines: Lines, cells: Vec<Cell>) -> Result<CellSpectra, AuthorError> {
        let folds = self.folds.iter();
        let cells_without: Vec<Vec<Cell>> =
            folds.map(|fold| gather(&lines, &self.motions, &fold.known)).collect();
        let mut spectra = Vec::with_capacity(cells.len());
        let mut without: Vec<Vec<_>> = cells_without.iter().map(|_| Vec::new()).collect();
        for (i, cell) in cells.iter().enumerate() {
            // The windows are read only once, for all folds, because reading takes nearly all of
            // the time.
            let reads = read_around(&mut self.paths, self.windows, cell)?;
            spectra.push(self.spectrum(&reads, cell));
            for (cells, spectra) in cells_without.iter().zip(&mut without) {
                spectra.push(cells.get(i).and_then(|cell| self.spectrum(&reads, cell)));
            }
        }
        Ok(CellSpectra { lines, cells, spectra, without })
    }

    /// Averages the windows of a cell, corrected to its crossing; `None` if there are too few.
    fn spectrum(&self, reads: &[WindowSpectrum], cell: &Cell) -> Option<TextureSpectrum> {
        let used = cell.used()?;
        let kind = self.kind;
        let corrected = corrected(reads, cell, &used, kind.band);
        let spectra: Vec<_> = corrected.iter().map(Vec::as_slice).collect();
        let span = |i: &usize| self.paths.span(&self.windows[*i], cell.at[0]);
        let spans: Vec<_> = used.iter().map(span).collect();
        let (quantity, band) = (kind.quantity, kind.band);
        let averaging = kind.averaging;
        Some(TextureSpectrum::from_segments(quantity, band, &spectra, &spans, averaging))
    }

    /// Returns the error of a grid. For each block of time, a grid is made without the block, and
    /// the spectrum that is played from this grid is compared with the block.
    fn errors_db(
        &self,
        gathered: &CellSpectra,
        compared: &[Vec<HeldOutWindows>],
    ) -> Option<Vec<Vec<f64>>> {
        let mut errors = Vec::new();
        for (spectra, held) in gathered.without.iter().zip(compared) {
            let played = PlayedSpectra::new(gathered.conditions(spectra), self.kind.contact)?;
            errors.extend(errors_db(&played, held));
        }
        Some(errors)
    }

    /// Returns the error of a single condition for all motions: the mean of all windows, placed at
    /// their median motion.
    fn one_condition_db(
        &mut self,
        compared: &[Vec<HeldOutWindows>],
    ) -> Result<Vec<Vec<f64>>, AuthorError> {
        let mut errors = Vec::new();
        for (fold, held) in self.folds.iter().zip(compared) {
            let known = &fold.known;
            if known.is_empty() {
                errors.extend(held.iter().map(|_| Vec::new()));
                continue;
            }
            let spectrum = averaged(&mut self.paths, self.windows, known, None, self.kind)?;
            let median = |axis: usize| {
                quantile(0.5, known.len(), |i| self.motions[known[i]][axis]).map(libm::exp)
            };
            let condition = Condition {
                speed_mm_s: median(0).map(four_digits),
                force_n: median(1).map(four_digits),
                ..Condition::default()
            };
            let one = vec![ConditionSpectrum::new(condition, spectrum)];
            let played = PlayedSpectra::new(one, self.kind.contact);
            match played {
                Some(played) => errors.extend(errors_db(&played, held)),
                None => errors.extend(held.iter().map(|_| Vec::new())),
            }
        }
        Ok(errors)
    }

    /// For each block of time, returns the chosen grid fitted without this block, together with the
    /// block.
    fn left_out(&mut self, gathered: &CellSpectra) -> Result<Vec<LeftOutBlock>, AuthorError> {
        // The blocks are gathered again, because the blocks for models belong to the conditions of
        // the chosen lines.
        let all_held_out = self.all_held_out(&gathered.cells)?;
        let blocks = gathered.without.iter().zip(all_held_out);
        let block = |(spectra, held_out): (&Vec<Option<TextureSpectrum>>, _)| {
            let rest = gathered.conditions(spectra);
            let law = law(&rest, self.kind.contact);
            LeftOutBlock { rest, held_out: gathered.of_conditions(held_out), law }
        };
        Ok(blocks.map(block).collect())
    }
}

/// For each group of left-out windows, computes how much the error of a grid exceeds the error of a
/// single condition. Returns the mean of these differences, and half the width of its 95 %
/// interval. Returns `None` if there are fewer than four groups.
fn worse_db(grid: &[Vec<f64>], one: &[Vec<f64>]) -> Option<[f64; 2]> {
    let both = grid.iter().zip(one).filter(|(a, b)| !a.is_empty() && a.len() == b.len());
    let worse: Vec<f64> = both.map(|(a, b)| rms(a) - rms(b)).collect();
    let count = worse.len() as f64;
    let mean = worse.iter().sum::<f64>() / count;
    let square = worse.iter().map(|x| (x - mean).powi(2)).sum::<f64>();
    let error = (square / (count * (count - 1.0))).sqrt();
    (worse.len() >= FEWEST_GROUPS).then_some([mean, 1.96 * error])
}

impl CellSpectra {
    /// Returns the cells as conditions, but only those for which one of these spectra exists.
    fn conditions(&self, spectra: &[Option<TextureSpectrum>]) -> Vec<ConditionSpectrum> {
        let both = self.cells.iter().zip(spectra);
        let with = both.filter_map(|(cell, spectrum)| {
            Some(ConditionSpectrum::new(condition(cell), spectrum.clone()?))
        });
        with.collect()
    }

    /// Keeps only the left-out windows whose cell is a condition, and replaces the index of the
    /// cell by the index of the condition.
    fn of_conditions(&self, held_out: Vec<HeldOutWindows>) -> Vec<HeldOutWindows> {
        let is_fitted = |cell: usize| self.spectra.get(cell).is_some_and(Option::is_some);
        let before = |cell: usize| self.spectra.iter().take(cell).flatten().count();
        let fitted = held_out.into_iter().filter(|one| is_fitted(one.cell));
        fitted.map(|one| HeldOutWindows { cell: before(one.cell), ..one }).collect()
    }
}
