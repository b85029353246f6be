//! The rows of the table, and the measurements.

use serde::Serialize;
use serde_json::json;

#[derive(Clone, Copy)]
pub(crate) enum Who {
    C = 0,
    Python = 1,
}

/// A peer's task.
pub(crate) struct Against {
    pub peer: Who,
    pub task: &'static str,
    /// Description, for the table.
    pub what: &'static str,
    /// Target ratio of the times; `None` for a comparison without a target.
    pub aim: Option<f64>,
}

/// One measurement.
pub(crate) struct Row {
    /// Our task.
    pub ours: &'static str,
    /// Description, for the table.
    pub what: &'static str,
    pub unit: &'static str,
    /// Units per second.
    pub scale: f64,
    pub against: &'static [Against],
}

const fn c(task: &'static str, what: &'static str, aim: Option<f64>) -> Against {
    Against { peer: Who::C, task, what, aim }
}

const fn python(task: &'static str, what: &'static str, aim: Option<f64>) -> Against {
    Against { peer: Who::Python, task, what, aim }
}

const fn sample(ours: &'static str, what: &'static str, against: &'static [Against]) -> Row {
    Row { ours, what, unit: "ns/sample", scale: 1e9, against }
}

pub(crate) const fn rows() -> &'static [Row] {
    const ROWS: &[Row] = &[
        sample(
            "ar",
            "AR, a voice at 2 kHz",
            &[
                python("ar", "NumPy noise, SciPy lfilter", Some(3.0)),
                python("ar_edges", "the same, sosfilt at the band's edge as ours", None),
                c("ar", "C loop", None),
                c("ar_edges", "C loop, the band's edge as ours", None),
            ],
        ),
        sample(
            "ar_many",
            "AR, 1,000 voices at 2 kHz",
            &[
                c("ar_many", "C loop", Some(2.0)),
                c("ar_many_edges", "C loop, the band's edge as ours", None),
            ],
        ),
        sample(
            "ar_device",
            "AR at 20 kHz",
            &[
                python("ar_device", "lfilter at 2 kHz, resample_poly", None),
                python("ar", "lfilter at 20 kHz", Some(3.0)),
            ],
        ),
        sample(
            "sslope_device",
            "sSlope at 20 kHz",
            &[
                python("sslope", "NumPy noise, SciPy sosfilt", Some(3.0)),
                c("sslope", "C loop of two sections", None),
            ],
        ),
        sample(
            "sbeta_device",
            "sBeta at 20 kHz",
            &[
                python("sbeta_irfft", "one irfft of 10 s, the curve at hand", Some(3.0)),
                python("sbeta", "one irfft of 10 s, SciPy's density", None),
            ],
        ),
        sample(
            "mfcc_device",
            "MFCC at 20 kHz",
            &[
                python("mfcc_librosa", "librosa mfcc_to_audio", Some(100.0)),
                python("mfcc", "pseudo-inverse, one irfft of 10 s", Some(5.0)),
            ],
        ),
        sample(
            "speak_device",
            "sPeak at 20 kHz",
            &[
                python("speak", "NumPy cosines", Some(15.0)),
                c("speak", "C rotations, ten lines", None),
            ],
        ),
        Row {
            ours: "fit",
            what: "fit of the paper's five models",
            unit: "ms",
            scale: 1e3,
            against: &[python("fit", "SciPy", Some(10.0))],
        },
        Row {
            ours: "fit_burg",
            what: "AR by Burg's method",
            unit: "ms",
            scale: 1e3,
            against: &[python("fit_ar_spectrum", "spectrum's arburg", None)],
        },
        Row {
            ours: "process",
            what: "10 s of CSV to a spectrum",
            unit: "ms",
            scale: 1e3,
            against: &[python("process", "numpy.loadtxt, SciPy", Some(8.0))],
        },
        Row {
            ours: "open",
            what: "asset in memory to first sample",
            unit: "us",
            scale: 1e6,
            against: &[],
        },
        Row {
            ours: "open_once",
            what: "the same, after other work",
            unit: "us",
            scale: 1e6,
            against: &[],
        },
    ];
    ROWS
}

/// All measurements.
pub(crate) struct Rows {
    rows: &'static [Row],
    ours: Vec<Vec<f64>>,
    theirs: Vec<Vec<Vec<f64>>>,
    /// Seconds and MiB used by whole programs.
    whole_ours: Vec<(f64, f64)>,
    whole_theirs: Vec<(f64, f64)>,
}

#[derive(Clone, Copy, Serialize)]
struct Timing {
    least: f64,
    median: f64,
    /// Half the distance between the quartiles, divided by the median.
    spread: f64,
}

