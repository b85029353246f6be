//! The plan of a study: the order of trials for every participant.

use serde::Serialize;

use crate::study::Study;
use crate::study::file::{Order, Phase};
use crate::study::random::Dice;

/// The order of trials for every participant. The order depends only on the study file.
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
    /// Practice trials; empty if the study has no training phase.
    pub training: Vec<Trial>,
    /// Textures in the order in which their gains are matched. All textures are played with the
    /// model that the study uses for gain matching. Empty if the study has no gain phase.
    pub gain: Vec<String>,
    /// The rated trials.
    pub trials: Vec<Trial>,
}

#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Trial {
    /// Number of the trial within its phase, from 1.
    pub number: u32,
    pub texture: String,
    pub model: String,
    /// Number of this repetition of the texture with this model, from 1.
    pub repetition: u32,
    /// Whether the trial's model is the study's hidden reference.
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

    /// Returns a participant's plan, or `None` if the study has no participant with this name.
    pub fn participant(&self, name: &str) -> Option<&ParticipantPlan> {
        let mut all = self.participants.iter();
        all.find(|plan| plan.participant == name)
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

/// Draws practice trials at random. A condition is repeated only after every condition has
/// occurred.
fn training(study: &Study, name: &str) -> Vec<Trial> {
    if !study.has(Phase::Training) {
        return Vec::new();
    }
    // Each phase has its own random numbers, so a change of one phase does not change the others.
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

/// A texture and the model that plays it, both as indices. The index after the last model stands
/// for the hidden reference.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Condition {
    pub(crate) texture: usize,
    pub(crate) model: usize,
}

/// Returns all conditions, texture by texture.
pub(crate) fn conditions(study: &Study) -> Vec<Condition> {
    let models = study.all_models().len();
    let with_models = |texture| (0..models).map(move |model| Condition { texture, model });
    (0..study.textures.len()).flat_map(with_models).collect()
}

/// Returns the conditions of all trials of a participant, in order. `index` is the participant's
/// place in the list.
pub(crate) fn order(study: &Study, index: usize, name: &str) -> Vec<Condition> {
    let all = conditions(study);
    let mut dice = Dice::new(study.seed, &["order", name]);
    let repetitions = study.repetitions as usize;
    match study.order {
        Order::Random => {
            let mut trials = all.repeat(repetitions);
            dice.shuffle(&mut trials);
            trials
        }
        Order::BlockedByRepetition => blocks(&all, repetitions, &mut dice),
        Order::BlockedByTexture => by_texture(&all, study, &mut dice),
        Order::LatinSquare => rows(study, &all, index, &latin),
        Order::WilliamsSquare => rows(study, &all, index, &williams),
    }
}

fn blocks(all: &[Condition], repetitions: usize, dice: &mut Dice) -> Vec<Condition> {
    let mut trials = Vec::new();
    for _ in 0..repetitions {
        let mut block = all.to_vec();
        dice.shuffle(&mut block);
        trials.extend(block);
    }
    trials
}

fn by_texture(all: &[Condition], study: &Study, dice: &mut Dice) -> Vec<Condition> {
    let mut trials = Vec::new();
    for texture in dice.permutation(study.textures.len()) {
        let own = all.iter().copied().filter(|c| c.texture == texture);
        let mut block = own.collect::<Vec<_>>().repeat(study.repetitions as usize);
        dice.shuffle(&mut block);
        trials.extend(block);
    }
    trials
}

/// Returns a participant's rows of a square, one for each repetition. The first participant gets
/// the first rows, the second participant the next rows, and so on. The assignment of conditions to
/// symbols and the order of the rows are shuffled once for the whole study.
fn rows(
    study: &Study,
    all: &[Condition],
    participant: usize,
    square: &dyn Fn(usize) -> Vec<Vec<usize>>,
) -> Vec<Condition> {
    let mut dice = Dice::new(study.seed, &["square"]);
    let symbols = dice.permutation(all.len());
    let mut rows = square(all.len());
    dice.shuffle(&mut rows);
    let repetitions = study.repetitions as usize;
    let first = participant * repetitions;
    let own = (first..first + repetitions).map(|row| &rows[row % rows.len()]);
    own.flatten().map(|symbol| all[symbols[*symbol]]).collect()
}

/// Returns a Latin square: n rows of n symbols, with each symbol once in each row and in each
/// column. It is a cyclic square whose columns are permuted at random, but always in the same way.
/// Without the permutation, each symbol would always follow the same symbol. `rows` shuffles the
/// rows.
fn latin(count: usize) -> Vec<Vec<usize>> {
    let columns = Dice::new(count as u64, &["columns"]).permutation(count);
    let row = |row| columns.iter().map(|at| (row + at) % count).collect();
    (0..count).map(row).collect()
}

/// Returns a Williams square of n symbols. It has n rows if n is even, and 2n rows if n is odd.
/// Each ordered pair of different symbols is adjacent equally often (Williams 1949, "Experimental
/// designs balanced for the estimation of residual effects of treatments").
fn williams(count: usize) -> Vec<Vec<usize>> {
    // The first row is 0, 1, n-1, 2, n-2, …, because all differences between its neighbours are
    // different.
    let first: Vec<usize> = (0..count)
        .map(|at| match at {
            0 => 0,
            odd if odd % 2 == 1 => odd.div_ceil(2),
            even => count - even / 2,
        })
        .collect();
    let row = |add: usize| first.iter().map(|at| (at + add) % count).collect();
    let mut rows: Vec<Vec<usize>> = (0..count).map(row).collect();
    // For an odd number of symbols, these rows alone do not balance which symbol follows which.
    // Their mirror images complete the balance.
    if count % 2 == 1 {
        let mirrored: Vec<Vec<usize>> =
            rows.iter().map(|row| row.iter().rev().copied().collect()).collect();
        rows.extend(mirrored);
    }
    rows
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn check_latin(rows: &[Vec<usize>], count: usize, each: usize) {
        for column in 0..count {
            let mut seen = vec![0; count];
            rows.iter().for_each(|row| seen[row[column]] += 1);
            assert!(seen.iter().all(|times| *times == each), "column {column}");
        }
        for row in rows {
            let mut sorted = row.clone();
            sorted.sort_unstable();
            assert_eq!(sorted, (0..count).collect::<Vec<_>>());
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn squares_are_balanced(count in 1usize..40) {
            check_latin(&latin(count), count, 1);
            let rows = williams(count);
            let each = rows.len() / count;
            check_latin(&rows, count, each);
            let mut follows = vec![vec![0; count]; count];
            for pair in rows.iter().flat_map(|row| row.windows(2)) {
                follows[pair[0]][pair[1]] += 1;
            }
            for (a, row) in follows.iter().enumerate() {
                for (b, times) in row.iter().enumerate() {
                    prop_assert_eq!(*times, if a == b { 0 } else { each });
                }
            }
        }
    }
}
