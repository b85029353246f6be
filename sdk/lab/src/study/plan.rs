//! The plan of a study: the order of every participant.

use serde::Serialize;

use crate::study::Study;
use crate::study::file::Phase;
use crate::study::order::{Condition, conditions, order};
use crate::study::random::Dice;

/// The order of trials for every participant, determined only by the study file.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Plan {
    /// Version of the study's format.
    pub htex_study: String,
    /// Name of the study.
    pub name: String,
    pub seed: u64,
    pub participants: Vec<ParticipantPlan>,
}

/// The order of trials for one participant.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ParticipantPlan {
    pub participant: String,
    /// Practice trials; empty without that phase.
    pub training: Vec<Trial>,
    /// Textures in the order in which they are matched, all in the study's matching model. Empty
    /// without that phase.
    pub gain: Vec<String>,
    /// The rated trials.
    pub trials: Vec<Trial>,
}

#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Trial {
    /// Number within its phase, from 1.
    pub number: u32,
    pub texture: String,
    pub model: String,
    /// Repetition of this texture with this model, from 1.
    pub repetition: u32,
    /// Whether the model is the hidden reference.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub hidden_reference: bool,
}

impl Plan {
    /// Computes the plan of a valid study.
    pub fn new(study: &Study) -> Self {
        let names = study.participants.names();
        let plan = |(index, name): (usize, &String)| ParticipantPlan::new(study, index, name);
        Self {
            htex_study: study.htex_study.clone(),
            name: study.name.clone(),
            seed: study.seed,
            participants: names.iter().enumerate().map(plan).collect(),
        }
    }

    /// Returns a participant's plan; `None` if the study has no participant with this name.
    pub fn of(&self, participant: &str) -> Option<&ParticipantPlan> {
        let mut all = self.participants.iter();
        all.find(|plan| plan.participant == participant)
    }
}

impl ParticipantPlan {
    fn new(study: &Study, index: usize, name: &str) -> Self {
        Self {
            participant: name.to_owned(),
            training: training(study, name),
            gain: if study.has(Phase::Gain) { gain_order(study, name) } else { Vec::new() },
            trials: trials(study, &order(study, index, name)),
        }
    }
}

/// Draws practice trials at random. Every condition occurs before any occurs twice.
fn training(study: &Study, name: &str) -> Vec<Trial> {
    if !study.has(Phase::Training) {
        return Vec::new();
    }
    // Each phase has dice of its own, so a change of one phase leaves the others as they are.
    let mut dice = Dice::new(study.seed, &["training", name]);
    let mut drawn = Vec::new();
    while drawn.len() < study.training.trials as usize {
        let mut all = conditions(study);
        dice.shuffle(&mut all);
        drawn.extend(all);
    }
    drawn.truncate(study.training.trials as usize);
    trials(study, &drawn)
}

fn gain_order(study: &Study, name: &str) -> Vec<String> {
    let mut dice = Dice::new(study.seed, &["gain", name]);
    let order = dice.permutation(study.textures.len());
    order.iter().map(|i| study.textures[*i].name()).collect()
}

/// Numbers the trials and the repetitions of each condition.
fn trials(study: &Study, order: &[Condition]) -> Vec<Trial> {
    let models = study.all_models();
    let mut seen = vec![0; study.textures.len() * models.len()];
    let trial = |(i, condition): (usize, &Condition)| {
        let times = &mut seen[condition.texture * models.len() + condition.model];
        *times += 1;
        Trial {
            number: i as u32 + 1,
            texture: study.textures[condition.texture].name(),
            model: models[condition.model].to_owned(),
            repetition: *times,
            hidden_reference: condition.model == study.models.len(),
        }
    };
    order.iter().enumerate().map(trial).collect()
}
