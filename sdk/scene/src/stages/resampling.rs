//! Conversion from the rate of the models to the rate of the device, once for all surfaces of a rate.

use htex_dsp::resample::{Resampler, UnusableRates};

use super::{Entry, Need, Place, Stage};
use crate::call::{Call, Part};
use crate::file::Effect;

pub(crate) const ENTRY: Entry = Entry {
    effect: Effect::Resampling,
    name: "resampling",
    place: Place::Mix { need, build },
};

fn need(call: &Call, part: &Part) -> Need {
    match macs(call, part) {
        // Rates that cannot be converted are refused when the stage is planned.
        Ok(Some(_)) | Err(_) => Need::yes(format!(
            "the model renders at {:.0} Hz, the device runs at {:.0} Hz",
            part.mix_rate_hz * part.fixed_ratio,
            call.rate_hz
        )),
        Ok(None) => Need::no(format!("model and device run at {:.0} Hz", call.rate_hz)),
    }
}

/// Input rate, output rate and highest frequency of a surface's converter, hertz; a constant speed is
/// included in the ratio.
fn rates(call: &Call, part: &Part) -> (f64, f64, f64) {
    let ratio = part.fixed_ratio;
    (part.mix_rate_hz * ratio, call.rate_hz, part.top_hz * ratio)
}

/// Multiplications per sample of the device; `None` if no conversion is needed.
pub(crate) fn macs(call: &Call, part: &Part) -> Result<Option<f64>, UnusableRates> {
    let (from, to, top) = rates(call, part);
    Resampler::macs_per_output(from, to, top)
}

fn build(call: &Call, part: &Part, neutral: bool) -> Result<Box<dyn Stage>, UnusableRates> {
    let (from, to, top) = rates(call, part);
    Ok(Box::new(match neutral {
        true => Resampling(None),
        false => Resampling(Resampler::new(from, to, top)?),
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
