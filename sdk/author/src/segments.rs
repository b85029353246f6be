//! Where in a recording the texture is read: sweeps, or evenly spaced windows.

use std::ops::Range;

use htex_format::Quantity;

use crate::Recording;
use crate::sums::Sums;

/// Texture spectra have a resolution of 5 Hz: segments are a fifth of a second.
const SEGMENTS_PER_S: f64 = 5.0;
/// Half the length of the moving average that sweeps are found on (50 ms in all), seconds.
const HALF_AVERAGE_S: f64 = 0.025;
/// A recording has sweeps if between them its friction falls below this part of the threshold; above it
/// the finger slides.
const REST_LEVEL: f64 = 0.5;
/// Sliding that a sweep's one segment stands for at most, seconds: ten segments. A sweep across
/// the paper's samples, 100 mm at 80 mm/s, lasts 1.25 s at most.
const SPOKEN_FOR_S: f64 = 2.0;
/// Least part of the sliding that the segments must stand for, or sweeps leave most of it unread.
const SPOKEN_FOR: f64 = 0.5;

/// How segments are chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum SegmentChoice {
    /// Sweeps if the recording has them and they speak for at least half of its sliding, else windows.
    ///
    /// A sweep speaks for itself, but for 2 s at most: a long stroke is more than its middle.
    #[default]
    Auto,
    /// One segment in the middle of each sweep that the recording holds whole (paper, Texture
    /// processing). A sweep that its beginning or end cuts off has no known middle.
    Sweeps,
    /// Windows over the whole recording, each half over the one before (Welch 1967): side by side, Hann
    /// windows would leave half of it unread, and the level of 10 s of noise uncertain by 0.2 dB.
    Windows,
}

/// A stretch of the recording in which the signal exceeds the threshold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sweep {
    /// First sample.
    pub start: usize,
    /// One past the last sample.
    pub end: usize,
}

/// What sweeps would have left unread.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unread {
    /// Sliding that their segments stand for, seconds.
    pub spoken_for_s: f64,
    /// All sliding, seconds.
    pub sliding_s: f64,
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
    /// How many of them the recording's beginning or end cuts off; they are not read.
    pub cut_off: usize,
    /// First samples of the segments that were left out because the motion left its target.
    pub off_target: Vec<usize>,
    /// Why `auto` turned to windows though there are sweeps.
    pub unread: Option<Unread>,
    /// Mean length of the signal's vector, in its unit.
    pub threshold: f64,
}

impl Segments {
    /// The stretches that are read, samples; segments that touch are one.
    pub fn stretches(&self) -> Vec<Range<usize>> {
        let mut stretches: Vec<Range<usize>> = Vec::new();
        for &start in &self.starts {
            match stretches.last_mut() {
                Some(last) if last.end >= start => last.end = start + self.len,
                _ => stretches.push(start..start + self.len),
            }
        }
        stretches
    }
}

/// Chooses the segments of a recording. There may be none.
pub fn choose_segments(recording: &Recording, choice: SegmentChoice) -> Segments {
    let len = segment_len(recording.rate_hz);
    let resultant = resultant(recording);
    let samples = resultant.samples();
    let threshold = resultant.mean(0, samples);
    let half = (HALF_AVERAGE_S * recording.rate_hz).round() as usize;
    let smooth = (0..samples).map(|at| resultant.mean_around(at, half));
    let Scan { sweeps, sliding } = scan(smooth, threshold, len);
    let whole = || {
        let is_whole = |sweep: &&Sweep| sweep.start > 0 && sweep.end < samples;
        sweeps.iter().filter(is_whole)
    };
    let longest = (SPOKEN_FOR_S * recording.rate_hz) as usize;
    let spoken_for: usize = whole().map(|s| (s.end - s.start).min(longest)).sum();
    let has_sweeps = !sweeps.is_empty() && sliding < samples;
    let speak_for_most = spoken_for as f64 >= SPOKEN_FOR * sliding as f64;
    let from_sweeps = match choice {
        SegmentChoice::Auto => has_sweeps && speak_for_most,
        SegmentChoice::Sweeps => true,
        SegmentChoice::Windows => false,
    };
    let starts = if from_sweeps {
        let middles = whole().filter_map(|sweep| middle(*sweep, len, samples));
        middles.collect()
    } else {
        let hop = len.div_ceil(2);
        let last = samples.saturating_sub(len);
        (0..=last).step_by(hop).filter(|_| samples >= len).collect()
    };
    let turned = choice == SegmentChoice::Auto && has_sweeps && !speak_for_most;
    Segments {
        len,
        starts,
        from_sweeps,
        cut_off: sweeps.len() - whole().count(),
        off_target: Vec::new(),
        unread: turned.then(|| Unread {
            spoken_for_s: spoken_for as f64 / recording.rate_hz,
            sliding_s: sliding as f64 / recording.rate_hz,
        }),
        sweeps,
        threshold,
    }
}

/// Samples of a segment at a rate: 4000 at 20 kHz.
pub fn segment_len(rate_hz: f64) -> usize {
    (rate_hz / SEGMENTS_PER_S).round().max(1.0) as usize
}

/// Length of the signal's vector, sample by sample. The mean of friction tells sliding from rest; that of any
/// other quantity (gravity, a place, a weight) tells nothing and is removed.
fn resultant(recording: &Recording) -> Sums {
    let mean = |axis: &Vec<f64>| match recording.quantity {
        Quantity::LateralForce => 0.0,
        _ => axis.iter().sum::<f64>() / axis.len() as f64,
    };
    let centred: Vec<(&Vec<f64>, f64)> = recording.axes.iter().map(|x| (x, mean(x))).collect();
    let length = |at: usize| {
        let squares = centred.iter().map(|(x, mean)| (x[at] - mean).powi(2));
        squares.sum::<f64>().sqrt()
    };
    Sums::of((0..recording.samples()).map(length))
}

/// The sweeps, and the number of samples at which the finger slides.
struct Scan {
    sweeps: Vec<Sweep>,
    sliding: usize,
}

fn scan(smooth: impl Iterator<Item = f64>, threshold: f64, shortest: usize) -> Scan {
    let (mut sweeps, mut sliding) = (Vec::new(), 0);
    let mut start = None;
    for (i, r) in smooth.chain([f64::NEG_INFINITY]).enumerate() {
        sliding += usize::from(r >= REST_LEVEL * threshold);
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
    Scan { sweeps, sliding }
}

/// Start of the segment around a sweep's middle, if it lies inside the recording.
fn middle(sweep: Sweep, len: usize, samples: usize) -> Option<usize> {
    let start = ((sweep.start + sweep.end) / 2).checked_sub(len / 2)?;
    (start + len <= samples).then_some(start)
}
