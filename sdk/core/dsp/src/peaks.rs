//! Finds the peaks of a spectrum, and selects peaks whose frequencies differ perceptibly (paper,
//! Spectral peaks).

use alloc::collections::BinaryHeap;
use alloc::vec::Vec;
use core::cmp::Ordering;

/// Just noticeable difference (JND) of vibration frequency, as a fraction of the lower frequency.
pub const FREQUENCY_JND: f64 = 0.12;

/// One peak of a spectrum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Peak {
    pub frequency_hz: f64,
    /// Magnitude, in the unit of the spectrum.
    pub magnitude: f64,
}

/// Returns the indices of the local maxima, ascending. A plateau counts once, and only if the
/// values fall on both sides. The index of a plateau is the index of its middle, or the lower index
/// if it has two middle values. The first and the last value are never maxima. Matches
/// `scipy.signal.find_peaks`.
///
/// ```
/// use htex_dsp::peaks::local_maxima;
/// assert_eq!(local_maxima(&[0.0, 1.0, 0.0, 2.0, 2.0, 2.0, 1.0, 3.0]), [1, 4]);
/// ```
pub fn local_maxima(values: &[f64]) -> Vec<usize> {
    let mut maxima = Vec::new();
    let last = values.len().saturating_sub(1);
    let mut i = 1;
    while i < last {
        let mut next = i + 1;
        if values[i - 1] < values[i] {
            while next < last && values[next] == values[i] {
                next += 1;
            }
            if values[next] < values[i] {
                maxima.push((i + next - 1) / 2);
            }
        }
        i = next;
    }
    maxima
}

/// Selects the strongest local maxima that are at least `jnd` apart, ascending in frequency.
///
/// The function considers the maxima in order of strength; of two equally strong maxima, the lower
/// frequency comes first. The function selects a peak at the frequency f if
/// `|f - g| / min(f, g) >= jnd` for the frequency g of every peak selected before. The function
/// ends when it has selected `max_count` peaks.
///
/// `frequency_hz` is ascending, in hertz. If `frequency_hz` and `magnitude` differ in
/// length, the excess values of the longer slice are ignored. A spectrum without local maxima gives
/// an empty list.
pub fn select_peaks(
    frequency_hz: &[f64],
    magnitude: &[f64],
    max_count: usize,
    jnd: f64,
) -> Vec<Peak> {
    let magnitude = &magnitude[..magnitude.len().min(frequency_hz.len())];
    let at_bin = |bin: usize| Peak { frequency_hz: frequency_hz[bin], magnitude: magnitude[bin] };
    select_distinct(local_maxima(magnitude).into_iter().map(at_bin), max_count, jnd)
}

/// Selects the strongest peaks that are at least `jnd` apart, as [`select_peaks`] does.
pub(crate) fn select_distinct(
    peaks: impl Iterator<Item = Peak>,
    max_count: usize,
    jnd: f64,
) -> Vec<Peak> {
    // A heap needs less code than a sort, and only few of the peaks are needed.
    let mut candidates: BinaryHeap<Candidate> = peaks.map(Candidate).collect();
    let mut kept: Vec<Peak> = Vec::new();
    while let Some(Candidate(peak)) = candidates.pop() {
        if kept.len() == max_count {
            break;
        }
        if kept.iter().all(|other| distinct(&peak, other, jnd)) {
            let place = kept.partition_point(|other| other.frequency_hz < peak.frequency_hz);
            kept.insert(place, peak);
        }
    }
    kept
}

/// A peak, ordered by magnitude. Of two peaks with equal magnitudes, the peak with the lower
/// frequency is greater.
#[derive(PartialEq)]
struct Candidate(Peak);

impl Eq for Candidate {}

impl PartialOrd for Candidate {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Candidate {
    fn cmp(&self, Self(other): &Self) -> Ordering {
        let Self(own) = self;
        let by_magnitude = own.magnitude.total_cmp(&other.magnitude);
        by_magnitude.then(other.frequency_hz.total_cmp(&own.frequency_hz))
    }
}

fn distinct(a: &Peak, b: &Peak, jnd: f64) -> bool {
    let distance = (a.frequency_hz - b.frequency_hz).abs();
    distance / a.frequency_hz.min(b.frequency_hz) >= jnd
}
