//! Checks how a voice changes from one parameter set to another.

use crate::harness::{CheckResult, Finding};
use crate::model::case::{Case, RATE_HZ};
use crate::model::checks::sound::{SECONDS, SPECTRUM_DB, spectrum_distance_db};
use crate::model::signal::{distance_db, sharpest_bend};

/// Number of samples: two seconds at the rate of the recordings.
const SAMPLES: usize = 40_000;
/// Number of samples between two retunes.
const BETWEEN: usize = 500;
/// Largest allowed second difference of the samples around a retune, relative to the sounds without
/// retunes.
const SHARPER: f32 = 2.0;
/// Minimum distance between two spectra, dB RMS, so that a retune from one to the other can be
/// measured. It is three times the allowed error of a sound.
const APART_DB: f64 = 3.0;
/// Largest allowed sample in a sound of unit RMS.
const LOUDEST: f32 = 100.0;

/// Checks that second differences at retunes are not much larger than in the sounds without
/// retunes.
pub(crate) fn retune(case: &Case) -> CheckResult {
    let Some((a, b)) = case.two_sets()? else {
        return Ok(Finding::skipped("all reference spectra have the same parameters"));
    };
    let middle = case.model.interpolate(&[&a, &b], &[0.5, 0.5]);
    let sets = [a.clone(), middle.unwrap_or(a), b];
    let mut steady: f32 = 0.0;
    for set in &sets {
        let mut out = vec![0.0; SAMPLES];
        case.stream(set, case.seed)?.render(&mut out)?;
        steady = steady.max(sharpest_bend(&out));
    }
    let mut stream = case.stream(&sets[0], case.seed)?;
    let mut out = vec![0.0; SAMPLES];
    for (i, block) in out.chunks_mut(BETWEEN).enumerate() {
        stream.retune(&sets[i % sets.len()])?;
        stream.render(block)?;
    }
    let ratio = sharpest_bend(&out) / steady;
    let finding = if ratio <= SHARPER {
        Finding::passed(format!(
            "second differences at retunes are {ratio:.2} times as large as in the same sounds without retunes"
        ))
    } else {
        Finding::failed(format!(
            "retunes click: their second differences are {ratio:.1} times as large as in the same sounds without retunes; \
             {SHARPER} times is allowed"
        ))
    };
    Ok(finding.with("bend_ratio", f64::from(ratio)))
}

/// Checks that after a retune, the sound has the spectrum of the new parameters.
pub(crate) fn follows(case: &Case) -> CheckResult {
    let sets = case.fitted()?;
    let magnitudes =
        sets.iter().map(|set| case.magnitude(&set.parameters)).collect::<Result<Vec<_>, _>>()?;
    let mut stream = case.stream(&sets[0].parameters, case.seed)?;
    let (mut worst, mut judged) = (0.0f64, 0.0);
    let mut settling = vec![0.0; RATE_HZ as usize];
    let mut sound = vec![0.0; (SECONDS * RATE_HZ) as usize];
    for i in 1..=sets.len() {
        let (before, now) = (i - 1, i % sets.len());
        stream.retune(&sets[now].parameters)?;
        // During this second, the sound of the old parameters fades out.
        stream.render(&mut settling)?;
        let apart = distance_db(&magnitudes[before], &magnitudes[now]);
        if apart.is_nan() || apart < APART_DB {
            continue;
        }
        stream.render(&mut sound)?;
        let distance = spectrum_distance_db(&sound, &magnitudes[now]);
        // The condition is negated so that NaN fails.
        if !matches!(distance.partial_cmp(&SPECTRUM_DB), Some(o) if o.is_le()) {
            return Err(Finding::failed(format!(
                "retuned from `{}` to `{}`, the sound is {distance:.2} dB RMS from the magnitude of the new \
                 parameters; {SPECTRUM_DB} dB is allowed",
                sets[before].reference, sets[now].reference
            ))
            .with("distance_db", distance));
        }
        worst = worst.max(distance);
        judged += 1.0;
    }
    if judged == 0.0 {
        return Ok(Finding::skipped(format!(
            "no two consecutive reference spectra have magnitudes that differ by {APART_DB} dB"
        )));
    }
    let message =
        format!("after {judged} retunes the sound is within {worst:.2} dB RMS of the magnitude");
    Ok(Finding::passed(message).with("distance_db", worst).with("retunes", judged))
}

/// Checks that interpolation reproduces the sets at its ends, and that all results can be played.
pub(crate) fn interpolate(case: &Case) -> CheckResult {
    let sets = case.fitted()?;
    if sets.len() < 2 {
        return Ok(Finding::skipped("there is only one parameter set"));
    }
    for pair in sets.windows(2) {
        let (a, b) = (&pair[0].parameters[..], &pair[1].parameters[..]);
        let between = format!("between `{}` and `{}`", pair[0].reference, pair[1].reference);
        for step in 0..=10 {
            let weight = f64::from(step) / 10.0;
            let say = |what: String| {
                Finding::failed(format!("{between}, {weight} of the second: {what}"))
            };
            let mix = case
                .model
                .interpolate(&[a, b], &[1.0 - weight, weight])
                .map_err(|error| say(error.to_string()))?;
            playable(case, &mix).map_err(|finding| say(finding.message))?;
            let end = match step {
                0 => a,
                10 => b,
                _ => continue,
            };
            // Bits are compared, so that -0 and 0 are different.
            let bits = |set: &[f64]| set.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
            if bits(&mix) != bits(end) {
                let what = format!("{mix:?} is not the set {end:?}; it must be, to the bit");
                return Err(say(what));
            }
        }
    }
    let pairs = sets.len() - 1;
    Ok(Finding::passed(format!("eleven interpolations of {pairs} pairs can be played")))
}

/// Checks that a parameter set has a magnitude and finite samples.
fn playable(case: &Case, mix: &[f64]) -> Result<(), Finding> {
    case.magnitude(mix)?;
    let mut out = vec![0.0f32; SAMPLES];
    case.stream(mix, case.seed)?.render(&mut out)?;
    match out.iter().find(|x| !x.is_finite() || x.abs() > LOUDEST) {
        None => Ok(()),
        Some(x) => Err(Finding::failed(format!("a sample is {x}"))),
    }
}
