//! Computes the progress of a session from the session's plan and from the lines in its file of
//! answers.
//!
//! The plan and the progress are not stored but computed from the files. Therefore, even after a
//! session was killed, the plan and the progress agree with the file of answers.

use crate::study::Study;
use crate::study::file::{Attribute, Phase};
use crate::study::gain::{GainKey, Match};
use crate::study::lines::{Answer, GainPress, Line, Rise, Stop};
use crate::study::plan::{ParticipantPlan, Trial};

/// Largest allowed difference between the level that a line states and the level that its key
/// gives, decibels.
const LEVEL_TOLERANCE_DB: f64 = 1e-6;

/// The next step of a session.
#[derive(Debug, Clone, PartialEq)]
pub enum Step {
    /// The participant rates one attribute of a trial. The trial is played before the rating,
    /// unless the trial was just played.
    Rate(Phase, Trial, Attribute),
    /// The participant sets the level of a texture. In training, before the texture's first
    /// practice trial, the level rises until the participant feels the texture. In the gain phase,
    /// the participant matches the texture's gain.
    Match {
        phase: Phase,
        texture: String,
        /// The model that plays the texture.
        model: String,
        /// The matching so far.
        matching: Match,
    },
    Rest {
        /// Number of trials before the rest.
        after: u32,
        /// Shortest length of the rest, seconds.
        seconds: f64,
    },
    Done,
}

/// A session's progress. The same function applies lines that were read from the file and lines
/// that are recorded now.
#[derive(Debug)]
pub(crate) struct Progress {
    training: usize,
    answers: usize,
    rests: u32,
    /// Levels of the textures in the training, in the order in which they first occur.
    rises: Vec<Level>,
    /// Levels of the textures to be matched, in the plan's order.
    gains: Vec<Level>,
    /// Number of stops since the last line that is not a stop.
    stops: u32,
    last_ms: u64,
}

/// The level of a texture in one phase.
#[derive(Debug)]
struct Level {
    texture: String,
    model: String,
    matching: Match,
    /// After the level is found, the RMS that corresponds to the drive at this level.
    reference_rms: f64,
}

impl Progress {
    pub(crate) fn new(study: &Study, plan: &ParticipantPlan) -> Self {
        Self {
            training: 0,
            answers: 0,
            rests: 0,
            rises: rises(study, plan),
            gains: gains(study, plan),
            stops: 0,
            last_ms: 0,
        }
    }

    /// Returns the number of stops since the last line that is not a stop.
    pub(crate) fn stops(&self) -> u32 {
        self.stops
    }

    /// Returns the time of the last line, milliseconds.
    pub(crate) fn last_ms(&self) -> u64 {
        self.last_ms
    }

    /// Returns the number of ratings in the testing so far.
    pub(crate) fn answers(&self) -> usize {
        self.answers
    }

    /// Returns the next step.
    pub(crate) fn step(&self, study: &Study, plan: &ParticipantPlan) -> Step {
        if let Some(step) = rate(Phase::Training, &plan.training, self.training, study) {
            return self.rise_before(&step).unwrap_or(step);
        }
        if let Some(level) = self.gains.iter().find(|level| !level.matching.is_found()) {
            return level.step(Phase::Gain);
        }
        let trials_done = self.answers / study.attributes.len().max(1);
        let is_between = self.answers.is_multiple_of(study.attributes.len().max(1));
        // A rest comes only between two trials, not between two questions about one trial, and not
        // after the last trial.
        let left = plan.trials.len() - trials_done.min(plan.trials.len());
        if let Some(rests) = study.rests.as_ref().filter(|_| is_between && left > 0) {
            let due = trials_done as u32 / rests.every.max(1);
            if due > self.rests {
                return Step::Rest { after: due * rests.every, seconds: rests.seconds };
            }
        }
        rate(Phase::Testing, &plan.trials, self.answers, study).unwrap_or(Step::Done)
    }

    /// If the next step is a practice trial of a texture that the participant has not felt yet,
    /// returns the rise of this texture.
    fn rise_before(&self, step: &Step) -> Option<Step> {
        let Step::Rate(Phase::Training, trial, _) = step else {
            return None;
        };
        let of_trial = |level: &&Level| level.texture == trial.texture;
        let level = self.rises.iter().find(of_trial)?;
        (!level.matching.is_found()).then(|| level.step(Phase::Training))
    }

    /// Returns the level that was found for a texture, for the trials of a phase: decibels relative
    /// to the maximum, and the corresponding RMS.
    pub(crate) fn found(&self, phase: Phase, texture: &str) -> Option<(f64, f64)> {
        let levels = match phase {
            Phase::Training => &self.rises,
            Phase::Gain | Phase::Testing => &self.gains,
        };
        let level = levels.iter().find(|level| level.texture == texture)?;
        let matching = &level.matching;
        let found = (matching.gain_db(), level.reference_rms);
        matching.is_found().then_some(found)
    }

