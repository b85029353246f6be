//! What an output does to a finger: direct voltage and the largest voltage.

use crate::bench::GAIN;

/// Time over which direct voltage is measured, seconds.
const WINDOW_S: f64 = 0.1;

/// Voltages at the display.
pub struct Volts {
    /// Largest magnitude of the mean over any 100 ms, volts.
    pub dc_v: f64,
    /// Largest magnitude, volts.
    pub peak_v: f64,
}

/// Measures the voltages of a card, with zeros before and after them.
pub fn volts(card_v: &[f64], rate_hz: f64) -> Volts {
    let window = (WINDOW_S * rate_hz).round() as usize;
    let (mut sum, mut dc) = (0.0, 0.0f64);
    for (i, v) in card_v.iter().enumerate() {
        sum += v;
        if i >= window {
            sum -= card_v[i - window];
        }
        dc = dc.max(sum.abs() / window as f64);
    }
    let peak = card_v.iter().fold(0.0f64, |peak, v| peak.max(v.abs()));
    Volts { dc_v: GAIN * dc, peak_v: GAIN * peak }
}
