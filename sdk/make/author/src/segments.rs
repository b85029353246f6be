//! Choice of a recording's segments: the middles of sweeps, or evenly spaced windows.

use std::ops::Range;

use htex_format::Quantity;
use serde::{Deserialize, Serialize};

use crate::Recording;
use htex_recording::Sums;

/// Segments per second. A segment of 0.2 s gives texture spectra a resolution of 5 Hz.
pub(crate) const SEGMENTS_PER_S: f64 = 5.0;
/// Half the length of the moving average used to detect sweeps (50 ms in all), seconds.
const HALF_AVERAGE_S: f64 = 0.025;
/// A finger slides while its friction is at least this fraction of the threshold. A recording has
/// sweeps only if the friction falls below this value between the sweeps.
const REST_LEVEL: f64 = 0.5;
/// Longest stretch of sliding that one segment can represent, seconds: ten segments. A sweep across
/// the paper's samples, 100 mm at 80 mm/s, lasts at most 1.25 s.
const REPRESENTED_S: f64 = 2.0;
/// Smallest fraction of the sliding that the segments of sweeps must represent. If they represent
/// less, windows are used.
const REPRESENTED: f64 = 0.5;

/// Defines which parts of a recording are read, for `spec/recording-findings.md`.
pub(crate) fn definition() -> String {
    format!(
        "The *length* of a sample is the magnitude of the signal's vector over its axes; of quantities other than the lateral force, each axis' mean is taken from \
         it first. The *threshold* is the mean length of all samples. Averages over {} s are over as many samples on either side as half of it has, rounded \
         (halves up), and the sample itself, fewer at the ends. The finger *slides* at a sample whose average length is at least {REST_LEVEL} of the threshold. A \
         *sweep* is a stretch of at least a segment in which the average exceeds the threshold; it is cut off if it begins with the recording or ends with it. A \
         *segment* has the rate over {SEGMENTS_PER_S} samples, rounded. That of a sweep from sample *s* to before sample *e* begins at `(s + e) / 2`, rounded down, less half a segment, rounded \
         down; sweeps that are cut off have none, and are a finding where segments of sweeps are read. Of the sliding, a sweep that is not cut off represents its length, at most {REPRESENTED_S} s. Where there are sweeps, a sample at \
         which the finger does not slide, and sweeps represent at least {REPRESENTED} of the samples of sliding, the segments of sweeps are read. Else *windows* are: segments every half a segment, rounded up, from the \
         first sample on. They are a finding, `RECORDING_READ_IN_WINDOWS`, where there are sweeps and a sample at which the finger does not slide.\n\n",
        2.0 * HALF_AVERAGE_S
    )
}

/// How segments are chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum SegmentChoice {
    /// Uses `Sweeps` if the recording has sweeps and their segments represent at least half of the
    /// sliding, and `Windows` otherwise.
    ///
    /// A segment represents its whole sweep, but at most 2 s of sliding.
    #[default]
    Auto,
    /// One segment in the middle of each complete sweep (paper, Texture processing). Sweeps that
    /// the beginning or end of the recording cuts off are left out, because their middle is not
    /// known.
    Sweeps,
    /// Windows over the whole recording, each of which overlaps the previous window by half (Welch
    /// 1967). Without overlap, Hann windows would leave half of the recording unused, and the level
    /// of 10 s of noise would be uncertain by 0.2 dB.
    Windows,
}

impl SegmentChoice {
    /// All methods, in the order of the command line's help.
    pub const ALL: &[Self] = &[Self::Auto, Self::Sweeps, Self::Windows];

    /// Returns the name used in recipes and on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Sweeps => "sweeps",
            Self::Windows => "windows",
        }
    }
}

/// A stretch of the recording in which the signal exceeds the threshold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sweep {
    /// First sample.
    pub start: usize,
    /// One past the last sample.
    pub end: usize,
}

/// Two durations: the sliding that one segment from each sweep would represent, and the total
/// sliding.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unread {
    /// Sliding that the segments represent, seconds.
    pub represented_s: f64,
    /// Total sliding, seconds.
    pub sliding_s: f64,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Segments {
    /// Number of samples in each segment.
    pub len: usize,
    /// First sample of each segment.
    pub starts: Vec<usize>,
    /// Whether the segments are in sweeps; otherwise they are evenly spaced windows.
    pub from_sweeps: bool,
    /// The detected sweeps, even if windows are used.
    pub sweeps: Vec<Sweep>,
    /// Number of sweeps that the recording's beginning or end cuts off. These sweeps are not read.
    pub cut_off: usize,
    /// Index of the first sample of each segment that is left out because its motion differs from
    /// the target.
    pub off_target: Vec<usize>,
    /// Set if the recording has sweeps, but `auto` uses windows. The reason is that segments in the
    /// sweeps would represent too little of the sliding.
    pub unread: Option<Unread>,
    /// The threshold that the signal exceeds in a sweep: the mean length of the signal vector, in
    /// the signal's unit.
    pub threshold: f64,
}

