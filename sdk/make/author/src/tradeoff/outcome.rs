//! Evaluation of a sweep: Pareto fronts, their knees, and warnings.

use htex_base::finding::Notice;
use serde::Serialize;

use crate::tradeoff::Subject;
use crate::tradeoff::against::{Against, Cost};
use crate::tradeoff::error_axis::ErrorAxis;
use crate::tradeoff::figure::mark_front;
use crate::tradeoff::knee::{Knee, knees};
use crate::tradeoff::median::medians;
use crate::tradeoff::point::Point;
use crate::tradeoff::sweep::{LeftOut, SweepResult};

/// Description of the numbers, for readers of the JSON.
const METHOD: &str = "times are medians of interleaved runs on one core, with warm caches; every spread is half \
    the interquartile range over the median. held_out_error: fitted to the odd blocks of what is read of a recording, stored, played (three \
    renderings), and compared with the even blocks in third octaves, over the difference between odd and even blocks (floor_db): 1 is as good \
    as a second recording. The other errors are against what was fitted to: RMS over nine bands, over \
    third-octave bands, and over the bins (log-spectral distance), and over third-octave bands of what is above a fingertip's detection \
    threshold (felt), by the model's own magnitudes, and of three renderings; `error` is the one used for fronts and knees. on_front: bytes \
    against the held-out error or the error by magnitudes, settings that play at their defaults; on_time_front: \
    ns_per_sample against the held-out error or the error by samples, settings with blocks and output rate at their defaults; of times within \
    their spreads, the one with the least error. The recording's errors are the difference between its odd and even blocks. \
    share_not_felt: recordings that are below the detection threshold as a whole; share_below_threshold: other recordings whose difference by \
    magnitudes is below the difference threshold in every band; \
    share_within_repeatability: recordings whose nine-band error is at most 3.5 times their own repeatability, which says nothing about what is felt.";

/// The machine on which a sweep ran.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Machine {
    pub processor: String,
    /// Number of cores that a program may use.
    pub cores: usize,
    /// Operating system and architecture.
    pub system: String,
}

impl Machine {
    /// Returns the current machine.
    pub fn here() -> Self {
        let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
        let name = info
            .lines()
            .find_map(|line| line.strip_prefix("model name"))
            .map(|rest| rest.trim_start_matches([' ', '\t', ':']).to_owned());
        Self {
            processor: name.unwrap_or_else(|| "unknown".to_owned()),
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            system: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
        }
    }
}

/// A recording of the sweep, as listed in the report.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RecordingSummary {
    pub name: String,
    /// Whether the recording comes from a simulator.
    pub simulated: bool,
    /// Repeatability of the recording (RMS over nine bands), dB.
    pub repeatability_rms_db: Option<f64>,
    /// Number of time blocks, odd and even together, in the parts of the recording that the sweep
    /// reads. The even blocks are held out. `None` if there are too few blocks.
    pub blocks: Option<usize>,
    /// Length of a block, seconds.
    pub block_s: Option<f64>,
    /// Third-octave difference between the odd and the even blocks, dB. The held-out error is given
    /// in units of this difference.
    pub floor_db: Option<f64>,
}

/// The evaluated result of a sweep.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Tradeoff {
    /// Program and version.
    pub tool: String,
    pub machine: Machine,
    /// The error used for fronts and knees.
    pub error: ErrorAxis,
    /// Text that explains how the numbers were measured.
    pub method: &'static str,
    pub recordings: Vec<RecordingSummary>,
    /// Short names of the models, in the order of the points.
    pub models: Vec<String>,
    /// The measurements of every setting on every recording.
    pub points: Vec<Point>,
    /// The medians of every setting over the recordings; empty if there is only one recording.
    pub medians: Vec<Point>,
    /// The knees of the fronts. If there are medians, the knees of the medians' fronts come first.
    pub knees: Vec<Knee>,
    /// Settings that could not be measured.
    pub left_out: Vec<LeftOut>,
    /// Warnings, as sentences.
    pub warnings: Vec<Notice>,
}

