//! What a sweep comes to: fronts, knees, warnings.

use htex_format::ErrorMeasure;
use serde::Serialize;

use crate::Subject;
use crate::figure::{Against, Cost, mark_front};
use crate::knee::{Knee, along_front, knees};
use crate::median::medians;
use crate::point::Point;
use crate::sweep::{LeftOut, Swept};

/// What the numbers are, for whoever reads the JSON.
const METHOD: &str = "times are medians of interleaved turns on one core, warm; every spread is half \
    the distance between the quartiles over the median. Errors are RMS over nine bands, over \
    third-octave bands, and over the bins (log-spectral distance), by the model's own magnitudes, \
    and by what three renderings play; `error` says which one fronts and knees go by. on_front: bytes \
    against the error by magnitudes, settings that play at their defaults; on_time_front: \
    ns_per_sample against the error by samples, settings with blocks and output rate at their defaults. The \
    recording's error is that of its odd strokes against its even ones.";

/// Steps that a warning names.
const SHOWN_STEPS: usize = 3;

/// Where a sweep ran.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Machine {
    /// The processor, as it names itself.
    pub processor: String,
    /// Processors that a program may use.
    pub cores: usize,
    /// Operating system and architecture.
    pub system: String,
}

impl Machine {
    /// This machine.
    pub fn here() -> Self {
        let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
        let name = info
            .lines()
            .find_map(|line| line.strip_prefix("model name"));
        let name = name.map(|rest| rest.trim_start_matches([' ', '\t', ':']).to_owned());
        Self {
            processor: name.unwrap_or_else(|| "unknown".to_owned()),
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            system: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
        }
    }
}

/// A recording, in the words of the report.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Recorded {
    /// Its name.
    pub name: String,
    /// Whether it was computed.
    pub simulated: bool,
    /// What it repeats within, nine-band RMS, dB.
    pub repeatability_rms_db: Option<f64>,
}

/// The whole result.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Tradeoff {
    /// Program and version.
    pub tool: String,
    /// Where it ran.
    pub machine: Machine,
    /// The error that fronts and knees go by.
    pub error: ErrorMeasure,
    /// What the numbers are.
    pub method: &'static str,
    /// The recordings.
    pub recordings: Vec<Recorded>,
    /// Short names of the models, in their order.
    pub models: Vec<String>,
    /// Every setting on every recording.
    pub points: Vec<Point>,
    /// The median of every setting over the recordings; empty for one recording.
    pub medians: Vec<Point>,
    /// The bends of the fronts: of the medians first, where there are any.
    pub knees: Vec<Knee>,
    /// Settings that a model refused.
    pub left_out: Vec<LeftOut>,
    /// What a reader should know.
    pub warnings: Vec<String>,
}

impl Tradeoff {
    /// Marks the fronts of a sweep over `subjects` and finds their knees.
    pub fn new(tool: &str, subjects: &[Subject], swept: Swept, error: ErrorMeasure) -> Self {
        let Swept {
            mut points,
            left_out,
        } = swept;
        for subject in subjects {
            let own = |p: &Point| p.recording == subject.name;
            // Points stand by recording.
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
            recordings: subjects.iter().map(Recorded::new).collect(),
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

    /// The points of a recording.
    pub fn of(&self, recording: &str) -> Vec<&Point> {
        self.points
            .iter()
            .filter(|p| p.recording == recording)
            .collect()
    }

    /// What stands for all: the medians, or the points of the only recording.
    pub fn summary(&self) -> Vec<&Point> {
        let points = if self.medians.is_empty() {
            &self.points
        } else {
            &self.medians
        };
        points.iter().collect()
    }

    pub(crate) fn against(&self, cost: Cost) -> Against {
        Against {
            cost,
            error: self.error,
        }
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
                &self.of(&recording.name),
                &self.models,
                self.error,
            ));
        }
        all
    }

    fn find_warnings(&self, subjects: &[Subject]) -> Vec<String> {
        let mut warnings: Vec<String> = subjects
            .iter()
            .flat_map(|subject| subject.warnings.clone())
            .collect();
        for recording in &self.recordings {
            warnings.extend(self.close_steps(&recording.name));
        }
        if !self.left_out.is_empty() {
            warnings.push(format!(
                "{} settings have no point because a model refused them; `left_out` in the JSON says \
                 which, and why",
                self.left_out.len()
            ));
        }
        warnings
    }

    /// Steps along the front of time that the spread of the times hides.
    fn close_steps(&self, recording: &str) -> Option<String> {
        let points: Vec<&Point> = self
            .of(recording)
            .into_iter()
            .filter(|p| Cost::Time.compares(p))
            .collect();
        let along = along_front(&points, self.against(Cost::Time));
        let ns = |p: &Point| p.spread * p.ns_per_sample;
        let hidden: Vec<String> = along
            .windows(2)
            .filter(|w| w[1].ns_per_sample - w[0].ns_per_sample <= ns(w[0]) + ns(w[1]))
            .map(|w| format!("{} to {}", w[0].name(), w[1].name()))
            .collect();
        let more = match hidden.len().saturating_sub(SHOWN_STEPS) {
            0 => String::new(),
            more => format!(", and at {more} more steps"),
        };
        (!hidden.is_empty()).then(|| {
            format!(
                "{recording}: along the front of time the spread is wider than the difference from {}{more}",
                hidden[..hidden.len().min(SHOWN_STEPS)].join(", from ")
            )
        })
    }
}

impl Recorded {
    fn new(subject: &Subject) -> Self {
        Self {
            name: subject.name.clone(),
            simulated: subject.simulated,
            repeatability_rms_db: subject.spectrum.repeatability_rms_db,
        }
    }
}

fn mark(points: &mut [Point], error: ErrorMeasure) {
    for cost in [Cost::Bytes, Cost::Time] {
        mark_front(points, Against { cost, error });
    }
}
