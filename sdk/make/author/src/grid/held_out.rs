//! Prediction of left-out blocks of time. The error of this prediction is a measure of the grid's
//! error. This error can be computed even if the true texture is unknown.

use htex_dsp::Band;
use htex_dsp::bands::rms;
use htex_dsp::spectrum::Complex;
use htex_format::{Contact, Law, Quantity};

use super::cells::Cell;
use super::folds::Fold;
use super::paths::{Paths, Window};
use super::played::{PlayedSpectra, levels_db};
use crate::conditions::ConditionSpectrum;
use crate::{AuthorError, Averaging, TextureSpectrum};

/// The windows of a block are compared with a prediction only if there are at least this many.
const FEWEST: usize = 4;

/// The properties that all spectra of a grid have in common.
#[derive(Debug, Clone, Copy)]
pub(super) struct Kind {
    pub(super) quantity: Quantity,
    pub(super) band: Band,
    pub(super) averaging: Averaging,
    pub(super) contact: Contact,
}

/// The windows of a left-out block that lie inside one cell.
pub(crate) struct HeldOutWindows {
    /// Index of the cell; in a [`LeftOutBlock`], index of its condition.
    pub(crate) cell: usize,
    /// Mean speed in mm/s and mean force in N of these windows.
    pub(crate) motion: [f64; 2],
    pub(crate) spectrum: TextureSpectrum,
}

/// A grid fitted without one block of time, with the windows of that block.
pub(crate) struct LeftOutBlock {
    /// The conditions that are averaged without the block.
    pub(crate) rest: Vec<ConditionSpectrum>,
    pub(crate) held_out: Vec<HeldOutWindows>,
    /// The law of the conditions in `rest`.
    pub(crate) law: Law,
}

/// Averages the windows of a left-out block, cell by cell.
pub(super) fn held_out_windows(
    paths: &mut Paths<'_>,
    windows: &[Window],
    fold: &Fold,
    cells: &[Cell],
    kind: Kind,
) -> Result<Vec<HeldOutWindows>, AuthorError> {
    let mut all = Vec::new();
    for (index, cell) in cells.iter().enumerate() {
        let is_held = |i: &&usize| fold.held.binary_search(i).is_ok();
        let own: Vec<usize> = cell.own.iter().filter(is_held).copied().collect();
        if own.len() < FEWEST {
            continue;
        }
        let mean = |axis: usize| {
            own.iter().map(|i| windows[*i].motion[axis]).sum::<f64>() / own.len() as f64
        };
        let motion = [mean(0), mean(1)];
        all.push(HeldOutWindows {
            cell: index,
            motion: motion.map(libm::exp),
            spectrum: averaged(paths, windows, &own, Some(motion[0]), kind)?,
        });
    }
    Ok(all)
}

/// Averages windows. If the logarithm of a speed is given, each window is read over the path that a
/// finger at this speed covers in 0.2 s. Otherwise, it is read over its own 0.2 s.
pub(super) fn averaged(
    paths: &mut Paths<'_>,
    windows: &[Window],
    used: &[usize],
    log_speed: Option<f64>,
    kind: Kind,
) -> Result<TextureSpectrum, AuthorError> {
    let (mut spectra, mut spans) = (Vec::with_capacity(used.len()), Vec::new());
    for window in used.iter().map(|i| &windows[*i]) {
        let log_speed = log_speed.unwrap_or(window.motion[0]);
        spectra.push(paths.read(window, log_speed)?);
        spans.push(paths.span(window, log_speed));
    }
    let spectra: Vec<&[Complex<f64>]> = spectra.iter().map(Vec::as_slice).collect();
    let Kind { quantity, band, averaging, .. } = kind;
    Ok(TextureSpectrum::from_segments(quantity, band, &spectra, &spans, averaging))
}

/// Returns the differences between the played spectra and the spectra of left-out windows, in each
/// third octave, decibels: one list for each element of `held`.
pub(super) fn errors_db(played: &PlayedSpectra, held: &[HeldOutWindows]) -> Vec<Vec<f64>> {
    let errors = held.iter().map(|one| {
        let truth = levels_db(&one.spectrum, 1.0, 1.0);
        let played = played.third_octaves_db(one.motion);
        let errors = played.iter().zip(&truth).map(|(played, truth)| played - truth);
        errors.filter(|error| error.is_finite()).collect()
    });
    errors.collect()
}

/// Returns the RMS of errors in decibels; `None` if there are none.
pub(super) fn rms_db(errors: &[Vec<f64>]) -> Option<f64> {
    let all = errors.concat();
    (!all.is_empty()).then(|| rms(&all))
}
