//! Compensates the frequency response H of the finger on the display, so that the friction on the
//! finger has the texture's spectrum. At frequencies where |H| is large, the gain is 1/|H|. Where
//! |H| is small, the depth of the compensation limits the gain.

use htex_dsp::fir::Fir;
use htex_dsp::resample::UnusableRates;

use super::{Entry, Need, Stage, StagePlace};
use crate::file::Effect;
use crate::played::PlayedSurface;
use crate::requirements::Requirements;

/// Frequency resolution of the filter, hertz. The filter is as long as four periods of this
/// frequency.
const RESOLUTION_HZ: f64 = 20.0;

pub(crate) const ENTRY: Entry = Entry {
    effect: Effect::Compensation,
    name: "compensation",
    place: StagePlace::Mix { need, build },
};

fn need(required: &Requirements, _: &PlayedSurface) -> Need {
    match &required.compensation {
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
pub(crate) fn taps(played: &PlayedSurface) -> usize {
    (4.0 * played.mix_rate_hz * played.fixed_ratio / RESOLUTION_HZ).clamp(1.0, 16_384.0) as usize
}

fn build(
    required: &Requirements,
    played: &PlayedSurface,
    neutral: bool,
) -> Result<Box<dyn Stage>, UnusableRates> {
    let fir = match &required.compensation {
        Some(inverse) if !neutral => {
            // The filter runs before the resampler, which reads the samples `fixed_ratio` times as
            // fast.
            let rate_hz = played.mix_rate_hz * played.fixed_ratio;
            Fir::with_magnitude(taps(played), rate_hz, |hz| inverse.gain_at(hz))
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
