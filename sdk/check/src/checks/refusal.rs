//! Invalid arguments.

use htex_host::{Band, HostError, Kind};
use htex_model::{Values, flatten};

use crate::case::{Case, RATE_HZ, is_refusal};
use crate::signal::first_difference;
use htex_check_runner::{Finding, Found};

/// Fails unless a call returned a status.
fn refused<T>(call: &str, what: &str, result: Result<T, HostError>) -> Result<(), Finding> {
    match result {
        Err(error) if is_refusal(&error) => Ok(()),
        Err(error) => Err(Finding::failed(format!("`{call}` with {what}: {error}"))),
        Ok(_) => Err(Finding::failed(format!("`{call}` accepts {what}"))),
    }
}

/// Checks that parameters that do not fit the descriptor are refused.
pub(crate) fn parameters(case: &Case) -> Found {
    let (model, band) = (&case.model, Band::TACTILE);
    let good = case.parameters()?;
    let broken = broken_sets(case, &good)?;
    let undisturbed = case.samples(&good, case.seed, 4_096, 64)?;
    let mut voice = case.voice(&good, case.seed)?;
    let mut out = vec![0.0; 4_096];
    let mut turns = broken.iter().cycle();
    for block in out.chunks_mut(64) {
        if let Some((what, set)) = turns.next() {
            refused("voice_retune", what, voice.retune(set))?;
        }
        voice.render(block)?;
    }
    if let Some(at) = first_difference(&out, &undisturbed) {
        let message = format!("a refused retune changes the sound at sample {at}");
        return Err(Finding::failed(message).with("sample", at as f64));
    }
    for (what, set) in &broken {
        let rate = model.voice_rate_hz(set, band, RATE_HZ);
        refused("magnitude", what, model.magnitude(set, band, &[100.0]))?;
        refused("voice_rate", what, rate)?;
        refused(
            "voice_new",
            what,
            model.voice(set, band, RATE_HZ, case.seed),
        )?;
        refused("voice_retune", what, voice.retune(set))?;
    }
    let count = broken.len();
    Ok(
        Finding::passed(format!("{count} invalid parameter sets are refused"))
            .with("sets", count as f64),
    )
}

/// Returns sets with one error each, and its description.
fn broken_sets(case: &Case, good: &[f64]) -> Result<Vec<(String, Vec<f64>)>, Finding> {
    let descriptor = case.model.descriptor();
    let values = Values::read(descriptor, good).map_err(|e| Finding::failed(e.message))?;
    let lists: Vec<&[f64]> = (0..descriptor.fields.len())
        .map(|i| values.list(i))
        .collect();
    let mut broken = vec![
        ("no parameters".to_owned(), Vec::new()),
        (
            "one number too few".to_owned(),
            good[..good.len() - 1].to_vec(),
        ),
        ("one number too many".to_owned(), [good, &[1.0]].concat()),
    ];
    let mut at = 0;
    for (i, field) in descriptor.fields.iter().enumerate() {
        let span = (field.max - field.min).max(1.0);
        let wrong = [field.min - span, field.max + span, f64::NAN, f64::INFINITY];
        for number in wrong.into_iter().filter(|_| !lists[i].is_empty()) {
            let mut numbers = lists[i].to_vec();
            numbers[0] = number;
            let mut lists = lists.clone();
            lists[i] = &numbers;
            broken.push((
                format!("`{}` = {number}", field.name),
                flatten(descriptor, &lists),
            ));
        }
        if let Kind::List { max_len } = field.kind {
            for len in [-1.0, 0.5, f64::NAN, f64::from(max_len) + 1.0, 1e300] {
                let mut set = good.to_vec();
                set[at] = len;
                broken.push((format!("`{}` of length {len}", field.name), set));
            }
            at += 1;
        }
        at += lists[i].len();
    }
    Ok(broken)
}

/// Checks that invalid bands are refused.
pub(crate) fn band(case: &Case) -> Found {
    let good = case.parameters()?;
    let spectrum = [0.01, 0.02, 0.03, 0.02, 0.01];
    let grid = [100.0, 105.0, 110.0, 115.0, 120.0];
    let bands = [
        (1000.0, 20.0),
        (100.0, 100.0),
        (0.0, 1000.0),
        (-20.0, 1000.0),
        (f64::NAN, 1000.0),
        (20.0, f64::NAN),
        (20.0, f64::INFINITY),
        (20.0, 2e6),
    ];
    for (low_hz, high_hz) in bands {
        let (band, what) = (
            Band { low_hz, high_hz },
            format!("the band {low_hz} to {high_hz} Hz"),
        );
        let model = &case.model;
        refused("fit", &what, case.fit_in(band, &grid, &spectrum))?;
        refused("magnitude", &what, model.magnitude(&good, band, &[100.0]))?;
        refused(
            "voice_rate",
            &what,
            model.voice_rate_hz(&good, band, RATE_HZ),
        )?;
        refused(
            "voice_new",
            &what,
            model.voice(&good, band, RATE_HZ, case.seed),
        )?;
    }
    Ok(Finding::passed(format!(
        "{} invalid bands are refused",
        bands.len()
    )))
}

/// Checks that invalid rates are refused.
pub(crate) fn rate(case: &Case) -> Found {
    let good = case.parameters()?;
    let rates = [f64::NAN, 0.0, -1.0, f64::INFINITY, 1e12];
    for rate_hz in rates {
        let (model, what) = (&case.model, format!("a rate of {rate_hz} Hz"));
        let band = Band::TACTILE;
        refused(
            "voice_rate",
            &what,
            model.voice_rate_hz(&good, band, rate_hz),
        )?;
        refused(
            "voice_new",
            &what,
            model.voice(&good, band, rate_hz, case.seed),
        )?;
    }
    Ok(Finding::passed(format!(
        "{} invalid rates are refused",
        rates.len()
    )))
}
