//! Converts samples from the textures' unit to the device's unit. The result depends on the device.
//! If the scene states a gain for the conversion to the device's physical unit, the result is in
//! this unit. For a sound device, the result has the preview level that the scene sets. For an
//! electrovibration display, the result is the radicand from which the square-root stage computes
//! the drive voltage.

use htex_device::Quantity;

use super::{Entry, Need, Stage, StagePlace};
use crate::file::Effect;
use crate::requirements::Requirements;

/// Assumed peak of a stream, as a multiple of its RMS. The magnitude of normally distributed noise
/// exceeds it about once in 150,000 samples. The sum of ten equal sinusoids never exceeds it.
pub(crate) const HEADROOM: f64 = 4.5;

/// A stream with an RMS below this value, in the textures' unit, counts as silent, because its gain
/// would not be finite.
const LEAST_RMS: f64 = 1e-20;

pub(crate) const ENTRY: Entry =
    Entry { effect: Effect::Gain, name: "gain", place: StagePlace::Device { need, build } };

/// Mapping of a force to the drive voltage of an electrovibration display: V = sqrt(gain · force +
/// shift). This follows from V = V_g sqrt(y + 1), where V_g = drive / sqrt(2), and y is the force
/// divided by [`HEADROOM`] times its RMS.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Drive {
    /// V² per unit of the textures.
    pub(crate) gain: f64,
    /// Shift, V².
    pub(crate) shift: f64,
}

impl Drive {
    pub(crate) fn new(required: &Requirements) -> Self {
        let half = required.drive_v * required.drive_v / 2.0;
        Self { gain: brings_level_to(half / HEADROOM, required), shift: half }
    }
}

/// Returns the gain that maps the scene's reference level to `level`. Returns 0 if there is no
/// reference level.
fn brings_level_to(level: f64, required: &Requirements) -> f64 {
    if required.level_rms > LEAST_RMS { level / required.level_rms } else { 0.0 }
}

fn need(required: &Requirements) -> Need {
    match required.device.quantity {
        Quantity::Sound => Need::yes(format!(
            "the level is set to {} dB relative to full scale for listening",
            required.level_dbfs
        )),
        Quantity::DisplayVoltage => Need::yes(format!(
            "{HEADROOM} times the RMS reaches the drive's largest voltage, {} V",
            required.drive_v
        )),
        _ if required.quantity_gain != 1.0 => Need::yes(format!(
            "one {} is played as {} {}",
            required.quantity.unit(),
            required.quantity_gain,
            required.device.quantity.unit()
        )),
        _ if required.gain_db == 0.0 => {
            let unit = required.device.quantity.unit();
            Need::no(format!("the device takes {unit}, and no gain is given"))
        }
        _ => Need::yes(format!("a gain of {} dB is given", required.gain_db)),
    }
}

fn build(required: &Requirements, neutral: bool) -> Box<dyn Stage> {
    let db = |db: f64| libm::pow(10.0, db / 20.0);
    let gain = match required.device.quantity {
        _ if neutral => 1.0,
        Quantity::Sound => brings_level_to(db(required.level_dbfs), required),
        Quantity::DisplayVoltage => Drive::new(required).gain,
        _ => required.quantity_gain * db(required.gain_db),
    };
    Box::new(Gain(gain as f32))
}

struct Gain(f32);

impl Stage for Gain {
    fn render(&mut self, out: &mut [f32], source: &mut dyn FnMut(&mut [f32])) {
        source(out);
        let gain = self.0;
        out.iter_mut().for_each(|sample| *sample *= gain);
    }
}
