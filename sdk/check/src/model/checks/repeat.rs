//! Checks that the samples of a voice depend on its seed, but not on the block size or on other
//! voices. This module also checks that the model refuses freed handles.

use htex_host::{Band, HostError, Status};

use crate::harness::{CheckResult, Finding};
use crate::model::case::{Case, RATE_HZ};
use crate::model::checks::magnitude::fine_grid;
use crate::model::signal::{first_difference, is_line_spectrum};

/// Number of samples that are compared.
const SAMPLES: usize = 9_000;

fn differ(what: &str, at: usize) -> Finding {
    Finding::failed(format!("{what}: sample {at} differs")).with("sample", at as f64)
}

/// Checks that the same seed gives the same samples.
pub(crate) fn reproducible(case: &Case) -> CheckResult {
    for fitted in case.fitted()? {
        let render = || case.samples(&fitted.parameters, case.seed, SAMPLES, 256);
        if let Some(at) = first_difference(&render()?, &render()?) {
            let what = format!("spectrum `{}`, the same seed twice", fitted.reference);
            return Err(differ(&what, at));
        }
    }
    let parameters = case.parameters()?;
    let rate_hz = case.model.voice_rate_hz(&parameters, Band::TACTILE, RATE_HZ)?;
    let two = case.model.two_voices(&parameters, Band::TACTILE, rate_hz, case.seed, SAMPLES)?;
    if let Some(at) = two.and_then(|[first, second]| first_difference(&first, &second)) {
        return Err(differ("two equal voices in one instance of the module", at));
    }
    Ok(Finding::passed(format!("{SAMPLES} samples are equal in two voices")))
}

/// Checks that samples do not depend on the block size.
pub(crate) fn blocks(case: &Case) -> CheckResult {
    let parameters = case.parameters()?;
    let whole = case.samples(&parameters, case.seed, SAMPLES, SAMPLES)?;
    for block in [1, 7, 64, 1_000] {
        let other = case.samples(&parameters, case.seed, SAMPLES, block)?;
        if let Some(at) = first_difference(&whole, &other) {
            return Err(differ(&format!("blocks of {block} and one of {SAMPLES}"), at));
        }
    }
    let mut voice = case.voice(&parameters, case.seed)?;
    let mut with_empty = vec![0.0; SAMPLES];
    for block in with_empty.chunks_mut(64) {
        let empty = voice.render(&mut []);
        empty.map_err(|error| Finding::failed(format!("an empty block: {error}")))?;
        voice.render(block)?;
    }
    if let Some(at) = first_difference(&whole, &with_empty) {
        return Err(differ("with empty blocks between others", at));
    }
    Ok(Finding::passed("samples are equal in blocks of 0, 1, 7, 64, 1000 and 9000"))
}

/// Checks that different seeds give different samples.
pub(crate) fn seeds(case: &Case) -> CheckResult {
    let parameters = case.parameters()?;
    let render = |seed| case.samples(&parameters, seed, SAMPLES, 256);
    let same = first_difference(&render(case.seed)?, &render(case.seed.wrapping_add(1))?).is_none();
    if !same {
        return Ok(Finding::passed("two seeds give different samples"));
    }
    let fine = case.model.magnitude(&parameters, Band::TACTILE, &fine_grid())?;
    if is_line_spectrum(&fine) {
        return Ok(Finding::warning(
            "two seeds give equal samples; the spectrum consists of lines, which may have no random component",
        ));
    }
    Err(Finding::failed("two seeds give equal samples: the seed is ignored"))
}

/// Checks that voices that play at the same time have the same samples as when each plays alone.
pub(crate) fn voices_apart(case: &Case) -> CheckResult {
    let sets = case.two_sets()?;
    let (a, b) = match sets {
        Some(sets) => sets,
        None => (case.parameters()?, case.parameters()?),
    };
    let alone = |set: &[f64], seed| case.samples(set, seed, SAMPLES, 64);
    let (seed, other) = (case.seed, case.seed.wrapping_add(7));
    let (alone_a, alone_b) = (alone(&a, seed)?, alone(&b, other)?);

    let (mut first, mut second) = (case.voice(&a, seed)?, case.voice(&b, other)?);
    let mut turns = (vec![0.0; SAMPLES], vec![0.0; SAMPLES]);
    for (x, y) in turns.0.chunks_mut(64).zip(turns.1.chunks_mut(64)) {
        first.render(x)?;
        second.render(y)?;
    }
    let threads = std::thread::scope(|scope| {
        let first = scope.spawn(|| alone(&a, seed));
        let second = scope.spawn(|| alone(&b, other));
        (first.join(), second.join())
    });
    let (Ok(thread_a), Ok(thread_b)) = threads else {
        return Err(Finding::failed("a voice on a separate thread panicked"));
    };
    for (way, together, alone) in [
        ("the first of two voices in turns", &turns.0, &alone_a),
        ("the second of two voices in turns", &turns.1, &alone_b),
        ("the first of two voices on threads", &thread_a?, &alone_a),
        ("the second of two voices on threads", &thread_b?, &alone_b),
    ] {
        if let Some(at) = first_difference(together, alone) {
            return Err(differ(&format!("{way}, compared with it alone"), at));
        }
    }
    Ok(Finding::passed(
        "two voices have the same samples as each by itself, in turns and on threads",
    ))
}

/// Checks that a freed handle is refused.
pub(crate) fn handles(case: &Case) -> CheckResult {
    let parameters = case.parameters()?;
    let mut voice = case.voice(&parameters, case.seed)?;
    voice.render(&mut [0.0; 64])?;
    voice
        .free_and_keep_handle()
        .map_err(|error| Finding::failed(format!("a voice cannot be freed: {error}")))?;
    let mut others = 0.0;
    for when in ["after it was freed", "after the next voice was made"] {
        let calls = [
            ("voice_render", voice.render(&mut [0.0; 64])),
            ("voice_retune", voice.retune(&parameters)),
            ("voice_free", voice.free_and_keep_handle()),
        ];
        for (call, result) in calls {
            match result {
                Err(HostError::Call { status: Status::BadHandle, .. }) => {}
                Err(HostError::Call { .. }) => others += 1.0,
                Err(error) => return Err(error.into()),
                Ok(()) => {
                    let message = format!("`{call}` accepts the handle of a voice {when}");
                    return Err(Finding::failed(message));
                }
            }
        }
        // This voice may reuse the slot of the freed voice, but the old handle must not reach it.
        std::mem::forget(case.voice(&parameters, case.seed)?);
    }
    if others > 0.0 {
        let message = "freed handles are refused, with a status other than BAD_HANDLE";
        return Ok(Finding::warning(message).with("other_status", others));
    }
    Ok(Finding::passed("freed handles are refused"))
}
