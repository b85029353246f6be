//! Where in a recording the texture is read: sweeps, or evenly spaced windows.

use crate::Recording;
use crate::sums::Sums;

/// Texture spectra have a resolution of 5 Hz: segments are a fifth of a second.
const SEGMENTS_PER_S: f64 = 5.0;
/// Half the length of the moving average that sweeps are found on (50 ms in all), seconds.
const HALF_AVERAGE_S: f64 = 0.025;
/// A recording has sweeps if between them its friction falls below this part of the threshold.
const REST_LEVEL: f64 = 0.5;

/// How segments are chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum SegmentChoice {
    /// Sweeps if the recording has them, else windows.
    #[default]
    Auto,
    /// One segment in the middle of each sweep (paper, Texture processing).
    Sweeps,
    /// Windows over the whole recording, each half over the one before (Welch 1967): side by side, Hann
    /// windows would leave half of it unread, and the level of 10 s of noise uncertain by 0.2 dB.
    Windows,
}

/// A stretch of the recording in which the friction exceeds the threshold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sweep {
    /// First sample.
    pub start: usize,
    /// One past the last sample.
    pub end: usize,
}

/// The segments of a recording.
#[derive(Debug, Clone, PartialEq)]
pub struct Segments {
    /// Samples of each segment.
    pub len: usize,
    /// First sample of each segment.
    pub starts: Vec<usize>,
    /// Whether they lie in sweeps (else: evenly spaced windows).
    pub from_sweeps: bool,
    /// The sweeps that were found, also if windows are used.
    pub sweeps: Vec<Sweep>,
    /// Mean resultant friction, newtons.
    pub threshold_n: f64,
}

/// Chooses the segments of a recording. There may be none.
pub fn choose_segments(recording: &Recording, choice: SegmentChoice) -> Segments {
    let len = segment_len(recording.rate_hz);
    let resultant = resultant(&recording.lateral_n);
    let samples = resultant.samples();
    let threshold_n = resultant.mean(0, samples);
    let half = (HALF_AVERAGE_S * recording.rate_hz).round() as usize;
    let smooth = || (0..samples).map(|at| resultant.mean_around(at, half));
    let sweeps = find_sweeps(smooth(), threshold_n, len);
    let rests = smooth().any(|r| r < REST_LEVEL * threshold_n);
    let from_sweeps = match choice {
        SegmentChoice::Auto => rests && !sweeps.is_empty(),
        SegmentChoice::Sweeps => true,
        SegmentChoice::Windows => false,
    };
    let starts = if from_sweeps {
        sweeps
            .iter()
            .filter_map(|sweep| middle(*sweep, len, samples))
            .collect()
    } else {
        let hop = len.div_ceil(2);
        let last = samples.saturating_sub(len);
        (0..=last).step_by(hop).filter(|_| samples >= len).collect()
    };
    Segments {
        len,
        starts,
        from_sweeps,
        sweeps,
        threshold_n,
    }
}

/// Samples of a segment at a rate: 4000 at 20 kHz.
pub fn segment_len(rate_hz: f64) -> usize {
    (rate_hz / SEGMENTS_PER_S).round().max(1.0) as usize
}

/// Length of the lateral force vector, sample by sample.
fn resultant(axes: &[Vec<f64>]) -> Sums {
    match axes {
        [x, y] => Sums::of(x.iter().zip(y).map(|(x, y)| x.hypot(*y))),
        [x] => Sums::of(x.iter().map(|x| x.abs())),
        _ => Sums::of(std::iter::empty()),
    }
}

fn find_sweeps(smooth: impl Iterator<Item = f64>, threshold: f64, shortest: usize) -> Vec<Sweep> {
    let mut sweeps = Vec::new();
    let mut start = None;
    for (i, r) in smooth.chain([f64::NEG_INFINITY]).enumerate() {
        match (r > threshold, start) {
            (true, None) => start = Some(i),
            (false, Some(from)) => {
                start = None;
                if i - from >= shortest {
                    sweeps.push(Sweep {
                        start: from,
                        end: i,
                    });
                }
            }
            _ => {}
        }
    }
    sweeps
}

/// Start of the segment around a sweep's middle, if it lies inside the recording.
fn middle(sweep: Sweep, len: usize, samples: usize) -> Option<usize> {
    let start = ((sweep.start + sweep.end) / 2).checked_sub(len / 2)?;
    (start + len <= samples).then_some(start)
}
