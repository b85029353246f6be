//! A session: takes of one name, recorded until one keeps to its target.

use std::path::{Path, PathBuf};

use htex_author::Exploration;
use htex_author::read::Role;
use htex_device::Source;
use htex_format::Quantity;
use serde::Serialize;

use crate::record::data::TakeHeader;
use crate::record::error::RecordError;
use crate::record::guide::{FingerPath, Moment, Phase};
use crate::record::judge::{Verdict, judge};
use crate::record::names;
use crate::record::part::{Part, read_part};
use crate::record::reader::{Block, Inputs, Reader};
use crate::record::signals::Signals;
use crate::record::tracker::TrackerRows;
use crate::record::write::{Format, Outcome, write_take};

/// Takes a block.
type Take<'a> = dyn FnMut(&Block) -> Result<(), RecordError> + 'a;

/// Length of the tare, seconds.
const TARE_S: f64 = 1.0;
/// Longest take, seconds.
const LONGEST_S: f64 = 3600.0;

/// What a session records.
#[derive(Debug, Clone, PartialEq)]
pub struct Setup {
    /// Folder of the takes; it is created.
    pub folder: PathBuf,
    /// Name of the takes, a part of their files' names.
    pub name: String,
    /// Length of a take, seconds; at most an hour.
    pub seconds: f64,
    /// Seconds before each take in which the finger can find its motion.
    pub countdown_s: f64,
    /// Whether the means of the forces over a first second without a finger are subtracted.
    pub tare: bool,
    /// Quantity of the texture's signal.
    pub quantity: Quantity,
    /// Target of speed and normal force.
    pub target: Exploration,
    /// Allowed relative difference of mean, minimum and maximum from the target; 0.1 in the paper.
    pub tolerance: f64,
    /// Most takes that are tried.
    pub attempts: u32,
    /// Format of the recordings.
    pub format: Format,
    /// Program and version, for the JSON beside a recording.
    pub tool: String,
    /// The source as it was named, for the JSON.
    pub source: String,
    /// The map of channels as it was given, for the JSON.
    pub map: Option<String>,
}

/// Whether a session goes on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Next {
    /// It does.
    Go,
    /// It ends; what was recorded is kept.
    Stop,
}

/// A take that is complete, or that was recovered.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Recorded {
    /// The recording.
    pub file: PathBuf,
    /// What became of it.
    pub outcome: Outcome,
    /// Number of the take.
    pub number: u32,
    /// Seconds that were recorded.
    pub recorded_s: f64,
    /// The judgement.
    pub verdict: Verdict,
    /// Arguments of `htex fit` that read it.
    pub fit: Vec<String>,
}

/// A session. The source runs from its first take until it is dropped.
pub struct Session {
    setup: Setup,
    reader: Reader,
    path: FingerPath,
}

impl Session {
    /// Makes a session and creates its folder. The source does not run yet.
    ///
    /// # Errors
    /// When the setup is out of range, or a target is given for what is not measured.
    pub fn new(
        setup: Setup,
        source: Box<dyn Source>,
        signals: Signals,
        tracker: Option<Box<dyn TrackerRows>>,
    ) -> Result<Self, RecordError> {
        check(&setup, source.rate_hz())?;
        let moves = |roles: &[(String, String)]| {
            roles
                .iter()
                .any(|(role, _)| matches!(&role[..], "x" | "y" | "speed"))
        };
        let is_tracked = tracker
            .as_ref()
            .is_some_and(|tracker| moves(&tracker.signals()));
        if setup.target.speed_mm_s.is_some() && !is_tracked && !moves(&signals.list()) {
            return Err(RecordError::NotMeasured {
                what: "speed",
                advice: "give a tracker, or map speed, x or y",
            });
        }
        if setup.target.force_n.is_some() && signals.position(Role::Normal).is_none() {
            return Err(RecordError::NotMeasured {
                what: "force",
                advice: "map the channel of the normal force, as in normal=ai2:0.31",
            });
        }
        std::fs::create_dir_all(&setup.folder)
            .map_err(|error| RecordError::write(&setup.folder, error))?;
        let inputs = Inputs { signals, tracker };
        Ok(Self {
            reader: Reader::new(source, inputs, setup.seconds),
            setup,
            path: FingerPath::default(),
        })
    }

