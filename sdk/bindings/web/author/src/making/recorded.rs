//! Converts recordings to sound.

use htex_author::RecordedLoop;
use htex_format::Quantity;
use serde::Serialize;

use super::recordings::{GivenCondition, Reading, given};
use crate::answer::{Answer, Files};
use crate::document::Document;
use crate::refusal::Refusal;

#[derive(Serialize)]
struct Loop<'a> {
    recording: &'a str,
    condition: Condition,
    quantity: Quantity,
    unit: &'static str,
    rate_hz: f64,
    level_rms: f64,
    segments: usize,
    /// Number of samples in the loop.
    samples: usize,
}

#[derive(Serialize)]
struct Condition {
    speed: Option<f64>,
    force: Option<f64>,
}

/// Makes a loop from each recording. The bytes of the answer are the samples of all loops in single
/// precision, one loop after the other.
pub(crate) fn recorded(mut call: Document, files: Files<'_>) -> Result<Answer, Refusal> {
    let names = call.object("files")?;
    let conditions = call
        .list("conditions")?
        .into_iter()
        .map(given)
        .collect::<Result<Vec<GivenCondition>, _>>()?;
    let rate_hz = call
        .number("rate")?
        .ok_or_else(|| Refusal::argument("give the rate of the samples, Hz"))?;
    let mut settings = call.object("settings")?;
    call.finish()?;
    let reading = Reading::new(names, &mut settings, files)?;
    settings.finish()?;
    let takes = reading.takes(&conditions)?;
    let loops = takes
        .iter()
        .map(|take| {
            RecordedLoop::new(take, &reading.spectrum, reading.strict, rate_hz)
                .map(|made| (take.recording.source.as_str(), made))
        })
        .collect::<Result<Vec<_>, _>>()?;
    let told: Vec<Loop<'_>> = loops.iter().map(|(name, made)| told(name, made)).collect();
    let samples = loops.iter().flat_map(|(_, made)| &made.samples);
    let bytes = samples.flat_map(|sample| (*sample as f32).to_le_bytes());
    Answer::new(&told, bytes.collect())
}

fn told<'a>(recording: &'a str, made: &RecordedLoop) -> Loop<'a> {
    Loop {
        recording,
        condition: Condition { speed: made.condition.speed_mm_s, force: made.condition.force_n },
        quantity: made.quantity,
        unit: made.quantity.unit(),
        rate_hz: made.rate_hz,
        level_rms: made.level_rms,
        segments: made.segments,
        samples: made.samples.len(),
    }
}
