//! Checks of fits, and of the conversion of fitted parameters.

use htex_host::{Band, HostError, Status};
use htex_model::{Values, flatten};

use crate::harness::{CheckResult, Finding};
use crate::model::case::{Case, is_cannot_fit};
use crate::model::sets::stored;
use crate::model::signal::distance_db;
use crate::model::spectra::{HARD, REFERENCES};

/// If storing the parameters changes the spectrum by more than this (dB RMS), there is a warning.
const STORED_DB: f64 = 0.5;

/// Fits the five reference spectra.
pub(crate) fn reference(case: &Case) -> CheckResult {
    let mut fitted = 0;
    for reference in REFERENCES {
        let grid = Band::TACTILE.grid_hz();
        let spectrum: Vec<f64> = grid.into_iter().map(reference.curve).collect();
        let (first, again) = (case.fit(&spectrum), case.fit(&spectrum));
        let name = reference.name;
        match first {
            Ok(fit) if fit.level_rms <= 0.0 => {
                let message = format!("spectrum `{name}`: the level is {}", fit.level_rms);
                return Err(Finding::failed(message));
            }
            Ok(fit) if again != Ok(fit.clone()) => {
                let message = format!("spectrum `{name}`: a second fit returns other numbers");
                return Err(Finding::failed(message));
            }
            Ok(_) => fitted += 1,
            Err(error) if is_cannot_fit(&error) => {}
            Err(error) => return Err(Finding::failed(format!("spectrum `{name}`: {error}"))),
        }
    }
    let (all, found) = (REFERENCES.len(), f64::from(fitted));
    if fitted == 0 {
        return Err(Finding::failed("no reference spectrum is fitted"));
    }
    Ok(Finding::passed(format!("{fitted} of {all} reference spectra are fitted"))
        .with("fitted", found))
}

/// Fits degenerate spectra.
pub(crate) fn hard(case: &Case) -> CheckResult {
    let (mut fitted, mut refused) = (0.0, 0.0);
    let wide = Band::TACTILE.grid_hz();
    let two = Band { low_hz: 100.0, high_hz: 105.0 };
    for reference in HARD {
        let spectrum: Vec<f64> = wide.iter().map(|&f| (reference.curve)(f)).collect();
        match case.fit_in(Band::TACTILE, &wide, &spectrum) {
            Ok(_) => fitted += 1.0,
            Err(error) if is_cannot_fit(&error) => refused += 1.0,
            Err(error) => {
                let name = reference.name;
                return Err(Finding::failed(format!(
                    "spectrum `{name}`: {error}; it must be fitted, or refused with HTEX_CANNOT_FIT"
                )));
            }
        }
    }
    match case.fit_in(two, &[100.0, 105.0], &[0.01, 0.01]) {
        Err(HostError::Call { status: Status::InvalidArgument, .. }) => refused += 1.0,
        other => {
            let what = other.map_or_else(|e| e.to_string(), |_| "it is fitted".to_owned());
            return Err(Finding::failed(format!(
                "spectrum `two bins`: {what}; fewer than three bins must be refused with HTEX_INVALID_ARGUMENT"
            )));
        }
    }
    Ok(Finding::passed(format!("{fitted} are fitted, {refused} refused"))
        .with("fitted", fitted)
        .with("refused", refused))
}

/// Checks that parameters survive conversion to fields and back, and storage.
pub(crate) fn round_trip(case: &Case) -> CheckResult {
    let descriptor = case.model.descriptor();
    let mut worst: f64 = 0.0;
    for fitted in case.fitted()? {
        let wrong =
            |what: String| Finding::failed(format!("spectrum `{}`: {what}", fitted.reference));
        let values =
            Values::read(descriptor, &fitted.parameters).map_err(|e| wrong(e.to_string()))?;
        let lists: Vec<&[f64]> = (0..descriptor.fields.len()).map(|i| values.list(i)).collect();
        let before = case.magnitude(&fitted.parameters)?;
        if case.magnitude(&flatten(descriptor, &lists))? != before {
            return Err(wrong("flattened parameters have another magnitude".to_owned()));
        }
        let kept: Vec<Vec<f64>> =
            descriptor.fields.iter().zip(&lists).map(|(field, list)| stored(field, list)).collect();
        let kept: Vec<&[f64]> = kept.iter().map(Vec::as_slice).collect();
        let after = case
            .magnitude(&flatten(descriptor, &kept))
            .map_err(|e| wrong(format!("stored parameters are refused: {e}")))?;
        worst = worst.max(distance_db(&after, &before));
    }
    let message = format!("storage changes the spectrum by at most {worst:.3} dB RMS");
    let finding = if worst <= STORED_DB {
        Finding::passed(message)
    } else {
        Finding::warning(message + "; a store with smaller steps may be justified")
    };
    Ok(finding.with("stored_db", worst))
}

/// Fits spectra together with their signals.
pub(crate) fn with_signals(case: &Case) -> CheckResult {
    let sets = case.fitted_to_signals()?;
    for set in &sets {
        let magnitude = case.magnitude(&set.parameters);
        magnitude.map_err(|error| Finding::failed(format!("{}: {error}", set.name)))?;
    }
    let count = sets.len();
    Ok(Finding::passed(format!("{count} spectra with a signal are fitted"))
        .with("fitted", count as f64))
}
