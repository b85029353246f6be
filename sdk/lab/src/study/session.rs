//! A session: takes one participant through the plan of a study.

use std::path::Path;

use crate::error::LabError;
use crate::study::Study;
use crate::study::asking::Playback;
use crate::study::file::Phase;
use crate::study::gain::{GainKey, Match};
use crate::study::lines::{
    Answer, DeviceUsed, FeltFile, GainPress, Header, Line, OutputLevels, Rise, SessionStart, Stop,
    StopReason,
};
use crate::study::log::{Log, participant_file};
use crate::study::plan::{ParticipantPlan, Trial};
use crate::study::progress::{Progress, Step};
use crate::study::stimulus::Stimulus;

/// A participant's session with its open file of answers. Everything that a method records is on
/// disk when the method returns.
#[derive(Debug)]
pub struct Session<'a> {
    study: &'a Study,
    plan: &'a ParticipantPlan,
    log: Log,
    progress: Progress,
    is_simulated: bool,
    is_recorded: bool,
    device: DeviceUsed,
    tool: String,
}

/// How a trial was played before it was rated.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Presentation {
    /// Drive of a display, volts.
    pub drive_v: Option<f64>,
    /// Levels of the samples that were written to the device.
    pub output: Option<OutputLevels>,
    /// Number of earlier attempts at this trial that were stopped, for any reason.
    pub stops: u32,
    /// The file with the force that a sensor recorded during the trial. `None` if no force was
    /// recorded.
    pub felt: Option<FeltFile>,
    /// Number of earlier attempts at this trial that ended because the device ran out of samples.
    pub repeats: u32,
}

impl<'a> Session<'a> {
    /// Opens a session in a folder. Starts a new session or, if the participant has a file of
    /// answers in this folder, continues the session at the next step.
    ///
    /// # Errors
    /// Returns the errors of [`Log::open`], and [`LabError::Line`] if a line does not belong to the
    /// plan.
    pub fn open(
        study: &'a Study,
        plan: &'a ParticipantPlan,
        folder: &Path,
        header: &Header,
    ) -> Result<Self, LabError> {
        let path = participant_file(folder, &plan.participant);
        let (log, lines) = Log::open(&path, header)?;
        let mut progress = Progress::new(study, plan);
        for (i, line) in lines.iter().enumerate() {
            let applied = progress.apply(study, plan, line);
            applied.map_err(|problem| LabError::Line {
                file: path.clone(),
                // The header is line 1 of the file.
                line: i + 2,
                problem,
            })?;
        }
        Ok(Self {
            study,
            plan,
            log,
            progress,
            is_simulated: header.simulated.is_some(),
            is_recorded: header.source.is_some(),
            device: header.device.clone(),
            tool: header.tool.clone(),
        })
    }

    /// Returns the next step.
    pub fn step(&self) -> Step {
        self.progress.step(self.study, self.plan)
    }

