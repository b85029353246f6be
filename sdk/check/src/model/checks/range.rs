//! Checks over the whole range of the parameters: values at the bounds, random values from a seed,
//! and values from fits to a spectrum and a signal together.

use htex_host::{Band, Stream};

use crate::harness::{CheckResult, Finding};
use crate::model::case::{Case, RATE_HZ};
use crate::model::checks::magnitude::{FINE_HZ, fine_grid};
use crate::model::sets::{SEEDED, Set, describes_nothing, stored};
use crate::model::signal::{rms, rms_spread_at};

/// Duration of the sounds, seconds.
const SECONDS: f64 = 4.0;
/// Allowed difference of a level from 1, dB.
const LEVEL_DB: f64 = 3.0;
/// Allowed difference of a level from 1, in standard deviations of the level of noise of this
/// duration and spectrum.
const SPREADS: f64 = 8.0;
/// Largest allowed sample in a sound of unit RMS.
const LOUDEST: f32 = 1_000.0;
/// Number of samples between two retunes.
const BETWEEN: usize = 1_000;
/// Additional bands. In these bands, the checker only searches a sound for samples that are not
/// finite.
const BANDS: [Band; 3] = [
    Band { low_hz: 20.0, high_hz: 200.0 },
    Band { low_hz: 150.0, high_hz: 700.0 },
    Band { low_hz: 5.0, high_hz: 2_000.0 },
];

fn about(set: &Set, what: &str) -> Finding {
    Finding::failed(format!("{}: {what}", set.name))
}

/// Checks both ends of every field's range.
pub(crate) fn bounds(case: &Case) -> CheckResult {
    let base = case.parameters()?;
    let (mut played, mut refused, mut accepted) = (0, 0, Vec::new());
    for at in case.at_bounds(&base)? {
        for set in [at.set.clone(), as_stored(case, &at.set)?] {
            if case.takes(&set.parameters, Band::TACTILE)? {
                plays(case, &set)?;
                played += 1;
                accepted.push(set);
            } else if !at.is_zero && case.takes(&at.inside, Band::TACTILE)? {
                let what = "it is refused, and a value next to it is not; both ends of a range belong to it";
                return Err(about(&set, what));
            } else {
                refused += 1;
            }
        }
    }
    retunes(case, &accepted)?;
    Ok(summary(played, refused))
}

/// Checks random sets within the ranges, and fits of spectra with their signals.
pub(crate) fn seeded(case: &Case) -> CheckResult {
    let fitted = case.fitted()?;
    let mut sets = case.fitted_to_signals()?;
    let (mut refused, wanted) = (0, sets.len() + SEEDED);
    for i in 0..SEEDED {
        let near = &fitted[i % fitted.len()].parameters;
        match case.seeded(near, case.seed.wrapping_add(i as u64))? {
            Some(set) => sets.push(set),
            None => refused += 1,
        }
    }
    debug_assert!(sets.len() + refused == wanted);
    for set in &sets {
        plays(case, set)?;
    }
    retunes(case, &sets)?;
    Ok(summary(sets.len(), refused))
}

fn summary(played: usize, refused: usize) -> Finding {
    let message = match refused {
        0 => format!("{played} sets play"),
        _ => format!("{played} sets play, {refused} describe no spectrum"),
    };
    Finding::passed(message).with("played", played as f64).with("refused", refused as f64)
}

/// Returns the set as it would be read back from a file.
fn as_stored(case: &Case, set: &Set) -> Result<Set, Finding> {
    let fields = case.model.descriptor().fields.iter();
    let lists = case.lists(&set.parameters)?;
    let kept: Vec<Vec<f64>> = fields.zip(&lists).map(|(f, list)| stored(f, list)).collect();
    Ok(Set { name: format!("{}, stored in a file", set.name), parameters: case.flat(&kept) })
}

/// Checks that a set with a magnitude can be played: with finite samples, at its level, and in
/// other bands.
fn plays(case: &Case, set: &Set) -> Result<(), Finding> {
    let wrong = |what: String| about(set, &what);
    let fine = fine_grid();
    let magnitude = case
        .model
        .magnitude(&set.parameters, Band::TACTILE, &fine)
        .map_err(|error| wrong(error.to_string()))?;
    let mut out = vec![0.0; (SECONDS * RATE_HZ) as usize];
    render(case, set, Band::TACTILE, &mut out)?;
    let level_db = 20.0 * rms(&out).log10();
    // Spectral lines may be far narrower than the 5 Hz steps of the usual grid.
    let spread = rms_spread_at(&magnitude, FINE_HZ, SECONDS);
    let spread_db = 20.0 * (1.0 + SPREADS * spread).log10();
    let allowed_db = LEVEL_DB.max(spread_db);
    // The condition is negated so that NaN fails.
    if !matches!(level_db.abs().partial_cmp(&allowed_db), Some(o) if o.is_le()) {
        return Err(wrong(format!(
            "its level is {level_db:.1} dB from unit RMS; {allowed_db:.1} dB are allowed"
        ))
        .with("level_db", level_db));
    }
    for band in BANDS {
        if case.takes(&set.parameters, band)? {
            render(case, set, band, &mut out[..RATE_HZ as usize / 4])?;
        }
    }
    Ok(())
}

fn render(case: &Case, set: &Set, band: Band, out: &mut [f32]) -> Result<(), Finding> {
    let (low, high) = band.edges();
    let wrong = |what: String| about(set, &format!("in the band {low} to {high} Hz: {what}"));
    let mut stream = Stream::new(&case.model, &set.parameters, band, RATE_HZ, case.seed)
        .map_err(|e| wrong(format!("it has a magnitude and no voice: {e}")))?;
    let rendered = stream.render(out);
    rendered.map_err(|error| wrong(error.to_string()))?;
    match out.iter().position(|x| x.abs() > LOUDEST) {
        None => Ok(()),
        Some(i) => Err(wrong(format!("sample {i} is {}", out[i]))),
    }
}

/// Checks that one voice can be retuned from each set to the next.
fn retunes(case: &Case, sets: &[Set]) -> Result<(), Finding> {
    let Some(first) = sets.first() else {
        return Ok(());
    };
    let mut stream = case.stream(&first.parameters, case.seed)?;
    let mut out = [0.0f32; BETWEEN];
    for pair in sets.iter().chain([first]).collect::<Vec<_>>().windows(2) {
        let (from, to) = (&pair[0].name, pair[1]);
        let wrong = |what: String| about(to, &format!("retuned to it from {from}: {what}"));
        // A voice may refuse, e.g. if its rate would change. It then continues unchanged.
        match stream.retune(&to.parameters) {
            Err(error) if describes_nothing(&error) => {}
            retuned => retuned.map_err(|error| wrong(error.to_string()))?,
        }
        for _ in 0..2 {
            let rendered = stream.render(&mut out);
            rendered.map_err(|error| wrong(error.to_string()))?;
            if let Some(x) = out.iter().find(|x| x.abs() > LOUDEST) {
                return Err(wrong(format!("a sample is {x}")));
            }
        }
    }
    Ok(())
}
