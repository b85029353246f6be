//! Checks that a model refuses invalid arguments.

use htex_host::{Band, FitCondition, FitInput, HostError, Kind, Status};
use htex_model::{Values, flatten};

use crate::harness::{CheckResult, Finding};
use crate::model::case::{Case, RATE_HZ};
use crate::model::signal::first_difference;
use crate::model::spectra::REFERENCES;

/// The host's message if a model gives no reason.
const NO_REASON: &str = "no reason given";

/// Fails unless a call returned this status and gave a reason.
fn refused<T>(
    status: Status,
    call: &str,
    what: &str,
    result: Result<T, HostError>,
) -> Result<(), Finding> {
    let wrong = |what: String| Err(Finding::failed(what));
    match result {
        Err(HostError::Call { message, .. }) if message == NO_REASON => {
            wrong(format!("`{call}` refuses {what}, and `last_error` gives no reason"))
        }
        Err(HostError::Call { status: told, .. }) if told == status => Ok(()),
        Err(HostError::Call { status: told, message, .. }) => wrong(format!(
            "`{call}` refuses {what} with the status {} ({message}); it must be {}",
            told as i64, status as i64
        )),
        Err(error) => wrong(format!("`{call}` with {what}: {error}")),
        Ok(_) => wrong(format!("`{call}` accepts {what}")),
    }
}

/// Checks that parameters that do not match the descriptor are refused.
pub(crate) fn parameters(case: &Case) -> CheckResult {
    let (model, band) = (&case.model, Band::TACTILE);
    let status = Status::InvalidParameters;
    let good = case.parameters()?;
    let broken = broken_sets(case, &good)?;
    let undisturbed = case.samples(&good, case.seed, 4_096, 64)?;
    let mut voice = case.voice(&good, case.seed)?;
    let mut out = vec![0.0; 4_096];
    let mut turns = broken.iter().cycle();
    for block in out.chunks_mut(64) {
        if let Some((what, set)) = turns.next() {
            refused(status, "voice_retune", what, voice.retune(set))?;
        }
        voice.render(block)?;
    }
    if let Some(at) = first_difference(&out, &undisturbed) {
        let message = format!("a refused retune changes the sound at sample {at}");
        return Err(Finding::failed(message).with("sample", at as f64));
    }
    for (what, set) in &broken {
        let rate = model.voice_rate_hz(set, band, RATE_HZ);
        refused(status, "magnitude", what, model.magnitude(set, band, &[100.0]))?;
        refused(status, "voice_rate", what, rate)?;
        refused(status, "voice_new", what, model.voice(set, band, RATE_HZ, case.seed))?;
        refused(status, "voice_retune", what, voice.retune(set))?;
    }
    let count = broken.len();
    Ok(Finding::passed(format!("{count} invalid parameter sets are refused"))
        .with("sets", count as f64))
}

/// Returns sets with one error each, and a description of the error.
fn broken_sets(case: &Case, good: &[f64]) -> Result<Vec<(String, Vec<f64>)>, Finding> {
    let descriptor = case.model.descriptor();
    let values = Values::read(descriptor, good).map_err(|e| Finding::failed(e.message))?;
    let lists: Vec<&[f64]> = (0..descriptor.fields.len()).map(|i| values.list(i)).collect();
    let mut broken = vec![
        ("no parameters".to_owned(), Vec::new()),
        ("one number too few".to_owned(), good[..good.len() - 1].to_vec()),
        ("one number too many".to_owned(), [good, &[1.0]].concat()),
    ];
    let mut at = 0;
    for (i, field) in descriptor.fields.iter().enumerate() {
        // The span is at least 1. Otherwise, in a range of a single value, the number would not be
        // outside the range.
        let span = (field.max - field.min).max(1.0);
        let wrong = [field.min - span, field.max + span, f64::NAN, f64::INFINITY];
        for number in wrong.into_iter().filter(|_| !lists[i].is_empty()) {
            let mut numbers = lists[i].to_vec();
            numbers[0] = number;
            let mut lists = lists.clone();
            lists[i] = &numbers;
            broken.push((format!("`{}` = {number}", field.name), flatten(descriptor, &lists)));
        }
        if let Kind::List { max_len } = field.kind {
            for len in [-1.0, 0.5, f64::NAN, f64::from(max_len) + 1.0, 1e300] {
                let mut set = good.to_vec();
                set[at] = len;
                broken.push((format!("`{}` of length {len}", field.name), set));
            }
            // A list is stored after its length.
            at += 1;
        }
        at += lists[i].len();
    }
    Ok(broken)
}

/// Checks that invalid bands are refused.
pub(crate) fn band(case: &Case) -> CheckResult {
    let good = case.parameters()?;
    let status = Status::InvalidArgument;
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
        let (band, what) = (Band { low_hz, high_hz }, format!("the band {low_hz} to {high_hz} Hz"));
        let model = &case.model;
        refused(status, "fit", &what, case.fit_in(band, &grid, &spectrum))?;
        refused(status, "magnitude", &what, model.magnitude(&good, band, &[100.0]))?;
        refused(status, "voice_rate", &what, model.voice_rate_hz(&good, band, RATE_HZ))?;
        refused(status, "voice_new", &what, model.voice(&good, band, RATE_HZ, case.seed))?;
    }
    Ok(Finding::passed(format!("{} invalid bands are refused", bands.len())))
}

