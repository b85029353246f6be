//! Converts samples from the models' rate to the device's rate. Surfaces with the same rate are
//! added first and converted together.

use htex_dsp::resample::{Resampler, UnusableRates, Work};

use super::{Entry, Need, Stage, StagePlace};
use crate::file::Effect;
use crate::played::PlayedSurface;
use crate::requirements::Requirements;

pub(crate) const ENTRY: Entry = Entry {
    effect: Effect::Resampling,
    name: "resampling",
    place: StagePlace::Mix { need, build },
};

fn need(required: &Requirements, played: &PlayedSurface) -> Need {
    match work(required, played) {
        Ok(Some(_)) if played.mix_rate_hz * played.fixed_ratio == required.rate_hz => {
            Need::yes(format!(
                "the model has its own rate of {:.0} Hz, and its level is the one at higher rates",
                required.rate_hz
            ))
        }
        // Planning the stage refuses rates that cannot be converted.
        Ok(Some(_)) | Err(_) => Need::yes(format!(
            "the model renders at {:.0} Hz, the device runs at {:.0} Hz",
            played.mix_rate_hz * played.fixed_ratio,
            required.rate_hz
        )),
        Ok(None) => Need::no(format!("model and device run at {:.0} Hz", required.rate_hz)),
    }
}

/// Returns the input rate, the output rate and the highest frequency of a surface's converter,
/// hertz. They include the surface's constant frequency ratio.
fn rates(required: &Requirements, played: &PlayedSurface) -> (f64, f64, f64) {
    let ratio = played.fixed_ratio;
    (played.mix_rate_hz * ratio, required.rate_hz, played.top_hz * ratio)
}

/// Returns the work per sample of the device, or `None` if no conversion is needed.
pub(crate) fn work(
    required: &Requirements,
    played: &PlayedSurface,
) -> Result<Option<Work>, UnusableRates> {
    let (from, to, top) = rates(required, played);
    Resampler::work(from, to, top, played.own_rate)
}

fn build(
    required: &Requirements,
    played: &PlayedSurface,
    neutral: bool,
) -> Result<Box<dyn Stage>, UnusableRates> {
    let (from, to, top) = rates(required, played);
    Ok(Box::new(if neutral {
        Resampling(None)
    } else if played.own_rate {
        Resampling(Resampler::of_own_rate(from, to, top)?)
    } else {
        Resampling(Resampler::new(from, to, top)?)
    }))
}

struct Resampling(Option<Resampler>);

impl Stage for Resampling {
    fn render(&mut self, out: &mut [f32], source: &mut dyn FnMut(&mut [f32])) {
        match &mut self.0 {
            Some(resampler) => resampler.process(out, source),
            None => source(out),
        }
    }
}
