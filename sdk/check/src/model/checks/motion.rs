//! Checks of the extension `htex.motion/1`.

use htex_host::{FitCondition, MOTION_EXTENSION, ModelVoice, Motion, Status};

use crate::harness::{CheckResult, Finding};
use crate::model::case::{Case, is_cannot_fit};
use crate::model::checks::allocation;
use crate::model::signal::first_difference;
use crate::model::spectra::REFERENCES;

const FRAMES: usize = 4_000;
const BLOCKS: [usize; 4] = [1, 7, 64, 1_000];
/// Number of samples between two motions of a back-and-forth movement.
const BETWEEN: usize = 50;
const MOTION: Motion =
    Motion { speed_mm_s: 80.0, force_n: 0.5, position_mm: 3.0, x_mm: 2.0, y_mm: -1.0 };

/// Checks the guarantees of `htex.motion/1`.
pub(crate) fn keeps_its_promises(case: &Case) -> CheckResult {
    if !case.model.follows_motion() {
        return Ok(Finding::passed(format!("the model has no extension `{MOTION_EXTENSION}`")));
    }
    let parameters = case.parameters()?;
    bad_motions_are_refused(case, &parameters)?;
    blocks_make_no_difference(case, &parameters)?;
    order_makes_no_difference(case, &parameters)?;
    fits_take_conditions(case)?;
    let mut voice = case.voice(&parameters, case.seed)?;
    there_and_back(&mut voice, FRAMES)?;
    allocation::none_while(&mut voice, |voice| there_and_back(voice, 10 * FRAMES))?;
    Ok(Finding::passed(format!(
        "invalid motions are refused, {FRAMES} samples of a motion are equal in all block sizes, and nothing is allocated"
    )))
}

/// Checks that an invalid motion and a freed handle return a status, and that the voice continues
/// unchanged.
fn bad_motions_are_refused(case: &Case, parameters: &[f64]) -> Result<(), Finding> {
    let voices = || -> Result<ModelVoice, Finding> {
        let mut voice = case.voice(parameters, case.seed)?;
        voice.set_motion(MOTION)?;
        Ok(voice)
    };
    let (mut told, mut spared) = (voices()?, voices()?);
    let argument = Status::InvalidArgument;
    for x in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e13, -1e13] {
        let bad = [
            ("speed_mm_s", Motion { speed_mm_s: x, ..MOTION }),
            ("force_n", Motion { force_n: x, ..MOTION }),
            ("position_mm", Motion { position_mm: x, ..MOTION }),
            ("x_mm", Motion { x_mm: x, ..MOTION }),
            ("y_mm", Motion { y_mm: x, ..MOTION }),
        ];
        for (name, motion) in bad {
            let what = format!("{name} of {x}");
            refused(told.set_any_motion(motion), argument, &what)?;
        }
    }
    let pulled = Motion { force_n: -0.1, ..MOTION };
    refused(told.set_any_motion(pulled), argument, "force_n of -0.1")?;
    let rows = [&mut told, &mut spared].map(|voice| -> Result<Vec<f32>, Finding> {
        let mut out = vec![0.0; FRAMES];
        voice.render(&mut out)?;
        Ok(out)
    });
    let [told_row, spared_row] = rows;
    if let Some(at) = first_difference(&told_row?, &spared_row?) {
        let what = format!("sample {at} differs after motions that were refused");
        return Err(Finding::failed(what));
    }
    told.free_and_keep_handle()?;
    let freed = told.set_any_motion(MOTION);
    refused(freed, Status::BadHandle, "a voice that was freed")
}

fn refused(
    result: Result<(), htex_host::HostError>,
    wanted: Status,
    what: &str,
) -> Result<(), Finding> {
    let code = wanted as i64;
    match result {
        Err(htex_host::HostError::Call { status, .. }) if status == wanted => Ok(()),
        Ok(()) => Err(Finding::failed(format!(
            "`htex_motion_1_set` accepts {what}; it must return {code}"
        ))),
        Err(htex_host::HostError::Call { status, .. }) => Err(Finding::failed(format!(
            "`htex_motion_1_set` refuses {what} with {}; it must return {code}",
            status as i64
        ))),
        Err(error) => Err(Finding::failed(format!("{what}: {error}"))),
    }
}

