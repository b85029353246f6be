//! Fits, and conversions of their parameters.

use htex_host::{Band, Field, Kind, Store};
use htex_model::{Values, flatten};

use crate::case::{Case, is_cannot_fit, is_refusal};
use crate::signal::distance_db;
use crate::spectra::{HARD, REFERENCES};
use htex_check_runner::{Finding, Found};

/// Change of a spectrum by storage above which there is a warning, dB RMS.
const STORED_DB: f64 = 0.5;

/// Fits the five reference spectra.
pub(crate) fn reference(case: &Case) -> Found {
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
    Ok(
        Finding::passed(format!("{fitted} of {all} reference spectra are fitted"))
            .with("fitted", found),
    )
}

/// Fits degenerate spectra.
pub(crate) fn hard(case: &Case) -> Found {
    let (mut fitted, mut refused) = (0.0, 0.0);
    let wide = Band::TACTILE.grid_hz();
    let two = Band {
        low_hz: 100.0,
        high_hz: 105.0,
    };
    let hard = HARD
        .iter()
        .map(|h| (h.name, Band::TACTILE, &wide[..], h.curve));
    let flat: fn(f64) -> f64 = |_| 0.01;
    for (name, band, grid, curve) in hard.chain([("two bins", two, &[100.0, 105.0][..], flat)]) {
        let spectrum: Vec<f64> = grid.iter().map(|&f| curve(f)).collect();
        match case.fit_in(band, grid, &spectrum) {
            Ok(_) => fitted += 1.0,
            Err(error) if is_refusal(&error) => refused += 1.0,
            Err(error) => return Err(Finding::failed(format!("spectrum `{name}`: {error}"))),
        }
    }
    Ok(
        Finding::passed(format!("{fitted} are fitted, {refused} refused"))
            .with("fitted", fitted)
            .with("refused", refused),
    )
}

/// Checks conversion of parameters to fields and back, and storage.
pub(crate) fn round_trip(case: &Case) -> Found {
    let descriptor = case.model.descriptor();
    let mut worst: f64 = 0.0;
    for fitted in case.fitted()? {
        let wrong =
            |what: String| Finding::failed(format!("spectrum `{}`: {what}", fitted.reference));
        let values =
            Values::read(descriptor, &fitted.parameters).map_err(|e| wrong(e.to_string()))?;
        let lists: Vec<&[f64]> = (0..descriptor.fields.len())
            .map(|i| values.list(i))
            .collect();
        let before = case.magnitude(&fitted.parameters)?;
        if case.magnitude(&flatten(descriptor, &lists))? != before {
            return Err(wrong(
                "flattened parameters have another magnitude".to_owned(),
            ));
        }
        let kept: Vec<Vec<f64>> = descriptor
            .fields
            .iter()
            .zip(&lists)
            .map(|(field, list)| stored(field, list))
            .collect();
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

/// Returns numbers as a file stores them. At the ends of the range steps are rounded into it, as by the writer of assets.
fn stored(field: &Field, numbers: &[f64]) -> Vec<f64> {
    let step = |x: f64, scale: f64, offset: f64, log: bool, most: f64| {
        let y = if log { x.ln() } else { x };
        let value = offset + scale * ((y - offset) / scale).round().clamp(0.0, most);
        if log { value.exp() } else { value }
    };
    let keep = |&x: &f64| match field.store {
        Store::F64 => x,
        Store::F32 => f64::from(x as f32),
        Store::U16 { scale, offset, log } => step(x, scale, offset, log, 65_535.0),
        Store::U8 { scale, offset, log } | Store::Packed { scale, offset, log } => {
            step(x, scale, offset, log, 255.0)
        }
    };
    debug_assert!(matches!(field.kind, Kind::List { .. }) || numbers.len() == 1);
    numbers.iter().map(keep).collect()
}
