//! Detection of signals that no finger produces: straight lines (ramps), and values that alternate
//! from sample to sample.

use htex_base::finding::Findings;

use super::{axis_words, lanes};
use crate::{Recording, segment_len};
use htex_recording::rules::{RECORDING_ALTERNATES, RECORDING_RAMP};

/// Fewest segments of a recording that is checked: 1 s. For a shorter time, the friction of a
/// finger may rise along a line.
const FEWEST_SEGMENTS: usize = 5;
/// A signal counts as a ramp if a straight line explains at least this fraction of its variance. In
/// 240 third-party recordings of fingers, tools and microphones, which last 0.8 to 19 s, the
/// fraction is at most 0.80. For the normal force of a finger it is at most 0.84.
const ALONG_LINE: f64 = 0.99;
/// Longest period of alternating values that is detected, samples: four channels interleaved in one
/// column.
const LONGEST: usize = 4;
/// A signal counts as alternating if the position of a sample within such a period explains at
/// least this fraction of the variance. In the third-party recordings the fraction is at most
/// 0.0005.
const BY_PLACE: f64 = 0.5;

/// Defines the findings of this module, for `spec/recording-findings.md`.
pub(super) fn definition() -> String {
    format!(
        "- `RECORDING_RAMP`: an axis of at least {FEWEST_SEGMENTS} segments, not of one value, whose squared correlation with the number of the sample is at least {ALONG_LINE}.\n\
         - `RECORDING_ALTERNATES`: an axis as long, without this finding. For a period *p* of 2 to {LONGEST} samples, each of the *p* places in it has the mean of its samples; the weighted variance of \
         these means about the axis' mean, each weighted by its samples, is at least {BY_PLACE} of the axis' variance. The finding names the shortest such period. It is also looked for in a coarse axis.\n"
    )
}

/// Adds a finding if the axis is a ramp or alternates, and returns whether it does.
pub(super) fn judge_axis(recording: &Recording, axis: usize, findings: &mut Findings) -> bool {
    let values = &recording.axes[axis];
    let (name, words) = (recording.axis_name(axis), axis_words(recording, axis));
    if values.len() < FEWEST_SEGMENTS * segment_len(recording.rate_hz) {
        return false;
    }
    let Some(centred) = CentredSums::new(values) else {
        return false;
    };
    let pointer = format!("/{name}");
    let along = centred.along_line();
    if along >= ALONG_LINE {
        findings.add(RECORDING_RAMP, pointer, format!(
            "the {words} is a straight line to {:.1} % of its variance; check the sensor and that the column is neither a time, a counter nor a position",
            100.0 * along
        ));
        return true;
    }
    let periods = (2..=LONGEST).map(|period| (period, centred.by_place(period)));
    let Some((period, part)) = periods.into_iter().find(|(_, part)| *part >= BY_PLACE) else {
        return false;
    };
    findings.add(RECORDING_ALTERNATES, pointer, format!(
        "the {words} repeats every {period} samples, which is {:.1} % of its variance; check whether the column holds several channels in turn",
        100.0 * part
    ));
    true
}

/// After this number of samples, the positions within all periods up to [`LONGEST`] repeat.
const ROUND: usize = 12;

/// Sums over the values of an axis, from which the mean is subtracted. The values are relative to
/// the largest one, so that no square overflows.
struct CentredSums {
    count: usize,
    squares: f64,
    /// Sum over all values of the value times its sample index.
    moment: f64,
    /// For each position within [`ROUND`] samples, the sum of the values at this position.
    places: [f64; ROUND],
}

impl CentredSums {
    /// `None` if all values of the axis are the same.
    fn new(values: &[f64]) -> Option<Self> {
        let largest = lanes::largest(values, f64::abs);
        if largest == 0.0 || values.iter().all(|x| *x == values[0]) {
            return None;
        }
        // A subnormal number may have no finite inverse.
        let scale = 1.0 / largest.max(f64::MIN_POSITIVE);
        let mean = lanes::sum(values, |_, x| x * scale) / values.len() as f64;
        let (mut places, mut squares, mut moments) = ([0.0; ROUND], [0.0; ROUND], [0.0; ROUND]);
        for (round, values) in values.chunks(ROUND).enumerate() {
            let first = (round * ROUND) as f64;
            for (place, value) in values.iter().enumerate() {
                let x = value * scale - mean;
                places[place] += x;
                squares[place] += x * x;
                moments[place] += (first + place as f64) * x;
            }
        }
        let squares = squares.iter().sum();
        let moment = moments.iter().sum();
        (squares > 0.0).then_some(Self { count: values.len(), squares, moment, places })
    }

    /// Squared correlation of the values with the sample index.
    fn along_line(&self) -> f64 {
        let count = self.count as f64;
        let both = self.moment - 0.5 * (count - 1.0) * self.places.iter().sum::<f64>();
        // The mean is subtracted from the sample indices. This is the sum of the squares of the
        // results.
        let own = count * (count * count - 1.0) / 12.0;
        both * both / (own * self.squares)
    }

    /// Returns the fraction of the variance that the position within a period explains. The period
    /// must divide [`ROUND`].
    fn by_place(&self, period: usize) -> f64 {
        let of_place = |place: usize| {
            let sum: f64 = self.places.iter().skip(place).step_by(period).sum();
            sum * sum / (self.count - place).div_ceil(period) as f64
        };
        (0..period).map(of_place).sum::<f64>() / self.squares
    }
}
