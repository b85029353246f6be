//! Checks that the level and the spectrum stay the same if a voice is retuned to the same
//! parameters at every block.

use crate::harness::{CheckResult, Finding};
use crate::model::case::{Case, RATE_HZ};
use crate::model::checks::sound::spectrum_distance_db;
use crate::model::signal::{rms, rms_spread};

/// Duration of the sounds, seconds.
const SECONDS: f64 = 10.0;
/// Number of samples between two retunes. A host may retune at every block.
const BETWEEN: usize = 64;
/// Allowed difference in level from the sound without retunes, dB.
const LEVEL_DB: f64 = 0.5;
/// Allowed difference in level, in standard deviations of the level of noise of this duration and
/// spectrum.
const SPREADS: f64 = 4.0;
/// Allowed increase of the distance between the sound's spectrum and the magnitude, dB RMS.
const FURTHER_DB: f64 = 1.0;

/// Checks that retuning to the same parameters at every block changes neither the level nor the
/// spectrum.
pub(crate) fn keeps_sounding(case: &Case) -> CheckResult {
    let (mut worst_db, mut worst_further_db) = (0.0f64, 0.0f64);
    for fitted in case.fitted()? {
        let magnitude = case.magnitude(&fitted.parameters)?;
        let sound = |between: Option<usize>| -> Result<Vec<f32>, Finding> {
            let mut stream = case.stream(&fitted.parameters, case.seed)?;
            let mut out = vec![0.0; (SECONDS * RATE_HZ) as usize];
            for block in out.chunks_mut(between.unwrap_or(1_000)) {
                if between.is_some() {
                    stream.retune(&fitted.parameters)?;
                }
                stream.render(block)?;
            }
            Ok(out)
        };
        let (steady, retuned) = (sound(None)?, sound(Some(BETWEEN))?);
        let off_db = (20.0 * (rms(&retuned) / rms(&steady)).log10()).abs();
        let spread_db = 20.0 * (1.0 + SPREADS * rms_spread(&magnitude, SECONDS)).log10();
        let further_db =
            spectrum_distance_db(&retuned, &magnitude) - spectrum_distance_db(&steady, &magnitude);
        let name = fitted.reference;
        // The conditions are negated so that NaN fails.
        if !(off_db <= LEVEL_DB.max(spread_db) && further_db <= FURTHER_DB) {
            return Err(Finding::failed(format!(
                "spectrum `{name}`: retuned to the same parameters every {BETWEEN} samples, the level is {off_db:.2} dB from \
                 that without retunes and the spectrum {further_db:.2} dB further from the magnitude: a retune must not restart \
                 what sounds"
            ))
            .with("level_db", off_db)
            .with("further_db", further_db));
        }
        worst_db = worst_db.max(off_db);
        worst_further_db = worst_further_db.max(further_db);
    }
    let message = format!(
        "with retunes every {BETWEEN} samples the level changes by {worst_db:.2} dB, the distance from the magnitude by {worst_further_db:.2} dB"
    );
    Ok(Finding::passed(message).with("level_db", worst_db).with("further_db", worst_further_db))
}
