//! Makes a texture stronger and weaker in time, as in its recording. The mean square of the samples
//! does not change. A scene must switch this effect on, because nobody has tested yet whether it
//! makes a texture feel more real.

use htex_dsp::random_envelope::RandomEnvelope;

use super::{Entry, Need, Stage, StagePlace};
use crate::file::Effect;
use crate::played::PlayedSurface;
use crate::requirements::Requirements;

pub(crate) const ENTRY: Entry = Entry {
    effect: Effect::Fluctuation,
    name: "fluctuation",
    place: StagePlace::Surface { need, build: Some(build) },
};

fn need(required: &Requirements, played: &PlayedSurface) -> Need {
    match played.fluctuation {
        None => Need::no("the asset states no fluctuation in time"),
        Some(_) if !required.fluctuation => Need::no("the scene does not switch it on"),
        Some(fluctuation) => {
            Need::yes(format!("the scene switches it on; the asset states {fluctuation}"))
        }
    }
}

fn build(required: &Requirements, played: &PlayedSurface, neutral: bool) -> Box<dyn Stage> {
    // Without an envelope the stage is neutral.
    let fluctuation = played.fluctuation.filter(|_| !neutral);
    // With a constant frequency ratio, the frames are read faster, but the time of the finger stays
    // the same.
    let rate_hz = played.mix_rate_hz * played.fixed_ratio;
    let seed = required.seed.wrapping_add(played.surface as u64);
    Box::new(Fluctuating(fluctuation.map(|f| RandomEnvelope::new(f.decibels(), rate_hz, seed))))
}

struct Fluctuating(Option<RandomEnvelope>);

impl Stage for Fluctuating {
    fn render(&mut self, out: &mut [f32], source: &mut dyn FnMut(&mut [f32])) {
        source(out);
        if let Some(envelope) = &mut self.0 {
            envelope.apply(out);
        }
    }
}
