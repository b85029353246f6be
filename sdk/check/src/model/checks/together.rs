//! Checks that a model can render several voices in one call.

use htex_host::{ModelVoice, Status, VOICES_EXTENSION, render_together};

use crate::harness::{CheckResult, Finding};
use crate::model::case::Case;
use crate::model::signal::first_difference;

/// Number of voices. It is one more than fit into a call.
const VOICES: usize = 17;
const FRAMES: [usize; 5] = [1, 256, 3, 64, 500];
/// The block before which one voice is retuned.
const RETUNED_AT: usize = 2;
const RETUNED: usize = 5;

/// Checks that unusable handles are refused and that no voice advances.
fn unusable_handles(case: &Case) -> Result<(), Finding> {
    let parameters = case.parameters()?;
    let voice = |i: usize| Ok(case.voice(&parameters, case.seed.wrapping_add(i as u64))?);
    let mut voices = (0..VOICES).map(voice).collect::<Result<Vec<_>, Finding>>()?;
    let all: Vec<usize> = (0..VOICES).collect();
    let mut out = vec![0.0; VOICES * 64];
    for (numbers, what, wanted) in [
        (&[0, VOICES][..], "a handle of no voice", Status::BadHandle),
        (&[0, 1, 0], "a handle twice", Status::InvalidArgument),
        (&all, "17 voices", Status::InvalidArgument),
    ] {
        match ModelVoice::render_any_together(&mut voices, numbers, 64, &mut out) {
            Some(told) if told != wanted as i64 => {
                return Err(Finding::failed(format!(
                    "`htex_voices_1_render` with {what} answers {told}; it must answer {}",
                    wanted as i64
                )));
            }
            _ => {}
        }
    }
    let (mut moved, mut still) = (vec![0.0; 64], vec![0.0; 64]);
    voices[0].render(&mut moved)?;
    voice(0)?.render(&mut still)?;
    match first_difference(&moved, &still) {
        None => Ok(()),
        Some(_) => Err(Finding::failed(
            "a voice has moved on in a call of `htex_voices_1_render` that was refused",
        )),
    }
}

/// Checks that one call for all voices gives the same samples as separate calls.
pub(crate) fn agrees(case: &Case) -> CheckResult {
    if !case.model.has_extension(VOICES_EXTENSION)? {
        return Ok(Finding::passed(format!("the model has no extension `{VOICES_EXTENSION}`")));
    }
    unusable_handles(case)?;
    let (first, second) = match case.two_sets()? {
        Some(sets) => sets,
        None => (case.parameters()?, case.parameters()?),
    };
    let set = |voice: usize| if voice % 3 == 1 { &second } else { &first };
    let make = || -> Result<Vec<ModelVoice>, Finding> {
        let voice = |i| Ok(case.voice(set(i), case.seed.wrapping_add(i as u64))?);
        (0..VOICES).map(voice).collect()
    };
    let (mut alone, mut together) = (make()?, make()?);
    for (block, frames) in FRAMES.into_iter().enumerate() {
        if block == RETUNED_AT {
            // A voice may refuse, e.g. if its rate would change. Both voices then continue
            // unchanged.
            let retuned = [&mut alone, &mut together].map(|v| v[RETUNED].retune(&second).is_ok());
            if retuned[0] != retuned[1] {
                return Err(Finding::failed(
                    "one of two voices with equal calls before refuses a retune",
                ));
            }
        }
        let mut out = vec![0.0; VOICES * frames];
        render_together(&mut together, frames, &mut out)?;
        for (i, (voice, row)) in alone.iter_mut().zip(out.chunks(frames)).enumerate() {
            let mut own = vec![0.0; frames];
            voice.render(&mut own)?;
            if let Some(at) = first_difference(row, &own) {
                return Err(Finding::failed(format!(
                    "voice {i} of {VOICES}, {frames} frames: sample {at} differs between the common call and a separate call"
                ))
                .with("sample", at as f64));
            }
        }
    }
    Ok(Finding::passed(format!(
        "{VOICES} voices in common calls have the samples of separate calls"
    )))
}