/// Checks that invalid rates are refused.
pub(crate) fn rate(case: &Case) -> CheckResult {
    let good = case.parameters()?;
    let status = Status::InvalidArgument;
    let rates = [f64::NAN, 0.0, -1.0, f64::INFINITY, 1e12];
    for rate_hz in rates {
        let (model, what) = (&case.model, format!("a rate of {rate_hz} Hz"));
        let band = Band::TACTILE;
        refused(status, "voice_rate", &what, model.voice_rate_hz(&good, band, rate_hz))?;
        refused(status, "voice_new", &what, model.voice(&good, band, rate_hz, case.seed))?;
    }
    Ok(Finding::passed(format!("{} invalid rates are refused", rates.len())))
}

/// Checks that unusable spectra, signals and options are refused.
pub(crate) fn inputs(case: &Case) -> CheckResult {
    let grid = Band::TACTILE.grid_hz();
    let magnitude: Vec<f64> = grid.iter().map(|&hz| (REFERENCES[0].curve)(hz)).collect();
    let options = case.model.descriptor().default_options();
    let good = FitInput {
        band: Band::TACTILE,
        frequency_hz: &grid,
        magnitude: &magnitude,
        signal: &[],
        signal_rate_hz: RATE_HZ,
        options: &options,
        condition: FitCondition::default(),
    };
    let with = |numbers: &[f64], at: usize, number: f64| {
        let mut numbers = numbers.to_vec();
        numbers[at] = number;
        numbers
    };
    let fit = |what: &str, status: Status, request: FitInput<'_>| {
        refused(status, "fit", what, case.model.fit(&request))
    };
    let argument = Status::InvalidArgument;
    let mut count = 0;
    for number in [f64::NAN, f64::INFINITY, -0.001] {
        let magnitude = with(&magnitude, 7, number);
        let what = format!("a magnitude of {number}");
        let magnitude = &magnitude;
        fit(&what, argument, FitInput { magnitude, ..good })?;
    }
    for (number, what) in [
        (f64::NAN, "a frequency of NaN"),
        (grid[6], "two equal frequencies"),
        (grid[5], "frequencies that do not ascend"),
        (f64::NEG_INFINITY, "a frequency of -inf"),
    ] {
        let frequency_hz = &with(&grid, 7, number);
        fit(what, argument, FitInput { frequency_hz, ..good })?;
    }
    for bins in [0, 2] {
        let (frequency_hz, magnitude) = (&grid[..bins], &magnitude[..bins]);
        let request = FitInput { frequency_hz, magnitude, ..good };
        fit(&format!("{bins} bins"), argument, request)?;
    }
    for (signal, signal_rate_hz, what) in [
        (&[0.1, f64::NAN, 0.1][..], RATE_HZ, "a signal with NaN"),
        (&[0.1, f64::INFINITY, 0.1], RATE_HZ, "an infinite signal"),
        (&[0.1; 3], f64::NAN, "a signal at a rate of NaN"),
        (&[0.1; 3], 0.0, "a signal at a rate of 0 Hz"),
    ] {
        let request = FitInput { signal, signal_rate_hz, ..good };
        fit(what, argument, request)?;
    }
    for (options, what) in wrong_options(case, &options) {
        let options = &options;
        fit(&what, Status::InvalidOption, FitInput { options, ..good })?;
        count += 1;
    }
    let parameters = case.parameters()?;
    for hz in [f64::NAN, f64::INFINITY] {
        let told = case.model.magnitude(&parameters, Band::TACTILE, &[100.0, hz]);
        refused(argument, "magnitude", &format!("a frequency of {hz}"), told)?;
    }
    Ok(Finding::passed(format!("13 spectra and signals and {count} sets of options are refused")))
}

/// Returns options with one error each.
fn wrong_options(case: &Case, good: &[f64]) -> Vec<(Vec<f64>, String)> {
    let mut wrong = vec![([good, &[1.0]].concat(), "one option too many".to_owned())];
    if let [.., _] = good {
        let fewer = good[..good.len() - 1].to_vec();
        wrong.push((fewer, "one option too few".to_owned()));
    }
    for (i, option) in case.model.descriptor().options.iter().enumerate() {
        let mut numbers = vec![option.min - 1.0, option.max + 1.0, f64::NAN];
        let half = option.min + 0.5;
        if option.integer && half < option.max {
            numbers.push(half);
        }
        for number in numbers {
            let mut options = good.to_vec();
            options[i] = number;
            wrong.push((options, format!("the option `{}` = {number}", option.name)));
        }
    }
    wrong
}

/// Checks that unusable weights are refused.
pub(crate) fn weights(case: &Case) -> CheckResult {
    let good = case.parameters()?;
    let wrong: [&[f64]; 7] = [
        &[0.5, 0.6],
        &[0.5, 0.499],
        &[-0.5, 1.5],
        &[f64::NAN, 1.0],
        &[f64::INFINITY, 0.0],
        &[2.0, -1.0],
        &[0.0, 0.0],
    ];
    for weights in wrong {
        let told = case.model.interpolate(&[&good, &good], weights);
        let what = format!("weights of {weights:?}");
        refused(Status::InvalidArgument, "interpolate", &what, told)?;
    }
    for (what, set) in broken_sets(case, &good)? {
        // The beginning of the next set could be mistaken for the end of a set of another length.
        if set.len() == good.len() {
            let told = case.model.interpolate(&[&good, &set], &[0.5, 0.5]);
            refused(Status::InvalidParameters, "interpolate", &what, told)?;
        }
    }
    let count = wrong.len();
    Ok(Finding::passed(format!("{count} invalid sets of weights are refused")))
}