impl Segments {
    /// Returns the parts of the recording that the segments cover, in samples; adjoining segments
    /// are merged.
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

/// Chooses the segments of a recording. The result may be empty.
pub fn choose_segments(recording: &Recording, choice: SegmentChoice) -> Segments {
    let len = segment_len(recording.rate_hz);
    let friction = Friction::new(recording);
    let samples = friction.samples();
    let Scan { sweeps, sliding } = scan(&friction, len);
    let whole = || {
        let is_whole = |sweep: &&Sweep| sweep.start > 0 && sweep.end < samples;
        sweeps.iter().filter(is_whole)
    };
    let longest = (REPRESENTED_S * recording.rate_hz) as usize;
    let represented: usize = whole().map(|s| (s.end - s.start).min(longest)).sum();
    // If the finger never rests, stretches above the threshold are not separate sweeps.
    let has_sweeps = !sweeps.is_empty() && sliding < samples;
    let represent_most = represented as f64 >= REPRESENTED * sliding as f64;
    let from_sweeps = match choice {
        SegmentChoice::Auto => has_sweeps && represent_most,
        SegmentChoice::Sweeps => true,
        SegmentChoice::Windows => false,
    };
    let starts = if from_sweeps {
        let middles = whole().filter_map(|sweep| middle(*sweep, len, samples));
        middles.collect()
    } else {
        // Playback joins windows that begin exactly this step apart, so `recorded.rs` must round in
        // the same way.
        let hop = len.div_ceil(2);
        let last = samples.saturating_sub(len);
        // For a recording shorter than a segment, `last` is also 0, and the filter removes this
        // window.
        (0..=last).step_by(hop).filter(|_| samples >= len).collect()
    };
    let turned = choice == SegmentChoice::Auto && has_sweeps && !represent_most;
    Segments {
        len,
        starts,
        from_sweeps,
        cut_off: sweeps.len() - whole().count(),
        off_target: Vec::new(),
        unread: turned.then(|| Unread {
            represented_s: represented as f64 / recording.rate_hz,
            sliding_s: sliding as f64 / recording.rate_hz,
        }),
        sweeps,
        threshold: friction.threshold,
    }
}

/// Returns for each sample whether the finger slides. The finger slides where the length of the
/// signal vector, averaged over 50 ms, is at least half of the mean length over the recording.
pub fn sliding(recording: &Recording) -> Vec<bool> {
    let friction = Friction::new(recording);
    let slides = |at| friction.slides(friction.smooth(at));
    (0..friction.samples()).map(slides).collect()
}

/// Returns the number of samples in a segment at a sample rate: 4000 at 20 kHz.
pub(crate) fn segment_len(rate_hz: f64) -> usize {
    (rate_hz / SEGMENTS_PER_S).round().max(1.0) as usize
}

/// Computes the length of the signal vector, sample by sample. The mean of a friction force
/// separates sliding from rest. The mean of any other quantity is an offset (gravity, position,
/// weight) and is removed.
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
    Sums::new((0..recording.samples()).map(length))
}

/// The length of the signal vector, and its mean, which is the threshold that separates sweeps.
struct Friction {
    resultant: Sums,
    threshold: f64,
    /// Half the length of the moving average, samples.
    half: usize,
}

impl Friction {
    fn new(recording: &Recording) -> Self {
        let resultant = resultant(recording);
        Self {
            threshold: resultant.mean(0, resultant.samples()),
            half: (HALF_AVERAGE_S * recording.rate_hz).round() as usize,
            resultant,
        }
    }

    fn samples(&self) -> usize {
        self.resultant.samples()
    }

    /// Returns the average over 50 ms around a sample.
    fn smooth(&self, at: usize) -> f64 {
        self.resultant.mean_around(at, self.half)
    }

    /// Whether the finger slides, given a smoothed value.
    fn slides(&self, smooth: f64) -> bool {
        smooth >= REST_LEVEL * self.threshold
    }
}

/// The sweeps, and the number of samples in which the finger slides.
struct Scan {
    sweeps: Vec<Sweep>,
    sliding: usize,
}

/// `shortest` is the length of the shortest sweep, samples.
fn scan(friction: &Friction, shortest: usize) -> Scan {
    let (mut sweeps, mut sliding) = (Vec::new(), 0);
    let mut start = None;
    let smooth = (0..friction.samples()).map(|at| friction.smooth(at));
    // The added value closes a sweep that reaches the end of the recording.
    for (i, r) in smooth.chain([f64::NEG_INFINITY]).enumerate() {
        sliding += usize::from(friction.slides(r));
        match (r > friction.threshold, start) {
            (true, None) => start = Some(i),
            (false, Some(from)) => {
                start = None;
                if i - from >= shortest {
                    sweeps.push(Sweep { start: from, end: i });
                }
            }
            _ => {}
        }
    }
    Scan { sweeps, sliding }
}

/// Returns the start of the segment around a sweep's middle, if the segment lies inside the
/// recording.
fn middle(sweep: Sweep, len: usize, samples: usize) -> Option<usize> {
    // Uses whole numbers and rounds twice, as the specification says, so that other programs read
    // the same samples.
    let start = ((sweep.start + sweep.end) / 2).checked_sub(len / 2)?;
    (start + len <= samples).then_some(start)
}
