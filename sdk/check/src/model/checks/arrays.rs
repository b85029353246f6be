//! Checks how calls use the host's arrays: what they read, how far they write, and what they keep.

use htex_host::{Band, FitCondition, FitInput, HostError, ModelVoice, Origin, ProbeArguments};

use crate::harness::{CheckResult, Finding};
use crate::model::case::{Case, RATE_HZ, is_cannot_fit};
use crate::model::fence::{self, Fenced, Number};
use crate::model::signal::first_difference;
use crate::model::spectra::REFERENCES;

const FRAMES: [usize; 5] = [1, 7, 64, 500, 4_097];
const SAMPLES: usize = 2_000;

/// Checks that calls write texts and parameters only within the given arrays, that they read only
/// these arrays, and that they keep no array after the call.
pub(crate) fn kept_to(case: &Case) -> CheckResult {
    watch(case);
    let parameters = fits(case)?;
    descriptors(case)?;
    mixes(case, &parameters)?;
    let refused = unusable(case, &parameters)?;
    keeps_nothing(case, &parameters)?;
    let unusable = match refused {
        0 => String::new(),
        _ => format!("; {refused} arrays that are not usable are refused"),
    };
    let message = format!("nothing is read or written beyond an array{unusable}");
    Ok(Finding::passed(message).with("refused", refused as f64))
}

/// Watches the calls of a native library. A call that touches memory behind an array then fails
/// with a finding that names the array. WASM modules are not watched, because their engine has its
/// own signal handler. Instead, the limits of the checks put guard values into the module's memory.
fn watch(case: &Case) {
    if !matches!(case.model.origin(), Origin::Wasm(_)) {
        fence::watch();
    }
}

/// Calls a function with all interesting capacities. Each call must return the same length, write
/// the beginning of the same values, and write nothing beyond the capacity.
fn capacities<T: Number>(
    call: &'static str,
    whole: &[T],
    mut into: impl FnMut(&mut [T]) -> Result<usize, HostError>,
) -> Result<(), Finding> {
    let len = whole.len();
    for capacity in [0, 1, len / 2, len.saturating_sub(1), len, len + 3] {
        let mut out = Fenced::output(capacity, call, "capacity");
        let told = into(out.get())?;
        out.check()?;
        if told != len {
            return Err(Finding::failed(format!(
                "`{call}` returns the length {told} with a capacity of {capacity}, and {len} with more"
            )));
        }
        let written = capacity.min(len);
        if out.get()[..written] != whole[..written] {
            return Err(Finding::failed(format!(
                "`{call}` with a capacity of {capacity} writes other values than with more"
            )));
        }
    }
    Ok(())
}

/// Fits the first reference that can be fitted, with every capacity. Returns its parameters.
fn fits(case: &Case) -> Result<Vec<f64>, Finding> {
    let grid = Band::TACTILE.grid_hz();
    for reference in REFERENCES {
        let spectrum: Vec<f64> = grid.iter().map(|&hz| (reference.curve)(hz)).collect();
        let whole = match case.fit(&spectrum) {
            Ok(fit) => fit.parameters,
            Err(error) if is_cannot_fit(&error) => continue,
            Err(error) => return Err(error.into()),
        };
        let options = case.model.descriptor().default_options();
        let mut hz = Fenced::input(&grid, "fit", "frequency_hz");
        let mut magnitude = Fenced::input(&spectrum, "fit", "magnitude");
        let mut knobs = Fenced::input(&options, "fit", "options");
        capacities("fit", &whole, |out| {
            let request = FitInput {
                band: Band::TACTILE,
                frequency_hz: hz.get(),
                magnitude: magnitude.get(),
                signal: &[],
                signal_rate_hz: RATE_HZ,
                options: knobs.get(),
                condition: FitCondition::default(),
            };
            let (model, mut level) = (&case.model, 0.0);
            model.fit_into(&request, out, &mut level)
        })?;
        hz.unchanged(&grid, "frequency_hz")?;
        magnitude.unchanged(&spectrum, "magnitude")?;
        return Ok(whole);
    }
    Err(Finding::failed("the model cannot be fitted to any reference spectrum"))
}

fn descriptors(case: &Case) -> Result<(), Finding> {
    let read = || -> Result<Vec<u8>, HostError> {
        let mut text = vec![0; case.model.descriptor_into(&mut [])?];
        case.model.descriptor_into(&mut text)?;
        Ok(text)
    };
    let whole = read()?;
    capacities("descriptor", &whole, |out| case.model.descriptor_into(out))
}