impl Timing {
    fn of(seconds: &[f64], scale: f64) -> Option<Self> {
        let mut sorted: Vec<f64> = seconds.iter().map(|s| s * scale).collect();
        sorted.sort_by(f64::total_cmp);
        let at =
            |part: f64| sorted.get((part * (sorted.len().max(1) - 1) as f64) as usize).copied();
        let (least, median) = (at(0.0)?, at(0.5)?);
        let spread = 0.5 * (at(0.75)? - at(0.25)?) / median;
        Some(Self { least, median, spread })
    }
}

/// A line of the table.
#[derive(Serialize)]
struct Line {
    what: String,
    unit: &'static str,
    htex: Timing,
    against: String,
    peer: Option<Timing>,
    /// The peer's minimum time divided by ours.
    ratio: Option<f64>,
    aim: Option<f64>,
}

impl Rows {
    pub(crate) fn new(rows: &'static [Row]) -> Self {
        Self {
            rows,
            ours: vec![Vec::new(); rows.len()],
            theirs: rows.iter().map(|row| vec![Vec::new(); row.against.len()]).collect(),
            whole_ours: Vec::new(),
            whole_theirs: Vec::new(),
        }
    }

    pub(crate) fn ours(&mut self, row: usize) -> &mut Vec<f64> {
        &mut self.ours[row]
    }

    pub(crate) fn theirs(&mut self, row: usize, against: usize) -> &mut Vec<f64> {
        &mut self.theirs[row][against]
    }

    pub(crate) fn whole_ours(&mut self, seconds: f64, mib: f64) {
        self.whole_ours.push((seconds, mib));
    }

    pub(crate) fn whole_theirs(&mut self, seconds: f64, mib: f64) {
        self.whole_theirs.push((seconds, mib));
    }

    fn lines(&self) -> Vec<Line> {
        let mut lines = Vec::new();
        for (i, row) in self.rows.iter().enumerate() {
            let Some(htex) = Timing::of(&self.ours[i], row.scale) else {
                continue;
            };
            let line = |against: &str, peer: Option<Timing>, aim| Line {
                what: row.what.to_owned(),
                unit: row.unit,
                htex,
                against: against.to_owned(),
                ratio: peer.map(|peer| peer.least / htex.least),
                peer,
                aim,
            };
            if row.against.is_empty() {
                lines.push(line("", None, None));
            }
            for (k, against) in row.against.iter().enumerate() {
                let peer = Timing::of(&self.theirs[i][k], row.scale);
                lines.push(line(against.what, peer, against.aim));
            }
        }
        lines.extend(self.whole_lines());
        lines
    }

    fn whole_lines(&self) -> Vec<Line> {
        let what = "htex synth --model ar --seconds 600";
        let line = |unit, of: fn(&(f64, f64)) -> f64, aim| {
            let timing =
                |all: &[(f64, f64)]| Timing::of(&all.iter().map(of).collect::<Vec<_>>(), 1.0);
            let (htex, peer) = (timing(&self.whole_ours)?, timing(&self.whole_theirs));
            Some(Line {
                what: what.to_owned(),
                unit,
                htex,
                against: "a SciPy script".to_owned(),
                ratio: peer.map(|peer| peer.least / htex.least),
                peer,
                aim,
            })
        };
        let (time, memory) = (line("s", |w| w.0, Some(5.0)), line("MiB at most", |w| w.1, None));
        time.into_iter().chain(memory).collect()
    }

    pub(crate) fn to_text(&self) -> String {
        let mut text = format!(
            "{:<38} {:>9} {:<11} {:>7} | {:<44} {:>9} {:>7} {:>7} {:>5}\n",
            "", "htex", "", "spread", "against", "", "spread", "ratio", "aim"
        );
        for line in self.lines() {
            let number =
                |x: Option<f64>, digits| x.map_or("-".to_owned(), |x| format!("{x:.digits$}"));
            let percent = |t: Option<Timing>| {
                t.map_or("-".to_owned(), |t| format!("{:.0} %", 100.0 * t.spread))
            };
            text += &format!(
                "{:<38} {:>9.2} {:<11} {:>7} | {:<44} {:>9} {:>7} {:>7} {:>5}\n",
                line.what,
                line.htex.least,
                line.unit,
                percent(Some(line.htex)),
                line.against,
                number(line.peer.map(|t| t.least), 2),
                percent(line.peer),
                number(line.ratio, 2),
                number(line.aim, 0),
            );
        }
        text
    }

    pub(crate) fn to_json(&self) -> Result<String, serde_json::Error> {
        serde_json::to_string_pretty(&json!({ "lines": self.lines() }))
    }
}
