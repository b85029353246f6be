//! Warnings about what limits a measured response, as sentences.

use super::measured::MeasuredResponse;
use super::options::{Excitation, ResponseOptions};
use super::pieces::Cut;
use super::record::Record;

/// Number of averages below which the coherence says little.
const FEW: usize = 5;
/// Coherence below which the response is uncertain.
const COHERENT: f64 = 0.9;
/// Largest distance between two stretches of low coherence, relative to their frequency, at which
/// they are reported as one.
const NEAR: f64 = 0.1;

/// Returns the warnings about a measured response. `outlasting` is the number of hits whose
/// response has not died out.
pub(crate) fn notices(
    measured: &MeasuredResponse,
    options: &ResponseOptions,
    outlasting: usize,
) -> Vec<String> {
    let mut found = Vec::new();
    if measured.averages < FEW {
        found.push(format!(
            "Only {} are averaged; the coherence of fewer than {FEW} is high by chance.",
            measured.averages
        ));
    }
    if let Some(stretches) = incoherent(measured) {
        found.push(format!(
            "The coherence falls below {COHERENT} {stretches}; the response is uncertain there."
        ));
    }
    if let Excitation::Hits(hit) = &options.excitation {
        if outlasting > 0 {
            found.push(format!(
                "The response of {outlasting} of {} hits has not died out at the end of its window of {} s; lengthen the \
                 window, or give an exponential one.",
                measured.averages, measured.window_s
            ));
        }
        if let Some(tau_s) = hit.exponential_s {
            found.push(format!(
                "The exponential window raises the damping of every resonance by {:.4} 1/s: peaks are lower and wider.",
                1.0 / tau_s
            ));
        }
    }
    found
}

/// Returns a warning for each record in which no hit or window was found.
pub(crate) fn without_hits(records: &[Record], cuts: &[Vec<Cut>]) -> Vec<String> {
    let both = records.iter().zip(cuts);
    let empty = both.filter(|(_, cuts)| cuts.is_empty());
    empty.map(|(record, _)| format!("{}: no hit found.", record.file())).collect()
}

/// Describes the stretches of low coherence. Stretches closer to each other than a tenth of their
/// frequency are merged.
fn incoherent(measured: &MeasuredResponse) -> Option<String> {
    let mut stretches: Vec<(f64, f64)> = Vec::new();
    let both = measured.frequency_hz.iter().zip(&measured.coherence);
    for (hz, _) in both.filter(|(_, coherence)| **coherence < COHERENT) {
        match stretches.last_mut() {
            Some(last) if hz - last.1 <= NEAR * hz => last.1 = *hz,
            _ => stretches.push((*hz, *hz)),
        }
    }
    let words: Vec<String> = stretches.into_iter().map(words).collect();
    (!words.is_empty()).then(|| words.join(", "))
}

fn words((low_hz, high_hz): (f64, f64)) -> String {
    if low_hz == high_hz {
        format!("at {low_hz:.1} Hz")
    } else {
        format!("between {low_hz:.1} and {high_hz:.1} Hz")
    }
}
