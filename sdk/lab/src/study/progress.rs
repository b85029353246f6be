//! How far a session is: computed from its plan and its lines.
//!
//! Neither the plan nor the progress is stored: a session that was killed cannot disagree with its file.

use crate::study::Study;
use crate::study::file::{Attribute, Phase};
use crate::study::gain::Match;
use crate::study::lines::{Answer, Line, Matched};
use crate::study::plan::{ParticipantPlan, Trial};

/// What comes next in a session.
#[derive(Debug, Clone, PartialEq)]
pub enum Step {
    /// A trial is played, unless it just was, and rated by an attribute.
    Rate(Phase, Trial, Attribute),
    /// The gain of a texture is matched.
    Match {
        texture: String,
        /// The matching so far.
        matching: Match,
    },
    Rest {
        /// Trials before it.
        after: u32,
        /// Shortest length, seconds.
        seconds: f64,
    },
    Done,
}

/// A session's progress. Lines that were read and lines that are recorded are applied by the same function.
#[derive(Debug)]
pub(crate) struct Progress {
    training: usize,
    answers: usize,
    rests: u32,
    /// The textures that are matched, or being matched, in the plan's order.
    gains: Vec<(Match, Option<Matched>)>,
    last_ms: u64,
}

impl Progress {
    pub(crate) fn new(study: &Study, plan: &ParticipantPlan) -> Self {
        Self {
            training: 0,
            answers: 0,
            rests: 0,
            gains: vec![(Match::new(&study.gain), None); plan.gain.len()],
            last_ms: 0,
        }
    }

    /// Time of the last line, milliseconds.
    pub(crate) fn last_ms(&self) -> u64 {
        self.last_ms
    }

    /// Ratings of the testing so far.
    pub(crate) fn answers(&self) -> usize {
        self.answers
    }

    /// What comes next.
    pub(crate) fn step(&self, study: &Study, plan: &ParticipantPlan) -> Step {
        if let Some(step) = rate(Phase::Training, &plan.training, self.training, study) {
            return step;
        }
        if let Some(i) = self.gains.iter().position(|(m, _)| !m.is_found()) {
            return Step::Match {
                texture: plan.gain[i].clone(),
                matching: self.gains[i].0.clone(),
            };
        }
        let trials_done = self.answers / study.attributes.len().max(1);
        let is_between = self.answers.is_multiple_of(study.attributes.len().max(1));
        let left = plan.trials.len() - trials_done.min(plan.trials.len());
        if let Some(rests) = study.rests.as_ref().filter(|_| is_between && left > 0) {
            let due = trials_done as u32 / rests.every.max(1);
            if due > self.rests {
                return Step::Rest {
                    after: due * rests.every,
                    seconds: rests.seconds,
                };
            }
        }
        rate(Phase::Testing, &plan.trials, self.answers, study).unwrap_or(Step::Done)
    }

    /// The gain that was found for a texture.
    pub(crate) fn found(&self, plan: &ParticipantPlan, texture: &str) -> Option<&Matched> {
        let i = plan.gain.iter().position(|name| name == texture)?;
        self.gains.get(i)?.1.as_ref()
    }

    /// Applies a line.
    ///
    /// # Errors
    /// The reason why this line cannot come next.
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
            (Step::Match { texture, .. }, Line::Gain(matched)) => {
                self.press(plan, &texture, matched)?;
            }
            (Step::Rest { after, .. }, Line::Rest { after: is, .. }) if after == *is => {
                self.rests += 1;
            }
            _ => return Err("it does not come next in the study's plan".to_owned()),
        }
        self.last_ms = line.at_ms();
        Ok(())
    }

    fn press(
        &mut self,
        plan: &ParticipantPlan,
        texture: &str,
        line: &Matched,
    ) -> Result<(), String> {
        let wrong = || format!("this key for {} does not come next", line.texture);
        let at = plan.gain.iter().position(|name| name == texture);
        let (matching, found) = at.and_then(|i| self.gains.get_mut(i)).ok_or_else(wrong)?;
        if line.texture != texture || !matching.press(line.key) {
            return Err(wrong());
        }
        if matching.is_found() {
            *found = Some(Matched {
                gain_db: matching.gain_db(),
                ..line.clone()
            });
        }
        Ok(())
    }
}

/// The rating after so many ratings of a phase; `None` at its end.
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
    match range.contains(&answer.rating) {
        true => Ok(()),
        false => Err(format!("the rating {} is not on the scale", answer.rating)),
    }
}