/// Checks that the model writes one magnitude for each frequency, and nothing beyond.
pub(crate) fn magnitudes(case: &Case, parameters: &[f64]) -> Result<(), Finding> {
    watch(case);
    let grid = Band::TACTILE.grid_hz();
    let call = "magnitude";
    let mut given = Fenced::input(parameters, call, "parameters");
    for bins in [0, 1, 3, grid.len()] {
        let mut hz = Fenced::input(&grid[..bins], call, "frequency_hz");
        let mut out = Fenced::output(bins, call, "bins");
        let model = &case.model;
        model.magnitude_into(given.get(), Band::TACTILE, hz.get(), out.get())?;
        out.check()?;
        hz.unchanged(&grid[..bins], "frequency_hz")?;
    }
    given.unchanged(parameters, "parameters")
}

fn mixes(case: &Case, parameters: &[f64]) -> Result<(), Finding> {
    let call = "interpolate";
    let (sets, weights) = ([parameters, parameters].concat(), [0.25, 0.75]);
    let mut whole = vec![0.0; case.model.most_parameters()];
    let len = case.model.interpolate_into(&sets, &weights, &mut whole)?;
    whole.truncate(len);
    let mut given = Fenced::input(&sets, call, "sets");
    let mut by = Fenced::input(&weights, call, "weights");
    capacities(call, &whole, |out| case.model.interpolate_into(given.get(), by.get(), out))?;
    given.unchanged(&sets, "sets")?;
    by.unchanged(&weights, "weights")
}

/// Passes null and misaligned arrays to a native library. Returns how many the library refused.
fn unusable(case: &Case, parameters: &[f64]) -> Result<usize, Finding> {
    let grid = Band::TACTILE.grid_hz();
    let spectrum: Vec<f64> = grid.iter().map(|&hz| (REFERENCES[0].curve)(hz)).collect();
    let rate_hz = case.model.voice_rate_hz(parameters, Band::TACTILE, RATE_HZ)?;
    let arguments = ProbeArguments {
        parameters,
        band: Band::TACTILE,
        rate_hz,
        frequency_hz: &grid,
        magnitude: &spectrum,
        options: &case.model.descriptor().default_options(),
    };
    let answers = case.model.unusable_arrays(&arguments).unwrap_or_default();
    match answers.iter().find(|call| call.answer != call.wanted) {
        None => Ok(answers.len()),
        Some(call) => Err(Finding::failed(format!(
            "{} and a length above 0 answers {}; it must answer {}",
            call.what, call.answer, call.wanted
        ))),
    }
}

/// Checks that a block has the requested length, and that parameters are only read.
pub(crate) fn blocks(case: &Case, parameters: &[f64]) -> Result<(), Finding> {
    watch(case);
    let mut given = Fenced::input(parameters, "voice_new", "parameters");
    let mut voice = case.voice(given.get(), case.seed)?;
    given.unchanged(parameters, "parameters")?;
    // The arrays live until the end. So if a voice keeps an array, only `keeps_nothing` finds this.
    let mut lent = vec![given];
    for frames in FRAMES {
        let mut out = Fenced::output(frames, "voice_render", "frames");
        voice.render_into(out.get())?;
        out.check()?;
        let mut given = Fenced::input(parameters, "voice_retune", "parameters");
        voice.retune(given.get())?;
        given.unchanged(parameters, "parameters")?;
        lent.push(given);
    }
    Ok(())
}

/// Overwrites the arrays that were passed to a voice. Its samples must not change.
fn keeps_nothing(case: &Case, parameters: &[f64]) -> Result<(), Finding> {
    let other = case.two_sets()?.map_or(parameters.to_vec(), |sets| sets.1);
    let play = |scrub: bool| -> Result<Vec<f32>, Finding> {
        let mut given = Fenced::input(parameters, "voice_new", "parameters");
        let mut voice = case.voice(given.get(), case.seed)?;
        let mut out = vec![0.0; 2 * SAMPLES];
        let (before, behind) = out.split_at_mut(SAMPLES);
        let mut next = Fenced::input(&other, "voice_retune", "parameters");
        let part = |voice: &mut ModelVoice, array: &mut Fenced<f64>, out: &mut [f32]| {
            if scrub {
                // If the voice still reads the array, NaN reaches the samples.
                array.get().fill(f64::NAN);
            }
            voice.render(out)
        };
        part(&mut voice, &mut given, before)?;
        // A voice may refuse, e.g. if its rate would change. It then continues unchanged.
        let _ = voice.retune(next.get());
        part(&mut voice, &mut next, behind)?;
        Ok(out)
    };
    let [left, again, scrubbed] = [play(false)?, play(false)?, play(true)?];
    match first_difference(&left, &scrubbed) {
        None => Ok(()),
        // Another check reports a voice that is not reproducible.
        Some(_) if first_difference(&left, &again).is_some() => Ok(()),
        Some(at) => Err(Finding::failed(format!(
            "sample {at} changes when the arrays of parameters change after the call: an array is lent for the call only"
        ))),
    }
}
