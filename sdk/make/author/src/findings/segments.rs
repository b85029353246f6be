//! Findings about the chosen segments and about sweeps that are left out.

use htex_base::finding::Findings;

use super::quantile::median;
use crate::{Recording, SegmentSpectra};
use htex_recording::rules::{
    RECORDING_READ_IN_WINDOWS, RECORDING_SWEEPS_CUT_OFF, RECORDING_UNEVEN,
};

/// A segment is reported if its level exceeds the median of all segments by more than this factor,
/// which is 12 dB. Changes of force and speed within 10 % cause about 1 dB. Seams and knots of a
/// material cause a few dB.
const LOUD: f64 = 4.0;
/// Loud segments are reported only if they are rare: at most one segment in this many.
const EXCEPTION: usize = 4;
/// Largest number of places named in a message.
const NAMED: usize = 5;

/// Defines the findings of this module, for `spec/recording-findings.md`.
pub(super) fn definition() -> String {
    format!(
        "- `RECORDING_UNEVEN`: the level of a segment is the root of the sum of its squared magnitudes over the band's bins, of the segment less its mean times a periodic Hann window; segments above {LOUD} times the median \
         level are loud, and the finding points to the first sample of the first. The band is from 20 Hz to 1000 Hz, or to half the rate if that is less. There is no finding if they are more than one in {EXCEPTION} of all.\n\
         - `GRID_NOT_BETTER`: in what was left out, the error of the grid is larger than the error of one condition for all motions, and the 95 % interval of the difference does not include 0. The difference is measured in each group of left-out windows; there are at least four.\n"
    )
}

/// Reports sweeps that are left out, windows that are used instead of sweeps, and segments that are
/// too loud.
pub(crate) fn judge_segments(
    recording: &Recording,
    part: &SegmentSpectra,
    findings: &mut Findings,
) {
    let segments = &part.segments;
    if segments.from_sweeps && segments.cut_off > 0 {
        let (n, all) = (segments.cut_off, segments.sweeps.len());
        let message = format!(
            "{n} of {all} sweeps left out: cut off by the beginning or the end of the recording"
        );
        findings.add(RECORDING_SWEEPS_CUT_OFF, "/lateral", message);
    }
    if let Some(unread) = segments.unread {
        findings.add(RECORDING_READ_IN_WINDOWS, "/lateral", format!(
            "read in windows ({}): its sweeps represent {:.1} of {:.1} s of sliding; the choice of sweeps reads only their middles",
            seconds_read(recording, part),
            unread.represented_s,
            unread.sliding_s
        ));
    }
    judge_levels(recording, part, findings);
}

/// Returns a list of the stretches that are read, in seconds.
fn seconds_read(recording: &Recording, part: &SegmentSpectra) -> String {
    let stretches = part.segments.stretches();
    let second = |sample| recording.second(sample);
    let named = stretches.iter().take(NAMED);
    let mut named: Vec<String> = named
        .map(|part| format!("{:.1} to {:.1} s", second(part.start), second(part.end)))
        .collect();
    if stretches.len() > NAMED {
        named.push(format!("{} more", stretches.len() - NAMED));
    }
    named.join(", ")
}

fn judge_levels(recording: &Recording, part: &SegmentSpectra, findings: &mut Findings) {
    let level = |bins: &Vec<_>| {
        bins.iter().map(htex_dsp::spectrum::Complex::<f64>::norm_sqr).sum::<f64>().sqrt()
    };
    let levels: Vec<f64> = part.spectra.iter().map(level).collect();
    let usual = median(&levels).unwrap_or(0.0);
    let starts = &part.segments.starts;
    let loud: Vec<(usize, f64)> = starts
        .iter()
        .zip(&levels)
        .filter(|(_, level)| usual > 0.0 && **level > LOUD * usual)
        .map(|(start, level)| (*start, *level))
        .collect();
    // If many segments are loud, the motion changes during the whole recording. Other findings
    // report this.
    let Some((first, _)) = loud.first().filter(|_| loud.len() <= levels.len() / EXCEPTION) else {
        return;
    };
    let place = |(start, level): &(usize, f64)| {
        let to = recording.second(start + part.segments.len);
        format!(
            "{:.2} to {to:.2} s by {:.1} dB",
            recording.second(*start),
            20.0 * libm::log10(level / usual)
        )
    };
    let mut named: Vec<String> = loud.iter().take(NAMED).map(place).collect();
    if loud.len() > NAMED {
        named.push(format!("{} more", loud.len() - NAMED));
    }
    let message = format!(
        "{} of {} segments are 12 dB or more above the median of all: {}; check them and choose a range",
        loud.len(),
        levels.len(),
        named.join(", ")
    );
    findings.add(
        RECORDING_UNEVEN,
        super::pointer(recording, recording.axis_name(0), *first),
        message,
    );
}
