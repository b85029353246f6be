//! Checks that compare a voice's samples with its magnitude.

use htex_dsp::grid::level_rms;
use htex_host::{Band, Stream};

use crate::harness::{CheckResult, Finding};
use crate::model::case::{Case, Fitted, RATE_HZ, is_refusal};
use crate::model::checks::arrays;
use crate::model::checks::magnitude::fine_grid;
use crate::model::signal::{
    distance_db, is_line_spectrum, measured_spectrum, read_as_noise, rms, rms_spread,
};

/// Duration of the measured sounds, seconds. With a minute of noise, each bin is measured within
/// 0.2 dB.
pub(crate) const SECONDS: f64 = 60.0;
/// Duration of the sounds that are searched for invalid samples, seconds.
const SEARCHED: usize = 20;
/// Allowed relative error of an RMS.
const LEVEL: f64 = 0.02;
/// Allowed deviation of the level of noise, in standard deviations.
const SPREADS: f64 = 4.0;
/// Allowed distance of the sound's spectrum from the magnitude, dB RMS.
pub(crate) const SPECTRUM_DB: f64 = 1.0;

fn about(fitted: &Fitted, what: &str) -> Finding {
    Finding::failed(format!("spectrum `{}`: {what}", fitted.reference))
}

/// A band narrower than the one in which references are fitted. Two references have peaks outside
/// it.
const NARROW: Band = Band { low_hz: 150.0, high_hz: 700.0 };
/// Allowed difference of the level in the narrow band from 1, dB. A band filter of order 4 passes
/// this much outside the band.
const NARROW_DB: f64 = 1.5;

/// Renders one second of every reference.
pub(crate) fn renders(case: &Case) -> CheckResult {
    arrays::blocks(case, &case.parameters()?)?;
    let mut voices = 0.0;
    for fitted in case.fitted()? {
        let mut out = vec![0.0; RATE_HZ as usize];
        let rendered = case
            .stream(&fitted.parameters, case.seed)
            .and_then(|mut stream| stream.render(&mut out));
        rendered.map_err(|error| about(&fitted, &error.to_string()))?;
        if out.iter().all(|&x| x == 0.0) {
            return Err(about(&fitted, "all samples of a second are zero"));
        }
        voices += 1.0;
    }
    Ok(Finding::passed(format!("{voices} voices render a second each")).with("voices", voices))
}

/// Checks that no sample is infinite, NaN or subnormal, even after retunes.
pub(crate) fn clean(case: &Case) -> CheckResult {
    let sets = case.fitted()?;
    let mut samples = 0.0;
    for fitted in &sets {
        let mut voice = case.voice(&fitted.parameters, case.seed)?;
        let rate_hz = case.model.voice_rate_hz(&fitted.parameters, Band::TACTILE, RATE_HZ)?;
        let mut out = vec![0.0f32; rate_hz as usize];
        for second in 0..SEARCHED {
            voice.render(&mut out)?;
            let ill = out.iter().position(|x| !x.is_finite() || x.is_subnormal());
            if let Some(i) = ill {
                let what = format!("sample {i} of second {second} is {:e}", out[i]);
                return Err(about(fitted, &what));
            }
            samples += out.len() as f64;
            voice.retune(&sets[second % sets.len()].parameters)?;
        }
    }
    Ok(Finding::passed(format!("{samples} samples are normal numbers or 0"))
        .with("samples", samples))
}

/// Renders one minute at the rate of the recordings.
fn listen(case: &Case, fitted: &Fitted) -> Result<Vec<f32>, Finding> {
    let mut out = vec![0.0; (SECONDS * RATE_HZ) as usize];
    case.stream(&fitted.parameters, case.seed)?.render(&mut out)?;
    Ok(out)
}

