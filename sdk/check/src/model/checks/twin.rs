//! Checks that a native library and a WASM module are the same model.

use std::path::PathBuf;

use crate::harness::{CheckResult, Finding};
use crate::model::case::{Case, Settings};

/// Allowed relative difference of parameters.
const PARAMETERS: f64 = 1e-6;
/// Allowed difference of samples of unit RMS.
pub(super) const SAMPLES: f64 = 1e-4;

/// Compares the fits and the samples of both files.
pub(crate) fn agrees(case: &Case) -> CheckResult {
    let Some(file) = other_file(case) else {
        return Ok(Finding::skipped(
            "there is no other file of this model to compare with; name one",
        ));
    };
    let settings = Settings { seed: case.seed, ..Settings::default() };
    let other = Case::load(&file, settings)
        .map_err(|error| Finding::failed(format!("the other file: {error}")))?;
    let (ours, theirs) = (case.model.descriptor(), other.model.descriptor());
    if case.against.is_some() && ours.id == theirs.id && ours.version != theirs.version {
        return Ok(Finding::skipped("the other file is another version"));
    }
    if ours != theirs {
        let file = file.display();
        return Err(Finding::failed(format!("{file} has a different descriptor")));
    }
    let (ours, theirs) = (case.fitted()?, other.fitted()?);
    if ours.iter().map(|f| f.reference).ne(theirs.iter().map(|f| f.reference)) {
        return Err(Finding::failed("the two models can be fitted to different reference spectra"));
    }
    let (mut fits, mut sounds): (f64, f64) = (0.0, 0.0);
    for (a, b) in ours.iter().zip(&theirs) {
        let say = |what: &str| Finding::failed(format!("spectrum `{}`: {what}", a.reference));
        if a.parameters.len() != b.parameters.len() {
            return Err(say("the two models have different numbers of parameters"));
        }
        // The lower limit is for parameters that are 0 in both.
        let relative = |(a, b): (&f64, &f64)| (a - b).abs() / a.abs().max(b.abs()).max(1e-12);
        let pairs = a.parameters.iter().zip(&b.parameters);
        fits = pairs.map(relative).fold(fits, f64::max);
        let play = |case: &Case| case.samples(&a.parameters, case.seed, 20_000, 256);
        let (x, y) = (play(case)?, play(&other)?);
        let difference = |(x, y): (&f32, &f32)| f64::from((x - y).abs());
        sounds = x.iter().zip(&y).map(difference).fold(sounds, f64::max);
    }
    let message =
        format!("parameters within {fits:.1e}, samples within {sounds:.1e} of {}", file.display());
    let finding = if fits > PARAMETERS || sounds > SAMPLES {
        Finding::failed(message)
    } else if fits > 0.0 || sounds > 0.0 {
        Finding::warning(message + ", not bit-identical")
    } else {
        Finding::passed(message)
    };
    Ok(finding.with("parameter_difference", fits).with("sample_difference", sounds))
}

/// Returns the other file if it was given. Otherwise returns the file of the other kind in the same
/// folder: `libNAME.so`, `NAME.so` and `NAME.wasm` count as the same model.
fn other_file(case: &Case) -> Option<PathBuf> {
    if let Some(file) = &case.against {
        return Some(file.clone());
    }
    let stem = case.file.file_stem()?.to_str()?;
    let bare = stem.strip_prefix("lib").unwrap_or(stem);
    let is_wasm = case.file.extension()?.eq_ignore_ascii_case("wasm");
    let suffix = if is_wasm { std::env::consts::DLL_SUFFIX } else { ".wasm" };
    let names = [format!("{bare}{suffix}"), format!("lib{bare}{suffix}")];
    let beside = names.iter().map(|name| case.file.with_file_name(name));
    beside.into_iter().find(|file| file.is_file())
}
