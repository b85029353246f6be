//! From the rate of the models to the rate of the device: once, for all surfaces of a rate together.

use htex_dsp::resample::Resampler;

use super::{Entry, Need, Place, Stage};
use crate::call::{Call, Part};
use crate::file::Effect;

pub(crate) const ENTRY: Entry = Entry {
    effect: Effect::Resampling,
    name: "resampling",
    place: Place::Mix { need, build },
};

fn need(call: &Call, part: &Part) -> Need {
    match resampler(call, part) {
        Some(_) => Need::yes(format!(
            "the model renders at {:.0} Hz, the device runs at {:.0} Hz",
            part.mix_rate_hz * part.fixed_ratio,
            call.rate_hz
        )),
        None => Need::no(format!("model and device run at {:.0} Hz", call.rate_hz)),
    }
}

/// The converter that a surface needs; a speed that never changes is in its ratio.
pub(crate) fn resampler(call: &Call, part: &Part) -> Option<Resampler> {
    Resampler::new(
        part.mix_rate_hz * part.fixed_ratio,
        call.rate_hz,
        part.top_hz * part.fixed_ratio,
    )
}

fn build(call: &Call, part: &Part, neutral: bool) -> Box<dyn Stage> {
    Box::new(Resampling(resampler(call, part).filter(|_| !neutral)))
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