impl Tradeoff {
    /// Marks the fronts of a sweep over `subjects`, and finds the knees of these fronts.
    pub fn new(tool: &str, subjects: &[Subject], swept: SweepResult) -> Self {
        let SweepResult { error, mut points, left_out } = swept;
        for subject in subjects {
            let own = |p: &Point| p.recording == subject.name;
            // Points are ordered by recording.
            let first = points.iter().position(own).unwrap_or(0);
            let count = points.iter().filter(|p| own(p)).count();
            mark(&mut points[first..first + count], error);
        }
        let mut medians = match subjects.len() {
            0 | 1 => Vec::new(),
            several => medians(&points, several),
        };
        mark(&mut medians, error);
        let mut models: Vec<String> = Vec::new();
        for point in points.iter().filter(|p| !p.is_baseline()) {
            if !models.contains(&point.model) {
                models.push(point.model.clone());
            }
        }
        let mut tradeoff = Self {
            tool: tool.to_owned(),
            machine: Machine::here(),
            error,
            method: METHOD,
            recordings: subjects.iter().map(RecordingSummary::new).collect(),
            models,
            points,
            medians,
            knees: Vec::new(),
            left_out,
            warnings: Vec::new(),
        };
        tradeoff.knees = tradeoff.find_knees();
        tradeoff.warnings = tradeoff.find_warnings(subjects);
        tradeoff
    }

    /// Returns the points of a recording.
    pub(crate) fn points_of(&self, recording: &str) -> Vec<&Point> {
        self.points.iter().filter(|p| p.recording == recording).collect()
    }

    /// Returns the points of the summary: the medians or, if there is only one recording, the
    /// points of this recording.
    pub fn summary(&self) -> Vec<&Point> {
        let points = if self.medians.is_empty() { &self.points } else { &self.medians };
        points.iter().collect()
    }

    pub(crate) fn against(&self, cost: Cost) -> Against {
        Against { cost, error: self.error }
    }

    fn find_knees(&self) -> Vec<Knee> {
        let medians: Vec<&Point> = self.medians.iter().collect();
        let mut all = Vec::new();
        if let Some(first) = medians.first() {
            all.extend(knees(&first.recording, &medians, &self.models, self.error));
        }
        for recording in &self.recordings {
            all.extend(knees(
                &recording.name,
                &self.points_of(&recording.name),
                &self.models,
                self.error,
            ));
        }
        all
    }

    fn find_warnings(&self, subjects: &[Subject]) -> Vec<Notice> {
        let mut warnings: Vec<Notice> =
            subjects.iter().flat_map(|subject| subject.warnings.clone()).collect();
        let not_held_out = subjects.iter().find_map(|s| s.check_held_out().err());
        if let (ErrorAxis::Fitted(_), Some(reason)) = (self.error, not_held_out) {
            let what = format!("{reason}. The error is the {} of what was fitted to", self.error);
            warnings.push(what.into());
        }
        if !self.left_out.is_empty() {
            warnings.push(
                format!(
                    "{} settings could not be measured; `left_out` in the JSON lists \
                 them with the reasons",
                    self.left_out.len()
                )
                .into(),
            );
        }
        warnings
    }
}

impl RecordingSummary {
    fn new(subject: &Subject) -> Self {
        let held_out = subject.held_out.as_ref().ok();
        Self {
            name: subject.name.clone(),
            simulated: subject.simulated,
            repeatability_rms_db: subject.spectrum.repeatability_rms_db(),
            blocks: held_out.map(|h| h.halves.blocks),
            block_s: held_out.map(|h| h.halves.block_s),
            floor_db: held_out.map(|h| h.floor_db),
        }
    }
}

fn mark(points: &mut [Point], error: ErrorAxis) {
    for cost in [Cost::Bytes, Cost::Time] {
        mark_front(points, Against { cost, error });
    }
}