/// Checks that the magnitude and the sound have an RMS of 1, in total or in the bins of the band.
pub(crate) fn level(case: &Case) -> CheckResult {
    let mut worst: f64 = 0.0;
    for fitted in case.fitted()? {
        let magnitude = case.magnitude(&fitted.parameters)?;
        let sound = listen(case, &fitted)?;
        let (told, read) = (level_rms(&magnitude), level_rms(&measured_spectrum(&sound)));
        // Uses the RMS of the whole sound or of the band's bins, whichever is nearer to 1.
        let in_all = rms(&sound);
        let is_nearer = (read - 1.0).abs() < (in_all - 1.0).abs();
        let heard = if is_nearer { read } else { in_all };
        let fine = fine_grid();
        let fine = case.model.magnitude(&fitted.parameters, Band::TACTILE, &fine)?;
        let lines = is_line_spectrum(&fine);
        let allowed = LEVEL.max(SPREADS * rms_spread(&magnitude, SECONDS));
        if !lines && (told - 1.0).abs() > LEVEL {
            let what = format!("the magnitude's RMS is {told:.4}; it must be 1 within {LEVEL}");
            return Err(about(&fitted, &what).with("magnitude_rms", told));
        }
        if (heard - 1.0).abs() > allowed {
            let what = format!("the sound's RMS is {heard:.4}; it must be 1 within {allowed:.3}");
            return Err(about(&fitted, &what).with("sound_rms", heard));
        }
        worst = worst.max((heard - 1.0).abs());
    }
    let message = format!("RMS within {:.2} % of 1", 100.0 * worst);
    Ok(Finding::passed(message).with("sound_rms_error", worst))
}

/// Returns the distance (dB RMS) of a sound at [`RATE_HZ`] from a magnitude, or its distance from
/// the spectrum that the window measures for noise with this magnitude, whichever is smaller. The
/// second comparison is needed because the window blurs a steep flank at the edge of the band by
/// more than the allowed distance.
pub(crate) fn spectrum_distance_db(sound: &[f32], magnitude: &[f64]) -> f64 {
    let heard = measured_spectrum(sound);
    let blurred = distance_db(&heard, &read_as_noise(magnitude));
    distance_db(&heard, magnitude).min(blurred)
}

/// Compares the sound's spectrum with the magnitude.
pub(crate) fn spectrum(case: &Case) -> CheckResult {
    let mut worst: f64 = 0.0;
    for fitted in case.fitted()? {
        let magnitude = case.magnitude(&fitted.parameters)?;
        let distance = spectrum_distance_db(&listen(case, &fitted)?, &magnitude);
        // The condition is negated so that NaN fails.
        if !matches!(distance.partial_cmp(&SPECTRUM_DB), Some(o) if o.is_le()) {
            let what = format!(
                "the sound is {distance:.2} dB RMS from the magnitude; {SPECTRUM_DB} dB is allowed"
            );
            return Err(about(&fitted, &what).with("distance_db", distance));
        }
        worst = worst.max(distance);
    }
    let message = format!("the sound is within {worst:.2} dB RMS of the magnitude");
    Ok(Finding::passed(message).with("distance_db", worst))
}

/// Checks that the RMS is 1 in a band that is narrower than the band of the fit, and that there is
/// silence outside it.
pub(crate) fn narrow_band(case: &Case) -> CheckResult {
    let grid = NARROW.grid_hz();
    let (mut worst, mut voices) = (0.0f64, 0.0);
    for fitted in case.fitted()? {
        let parameters = &fitted.parameters;
        match case.model.magnitude(parameters, NARROW, &grid) {
            Err(error) if is_refusal(&error) => continue,
            magnitude => magnitude?,
        };
        let mut stream = Stream::new(&case.model, parameters, NARROW, RATE_HZ, case.seed)?;
        let mut out = vec![0.0; (SECONDS * RATE_HZ) as usize];
        stream.render(&mut out)?;
        let first = NARROW.first_bin() - Band::TACTILE.first_bin();
        let heard = &measured_spectrum(&out)[first..first + grid.len()];
        for (level, place) in [(level_rms(heard), "in the band"), (rms(&out), "in total")] {
            let off_db = 20.0 * level.log10();
            // The condition is negated so that NaN fails.
            if !matches!(off_db.abs().partial_cmp(&NARROW_DB), Some(o) if o.is_le()) {
                let what = format!(
                    "in the band {} to {} Hz the sound's RMS {place} differs from 1 by {off_db:.2} dB; {NARROW_DB} dB \
                     are allowed: frequencies outside the band must be silent",
                    NARROW.low_hz, NARROW.high_hz
                );
                return Err(about(&fitted, &what).with("level_db", off_db));
            }
            worst = worst.max(off_db.abs());
        }
        voices += 1.0;
    }
    let message = format!("the RMS of {voices} sounds is within {worst:.2} dB of 1 in the band");
    Ok(Finding::passed(message).with("level_db", worst))
}