    pub fn study(&self) -> &'a Study {
        self.study
    }

    pub fn participant(&self) -> &str {
        &self.plan.participant
    }

    /// Returns the path of the file of answers.
    pub fn file(&self) -> &Path {
        self.log.path()
    }

    pub fn is_simulated(&self) -> bool {
        self.is_simulated
    }

    /// Returns the number of rated trials, and the total number of trials.
    pub fn trials(&self) -> (usize, usize) {
        let each = self.study.attributes.len().max(1);
        (self.progress.answers() / each, self.plan.trials.len())
    }

    /// Returns the time of the last line, milliseconds; 0 before the first.
    pub(crate) fn last_ms(&self) -> u64 {
        self.progress.last_ms()
    }

    /// Returns the stimulus of a trial.
    pub fn stimulus(&self, phase: Phase, trial: &Trial) -> Stimulus {
        let found = self.progress.found(phase, &trial.texture);
        let name = match phase {
            Phase::Training => "training",
            _ => "trial",
        };
        Stimulus {
            texture: trial.texture.clone(),
            model: trial.model.clone(),
            seconds: Some(self.study.trial_s),
            seed: self.seed(name, trial.number),
            gain_db: found.map(|(gain_db, _)| gain_db),
            reference_rms: found.map(|(_, reference_rms)| reference_rms),
            felt: self.is_recorded.then(|| felt_name(name, trial)),
            file: format!("{name}-{:04}", trial.number),
        }
    }

    /// Returns the stimulus that plays while the level of a texture rises or its gain is matched.
    pub(crate) fn matching_stimulus(
        &self,
        phase: Phase,
        texture: &str,
        model: &str,
        matching: &Match,
    ) -> Stimulus {
        let name = match phase {
            Phase::Training => "rise",
            Phase::Gain | Phase::Testing => "gain",
        };
        Stimulus {
            texture: texture.to_owned(),
            model: model.to_owned(),
            seconds: None,
            seed: self.seed(&format!("{name} {texture}"), 0),
            gain_db: Some(matching.gain_db()),
            reference_rms: None,
            felt: None,
            file: format!("{name}-{texture}"),
        }
    }

    /// Returns how many earlier attempts at the current stimulus were stopped.
    pub fn stops(&self) -> u32 {
        self.progress.stops()
    }

    /// Returns a seed for the samples of one trial of one participant.
    fn seed(&self, what: &str, number: u32) -> u64 {
        // The seed depends only on names and trial numbers, so a continued session plays the same
        // samples.
        let purpose = ["samples", self.participant(), what, &number.to_string()];
        crate::study::random::Dice::new(self.study.seed, &purpose).bits()
    }

    /// Records that a session begins, with its date ([`crate::study::utc`]) and device.
    ///
    /// # Errors
    /// [`LabError::File`].
    pub fn begin(&mut self, date: String, at_ms: u64) -> Result<(), LabError> {
        self.record(Line::Session(SessionStart {
            date,
            at_ms,
            device: self.device.clone(),
            tool: self.tool.clone(),
            simulated: self.is_simulated,
        }))
    }

    /// Records a rating for the current step, and how the rated trial was played.
    ///
    /// # Errors
    /// Returns [`LabError::Line`] if the current step does not accept this rating, and
    /// [`LabError::File`] if the file of answers cannot be written.
    pub fn rate(
        &mut self,
        rating: u8,
        response_ms: u64,
        at_ms: u64,
        presented: Presentation,
    ) -> Result<(), LabError> {
        let Step::Rate(phase, trial, attribute) = self.step() else {
            return Err(self.misplaced("no trial is rated now"));
        };
        let answer = Answer {
            number: trial.number,
            gain_db: self.stimulus(phase, &trial).gain_db,
            drive_v: presented.drive_v,
            output: presented.output,
            stops: presented.stops,
            texture: trial.texture,
            model: trial.model,
            repetition: trial.repetition,
            hidden_reference: trial.hidden_reference,
            attribute: attribute.name,
            rating,
            response_ms,
            at_ms,
            repeats: presented.repeats,
            felt: presented.felt,
            simulated: self.is_simulated,
        };
        self.record(match phase {
            Phase::Training => Line::Training(answer),
            _ => Line::Answer(answer),
        })
    }

    /// Records a key press while a level rises or a gain is matched. Also records how the texture
    /// was played before the key press.
    ///
    /// # Errors
    /// Returns the errors of [`Self::rate`].
    pub fn press(&mut self, key: GainKey, played: &Playback, at_ms: u64) -> Result<(), LabError> {
        let Step::Match { phase, texture, model, mut matching } = self.step() else {
            return Err(self.misplaced("no gain is matched now"));
        };
        // This is read before the press, because the press may end the rise.
        let was_rising = matching.is_rising();
        matching.press(key);
        let gain_db = matching.gain_db();
        let (drive_v, output) = (played.drive_v, played.output.clone());
        let (stops, simulated) = (self.stops(), self.is_simulated);
        let reference_rms = played.reference_rms;
        self.record(if was_rising {
            Line::Rise(Rise {
                phase,
                texture,
                model,
                key,
                gain_db,
                found: !matching.is_rising(),
                drive_v,
                output,
                stops,
                reference_rms,
                at_ms,
                simulated,
            })
        } else {
            Line::Gain(GainPress {
                texture,
                key,
                gain_db,
                found: matching.is_found(),
                drive_v,
                output: Some(output),
                stops,
                reference_rms,
                at_ms,
                simulated,
            })
        })
    }

    /// Records that the current stimulus was stopped before its end. Also records the levels that
    /// were written to the device until then.
    ///
    /// # Errors
    /// Returns the errors of [`Self::rate`].
    pub fn stopped(
        &mut self,
        reason: StopReason,
        drive_v: Option<f64>,
        output: Option<OutputLevels>,
        at_ms: u64,
    ) -> Result<(), LabError> {
        let (phase, texture, model, gain_db) = match self.step() {
            Step::Rate(phase, trial, _) => {
                let gain_db = self.stimulus(phase, &trial).gain_db;
                (phase, trial.texture, trial.model, gain_db)
            }
            Step::Match { phase, texture, model, matching } => {
                (phase, texture, model, Some(matching.gain_db()))
            }
            Step::Rest { .. } | Step::Done => return Err(self.misplaced("nothing plays now")),
        };
        self.record(Line::Stopped(Stop {
            phase,
            texture,
            model,
            reason,
            gain_db,
            drive_v,
            output,
            at_ms,
            simulated: self.is_simulated,
        }))
    }

    /// Records the end of a rest.
    ///
    /// # Errors
    /// Returns the errors of [`Self::rate`].
    pub fn rested(&mut self, at_ms: u64) -> Result<(), LabError> {
        let Step::Rest { after, .. } = self.step() else {
            return Err(self.misplaced("there is no rest now"));
        };
        let simulated = self.is_simulated;
        self.record(Line::Rest { after, at_ms, simulated })
    }

    /// First applies the line and then writes it, so that only valid lines are written.
    fn record(&mut self, line: Line) -> Result<(), LabError> {
        let applied = self.progress.apply(self.study, self.plan, &line);
        applied.map_err(|problem| self.misplaced(&problem))?;
        self.log.append(&line)
    }

    fn misplaced(&self, problem: &str) -> LabError {
        // The number is 0, because the line is not in the file.
        LabError::Line { file: self.log.path().to_owned(), line: 0, problem: problem.to_owned() }
    }
}

/// Returns the name of a trial's recording: its phase, number, texture and model, in characters
/// that every file system accepts.
fn felt_name(phase: &str, trial: &Trial) -> String {
    let name = format!("{phase}-{:04}-{}-{}", trial.number, trial.texture, trial.model);
    let plain = |c: char| if c.is_ascii_alphanumeric() || "-_.".contains(c) { c } else { '_' };
    name.chars().map(plain).take(120).collect()
}
