//! Compensation of the response of finger and display, so that the friction on the finger has the texture's
//! spectrum: the gain is 1/|H| where |H| is large, and is limited by the depth below the maximum in the band.

use htex_dsp::fir::Fir;
use htex_dsp::resample::UnusableRates;

use super::{Entry, Need, Place, Stage};
use crate::call::{Call, Part};
use crate::file::Effect;

/// Frequency resolution of the filter, hertz: its length is four periods of this frequency.
const RESOLUTION_HZ: f64 = 20.0;

pub(crate) const ENTRY: Entry = Entry {
    effect: Effect::Compensation,
    name: "compensation",
    place: Place::Mix { need, build },
};

fn need(call: &Call, _: &Part) -> Need {
    match &call.compensation {
        Some(inverse) => Need::yes(match inverse.raised() {
            None => "a response of the device is given, and is compensated".to_owned(),
            Some(raised) => {
                format!("a response of the device is given, and is compensated: it raises {raised}")
            }
        }),
        None => Need::no("no response of finger and display is given"),
    }
}

/// Length of the filter, samples at the rate of the mix.
pub(crate) fn taps(part: &Part) -> usize {
    (4.0 * part.mix_rate_hz * part.fixed_ratio / RESOLUTION_HZ).clamp(1.0, 16_384.0) as usize
}

fn build(call: &Call, part: &Part, neutral: bool) -> Result<Box<dyn Stage>, UnusableRates> {
    let fir = match &call.compensation {
        Some(inverse) if !neutral => {
            // The filter runs before the resampler, which reads `fixed_ratio` times as fast.
            let rate_hz = part.mix_rate_hz * part.fixed_ratio;
            Fir::with_magnitude(taps(part), rate_hz, |hz| inverse.at(hz))
        }
        _ => Fir::through(),
    };
    Ok(Box::new(Compensation(fir)))
}

struct Compensation(Fir);

impl Stage for Compensation {
    fn render(&mut self, out: &mut [f32], source: &mut dyn FnMut(&mut [f32])) {
        source(out);
        self.0.process(out);
    }
}