    /// Applies a line.
    ///
    /// # Errors
    /// Returns the reason if this line cannot come next.
    pub(crate) fn apply(
        &mut self,
        study: &Study,
        plan: &ParticipantPlan,
        line: &Line,
    ) -> Result<(), String> {
        if matches!(line, Line::Session(_)) {
            return Ok(());
        }
        match (self.step(study, plan), line) {
            (Step::Rate(Phase::Training, trial, attribute), Line::Training(answer)) => {
                belongs(&trial, &attribute.name, answer, study)?;
                self.training += 1;
            }
            (Step::Rate(Phase::Testing, trial, attribute), Line::Answer(answer)) => {
                belongs(&trial, &attribute.name, answer, study)?;
                self.answers += 1;
            }
            (Step::Match { phase, matching, .. }, Line::Rise(rise)) if matching.is_rising() => {
                self.rise(phase, rise)?;
            }
            (Step::Match { matching, .. }, Line::Gain(matched)) if !matching.is_rising() => {
                self.press(matched)?;
            }
            (step, Line::Stopped(stopped)) => {
                stops(&step, stopped)?;
                self.stops += 1;
                self.last_ms = line.at_ms();
                // The function returns here, because its end would set the number of stops to 0.
                return Ok(());
            }
            (Step::Rest { after, .. }, Line::Rest { after: is, .. }) if after == *is => {
                self.rests += 1;
            }
            _ => return Err("it does not come next in the study's plan".to_owned()),
        }
        self.stops = 0;
        self.last_ms = line.at_ms();
        Ok(())
    }

    fn rise(&mut self, phase: Phase, line: &Rise) -> Result<(), String> {
        let levels = match phase {
            Phase::Training => &mut self.rises,
            Phase::Gain | Phase::Testing => &mut self.gains,
        };
        let mut open = levels.iter_mut().filter(|one| !one.matching.is_found());
        let level = open
            .find(|one| one.texture == line.texture && one.model == line.model)
            .filter(|_| phase == line.phase);
        let wrong = || format!("this key for {} does not come next", line.texture);
        level.ok_or_else(wrong)?.press(line.key, line.gain_db, line.reference_rms)
    }

    fn press(&mut self, line: &GainPress) -> Result<(), String> {
        let wrong = || format!("this key for {} does not come next", line.texture);
        let mut open = self.gains.iter_mut();
        let level = open.find(|level| !level.matching.is_found());
        let level = level.filter(|level| level.texture == line.texture);
        level.ok_or_else(wrong)?.press(line.key, line.gain_db, line.reference_rms)
    }
}

impl Level {
    fn step(&self, phase: Phase) -> Step {
        Step::Match {
            phase,
            texture: self.texture.clone(),
            model: self.model.clone(),
            matching: self.matching.clone(),
        }
    }

    /// Applies a key. After the key, the level must be `gain_db`. Otherwise, the line was written
    /// under other rules, and it is not known what the participant felt.
    fn press(&mut self, key: GainKey, gain_db: f64, reference_rms: f64) -> Result<(), String> {
        // The key is applied to a copy, so that an invalid line changes nothing.
        let mut pressed = self.matching.clone();
        if !pressed.press(key) {
            return Err(format!("this key for {} does not come next", self.texture));
        }
        let level_db = pressed.gain_db();
        if (level_db - gain_db).abs() > LEVEL_TOLERANCE_DB {
            return Err(format!(
                "after this key {} is at {level_db} dB, and the line says {gain_db} dB",
                self.texture
            ));
        }
        self.matching = pressed;
        self.reference_rms = reference_rms;
        Ok(())
    }
}

/// Returns each texture of the training, with the model that plays it in its first trial.
fn rises(study: &Study, plan: &ParticipantPlan) -> Vec<Level> {
    let mut levels: Vec<Level> = Vec::new();
    for trial in &plan.training {
        if levels.iter().all(|level| level.texture != trial.texture) {
            levels.push(Level {
                texture: trial.texture.clone(),
                model: trial.model.clone(),
                matching: Match::rise(&study.gain, study.start_db),
                reference_rms: 0.0,
            });
        }
    }
    levels
}

fn gains(study: &Study, plan: &ParticipantPlan) -> Vec<Level> {
    let level = |texture: &String| Level {
        texture: texture.clone(),
        model: study.gain.model.clone(),
        matching: Match::new(&study.gain, study.start_db),
        reference_rms: 0.0,
    };
    plan.gain.iter().map(level).collect()
}

/// Checks that the stimulus that the line stops is the current one.
fn stops(step: &Step, line: &Stop) -> Result<(), String> {
    let is_this = match step {
        Step::Rate(phase, trial, _) => {
            (*phase, &trial.texture, &trial.model) == (line.phase, &line.texture, &line.model)
        }
        Step::Match { phase, texture, model, .. } => {
            (*phase, texture, model) == (line.phase, &line.texture, &line.model)
        }
        Step::Rest { .. } | Step::Done => false,
    };
    let (texture, model) = (&line.texture, &line.model);
    if is_this { Ok(()) } else { Err(format!("{texture} with {model} does not play here")) }
}

/// Returns the next rating of a phase after `ratings` ratings, or `None` at the end of the phase.
fn rate(phase: Phase, trials: &[Trial], ratings: usize, study: &Study) -> Option<Step> {
    let each = study.attributes.len().max(1);
    let trial = trials.get(ratings / each)?.clone();
    let attribute = study.attributes.get(ratings % each)?.clone();
    Some(Step::Rate(phase, trial, attribute))
}

fn belongs(trial: &Trial, attribute: &str, answer: &Answer, study: &Study) -> Result<(), String> {
    let same = trial.number == answer.number
        && trial.texture == answer.texture
        && trial.model == answer.model
        && attribute == answer.attribute;
    let (number, texture, model) = (trial.number, &trial.texture, &trial.model);
    if !same {
        return Err(format!(
            "trial {number} of the plan is {texture} with {model}, and it has trial {} of {} with {}",
            answer.number, answer.texture, answer.model
        ));
    }
    let range = study.scale.min..=study.scale.max;
    if range.contains(&answer.rating) {
        Ok(())
    } else {
        Err(format!("the rating {} is not on the scale", answer.rating))
    }
}