    /// Records takes until one keeps to its target, and returns that. `watch` is called for each block of samples, `told` for
    /// each take that is complete.
    ///
    /// # Errors
    /// [`RecordError::OffTarget`] when no take did; errors of the source, after which what was recorded is in the folder
    /// `incomplete`; [`RecordError::Left`] when `watch` ends the session.
    pub fn record(
        &mut self,
        watch: &mut dyn FnMut(&Moment) -> Next,
        told: &mut dyn FnMut(&Recorded),
    ) -> Result<Recorded, RecordError> {
        self.reader.source.start()?;
        if self.setup.tare {
            self.tare(watch)?;
        }
        let mut reasons = String::new();
        for _ in 0..self.setup.attempts {
            let take = self.take(watch)?;
            told(&take);
            if take.outcome == Outcome::Kept {
                self.reader.source.stop()?;
                return Ok(take);
            }
            reasons = take.verdict.reasons.join("; ");
        }
        self.reader.source.stop()?;
        Err(RecordError::OffTarget {
            attempts: self.setup.attempts,
            reasons,
            folder: self.setup.folder.join(names::REJECTED),
        })
    }

    /// Measures the forces without a finger.
    fn tare(&mut self, watch: &mut dyn FnMut(&Moment) -> Next) -> Result<(), RecordError> {
        let (mut sums, mut count) = (vec![0.0; self.reader.inputs.signals.list().len()], 0);
        self.run(Phase::Tare, 0, TARE_S, watch, &mut |block| {
            for (sum, values) in sums.iter_mut().zip(&block.values) {
                *sum += values.iter().sum::<f64>();
            }
            count += block.values.first().map_or(0, Vec::len);
            Ok(())
        })?;
        let means: Vec<f64> = sums.iter().map(|sum| sum / count.max(1) as f64).collect();
        self.reader.inputs.signals.tare(&means);
        Ok(())
    }

    /// Records one take.
    fn take(&mut self, watch: &mut dyn FnMut(&Moment) -> Next) -> Result<Recorded, RecordError> {
        let folder = self.setup.folder.clone();
        let number = names::next_number(&folder, &self.setup.name);
        let number = number.map_err(|error| RecordError::write(&folder, error))?;
        self.run(
            Phase::Countdown,
            number,
            self.setup.countdown_s,
            watch,
            &mut |_| Ok(()),
        )?;
        let header = self.header(number);
        let mut part = Part::create(&names::part(&folder, &header.name, number), &header)?;
        let begin_s = self.reader.now_s();
        let ran = self.run(Phase::Take, number, header.seconds, watch, &mut |block| {
            block.check(&header)?;
            part.push_tracker(&block.rows_since(&header, begin_s));
            part.push(&block.interleaved())
        });
        let flushed = part.flush();
        let path = part.path().to_owned();
        drop(part);
        match ran.and(flushed) {
            Ok(()) => finish(&folder, &path)?.ok_or(RecordError::Part {
                file: path,
                problem: "it is empty after a take; the disk may be damaged".to_owned(),
            }),
            Err(error) => Err(with_kept(error, finish(&folder, &path)?)),
        }
    }

    fn header(&self, number: u32) -> TakeHeader {
        let setup = &self.setup;
        let inputs = &self.reader.inputs;
        TakeHeader {
            htex_take: 1,
            name: setup.name.clone(),
            number,
            tool: setup.tool.clone(),
            source: setup.source.clone(),
            map: setup.map.clone(),
            calibrations: inputs.signals.calibrations(),
            quantity: setup.quantity,
            rate_hz: self.reader.source.rate_hz(),
            seconds: setup.seconds,
            signals: inputs.signals.list(),
            tare: inputs.signals.offsets().to_vec(),
            tracker: inputs.tracked(),
            target_speed_mm_s: setup.target.speed_mm_s,
            target_force_n: setup.target.force_n,
            tolerance: setup.tolerance,
            format: setup.format,
        }
    }

    /// Reads a phase, block by block.
    fn run(
        &mut self,
        phase: Phase,
        number: u32,
        of_s: f64,
        watch: &mut dyn FnMut(&Moment) -> Next,
        take: &mut Take<'_>,
    ) -> Result<(), RecordError> {
        let rate_hz = self.reader.source.rate_hz();
        let frames = (of_s * rate_hz).round() as u64;
        let mut done = 0;
        while done < frames {
            let Some(block) = self.reader.block(frames - done)? else {
                continue;
            };
            done += block.values.first().map_or(0, Vec::len) as u64;
            take(&block)?;
            let normal = self.reader.inputs.signals.position(Role::Normal);
            let moment = Moment {
                phase,
                number,
                elapsed_s: done as f64 / rate_hz,
                of_s,
                force_n: normal.map(|at| mean(&block.values[at])),
                position_mm: self.position(&block),
            };
            if watch(&moment) == Next::Stop {
                return Err(RecordError::Left { kept: None });
            }
        }
        Ok(())
    }