/// Checks that a constant motion gives the same samples for all block sizes, and also if the motion
/// is set again.
fn blocks_make_no_difference(case: &Case, parameters: &[f64]) -> Result<(), Finding> {
    let render = |block: usize| -> Result<Vec<f32>, Finding> {
        let mut voice = case.voice(parameters, case.seed)?;
        voice.set_motion(MOTION)?;
        let mut out = vec![0.0; FRAMES];
        for part in out.chunks_mut(block) {
            voice.render(part)?;
        }
        Ok(out)
    };
    let whole = render(FRAMES)?;
    for block in BLOCKS {
        if let Some(at) = first_difference(&whole, &render(block)?) {
            return Err(Finding::failed(format!(
                "a constant motion, blocks of {block} against one of {FRAMES}: sample {at} differs"
            ))
            .with("sample", at as f64));
        }
    }
    Ok(())
}

/// Checks that a retune and a motion before the same sample give the same result in either order.
fn order_makes_no_difference(case: &Case, parameters: &[f64]) -> Result<(), Finding> {
    let other = case.two_sets()?.map_or(parameters.to_vec(), |sets| sets.1);
    let render = |motion_first: bool| -> Result<Vec<f32>, Finding> {
        let mut voice = case.voice(parameters, case.seed)?;
        let mut out = vec![0.0; FRAMES];
        let (before, behind) = out.split_at_mut(FRAMES / 2);
        voice.render(before)?;
        let motion = Motion { speed_mm_s: -40.0, ..MOTION };
        if motion_first {
            voice.set_motion(motion)?;
        }
        // A voice may refuse, e.g. if its rate would change. Both voices then continue unchanged.
        let _ = voice.retune(&other);
        if !motion_first {
            voice.set_motion(motion)?;
        }
        voice.render(behind)?;
        Ok(out)
    };
    match first_difference(&render(true)?, &render(false)?) {
        None => Ok(()),
        Some(at) => Err(Finding::failed(format!(
            "a retune before a motion and a motion before a retune: sample {at} differs"
        ))),
    }
}

/// Plays a finger that moves back and forth at different speeds and stops.
fn there_and_back(voice: &mut ModelVoice, samples: usize) -> Result<(), Finding> {
    let mut out = [0.0; BETWEEN];
    for i in 0..samples / BETWEEN {
        let angle = i as f64 * 0.1;
        voice.set_motion(Motion {
            speed_mm_s: 100.0 * angle.cos(),
            force_n: 0.5 + 0.5 * (0.7 * angle).sin(),
            position_mm: 10.0 * angle.sin(),
            x_mm: 8.0 * angle.sin(),
            y_mm: 6.0 * (0.5 * angle).cos(),
        })?;
        voice.render(&mut out)?;
    }
    voice.set_motion(Motion {
        speed_mm_s: 0.0,
        force_n: 0.0,
        position_mm: 0.0,
        x_mm: 0.0,
        y_mm: 0.0,
    })?;
    Ok(voice.render(&mut out)?)
}

/// Checks fits at known, partly known and unknown conditions. A host without the extension passes
/// an unknown condition.
fn fits_take_conditions(case: &Case) -> Result<(), Finding> {
    let known = |speed_mm_s, force_n| FitCondition { speed_mm_s, force_n };
    let conditions = [
        known(Some(80.0), Some(0.4)),
        known(Some(80.0), None),
        known(None, Some(0.4)),
        known(None, None),
    ];
    for reference in REFERENCES {
        for condition in conditions {
            match case.fit_at(reference, condition) {
                Err(error) if !is_cannot_fit(&error) => {
                    let name = reference.name;
                    let what = format!("spectrum `{name}` at {condition:?}: {error}");
                    return Err(Finding::failed(what));
                }
                _ => {}
            }
        }
    }
    for (speed_mm_s, force_n) in [(-1.0, 0.4), (80.0, -1.0), (f64::INFINITY, 0.4)] {
        let condition = known(Some(speed_mm_s), Some(force_n));
        // CANNOT_FIT concerns only the spectrum, so the model accepted the condition before.
        let taken = REFERENCES.iter().find(
            |reference| !matches!(case.fit_at(reference, condition), Err(e) if !is_cannot_fit(&e)),
        );
        if taken.is_some() {
            return Err(Finding::failed(format!(
                "`htex_motion_1_fit` accepts {speed_mm_s} mm/s and {force_n} N; it must return HTEX_INVALID_ARGUMENT"
            )));
        }
    }
    Ok(())
}