    /// The finger's place by the tracker, else by the source.
    fn position(&mut self, block: &Block) -> Option<f64> {
        for (axis, role) in [Role::X, Role::Y].into_iter().enumerate() {
            let own = self.reader.inputs.signals.position(role);
            let own = own.and_then(|at| block.values[at].last().copied());
            let at_mm = self.tracked(role, &block.rows).or(own);
            if let Some(at_mm) = at_mm {
                self.path.see(axis, at_mm);
            }
        }
        self.path.place_mm()
    }

    /// The newest position by the tracker along the axis of a role.
    fn tracked(&self, role: Role, rows: &[f64]) -> Option<f64> {
        let signals = self.reader.inputs.tracked();
        let axis = signals.iter().position(|(own, _)| own == role.name())?;
        let newest = rows.chunks_exact(signals.len() + 1).last()?;
        newest.get(axis + 1).copied()
    }
}

fn check(setup: &Setup, rate_hz: f64) -> Result<(), RecordError> {
    names::check(&setup.name)?;
    let refuse = |what, value: f64, allowed| {
        let value = value.to_string();
        Err(RecordError::Setup {
            what,
            value,
            allowed,
        })
    };
    let frames = setup.seconds * rate_hz;
    if !(setup.seconds <= LONGEST_S && frames.round() >= 2.0) {
        return refuse(
            "the length of a take",
            setup.seconds,
            "it is at least two samples and at most 3600 s",
        );
    }
    if !(0.0..=LONGEST_S).contains(&setup.countdown_s) {
        return refuse(
            "the countdown",
            setup.countdown_s,
            "0 to 3600 s are allowed",
        );
    }
    if !(setup.tolerance > 0.0 && setup.tolerance < 1.0) {
        return refuse(
            "the tolerance",
            setup.tolerance,
            "it is above 0 and below 1, as in 0.1 for 10 %",
        );
    }
    let targets = [
        ("the target speed", setup.target.speed_mm_s),
        ("the target force", setup.target.force_n),
    ];
    for (what, target) in targets {
        if let Some(target) = target.filter(|target| !(*target > 0.0 && *target <= 1e4)) {
            return refuse(what, target, "it is above 0 and at most 10,000");
        }
    }
    setup.format.check(rate_hz)?;
    match setup.attempts {
        0 => refuse("the number of takes", 0.0, "at least one is needed"),
        _ => Ok(()),
    }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

/// The error of a take that was cut short, with the file that has its beginning.
fn with_kept(error: RecordError, kept: Option<Recorded>) -> RecordError {
    let after_s = kept.as_ref().map_or(0.0, |kept| kept.recorded_s);
    let kept = kept.map(|kept| kept.file);
    match error {
        RecordError::Ended { seconds, .. } => RecordError::Ended {
            after_s,
            seconds,
            kept,
        },
        RecordError::Left { .. } => RecordError::Left { kept },
        error => RecordError::Interrupted {
            error: Box::new(error),
            kept,
        },
    }
}

/// Writes the files of a part file and removes it; `None` if nothing was recorded.
fn finish(folder: &Path, path: &Path) -> Result<Option<Recorded>, RecordError> {
    let data = read_part(path)?.filter(|data| data.frames() > 0);
    let recorded = match data {
        None => None,
        Some(data) => {
            let verdict = judge(&data);
            let outcome = match (data.is_complete(), verdict.kept) {
                (false, _) => Outcome::Incomplete,
                (true, false) => Outcome::Rejected,
                (true, true) => Outcome::Kept,
            };
            let written = write_take(folder, &data, outcome, &verdict)?;
            Some(Recorded {
                file: written.recording,
                outcome,
                number: data.header.number,
                recorded_s: data.recorded_s(),
                verdict,
                fit: written.fit,
            })
        }
    };
    std::fs::remove_file(path).map_err(|error| RecordError::write(path, error))?;
    Ok(recorded)
}

/// Makes recordings of the takes that a killed program left in a folder, and returns them. A take that lacked only its renaming is
/// judged as it would have been. Takes that another program is recording are left alone.
///
/// # Errors
/// When a part file is damaged in its header, or a recording cannot be written.
pub fn recover(folder: &Path) -> Result<Vec<Recorded>, RecordError> {
    let parts = names::parts(folder).map_err(|error| RecordError::Part {
        file: folder.to_owned(),
        problem: error.to_string(),
    })?;
    let mut recovered = Vec::new();
    for path in &parts {
        match finish(folder, path) {
            Err(RecordError::Busy { .. }) => {}
            take => recovered.extend(take?),
        }
    }
    Ok(recovered)
}
