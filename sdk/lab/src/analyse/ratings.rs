//! The table of ratings: participant, texture, model, repetition, rating.

use std::collections::BTreeSet;
use std::ops::RangeInclusive;

use htex_format::Findings;

use super::answers::{Answers, Cell, Rated, read_answers};
use super::rules::{
    RATINGS_CELL_MISSING, RATINGS_LEFT_OUT, RATINGS_NONE_COMPLETE, RATINGS_PARTICIPANT_CONSTANT,
    RATINGS_SIMULATED, RATINGS_TOO_MANY_CONDITIONS, RATINGS_UNBALANCED,
};
use super::sheet::{Checked, Invalid, Sheet, invalid};

const MOST_CONDITIONS: usize = 1000;
/// What to do with participants that have not rated every condition.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Incomplete {
    /// A missing condition is an error.
    #[default]
    Refuse,
    /// The participant is left out, with a warning.
    LeaveOut,
}

/// Mean ratings of a study: one for each participant, texture and model.
#[derive(Debug, Clone, PartialEq)]
pub struct Ratings {
    /// Names, in alphabetical order.
    pub participants: Vec<String>,
    /// Names, in alphabetical order.
    pub textures: Vec<String>,
    /// Names, in alphabetical order.
    pub models: Vec<String>,
    /// Largest number of repetitions of a condition.
    pub repetitions: usize,
    /// Participants whose answers are simulated.
    pub simulated: Vec<String>,
    /// Mean and number of repetitions, by participant, then texture, then model.
    cells: Vec<(f64, usize)>,
}

impl Ratings {
    /// Reads and checks a table of ratings.
    ///
    /// Columns are found by name: `participant`, `texture`, `model`, `repetition` and `rating`. Of those that `htex study export` writes
    /// beside them, `simulated` marks answers that no person gave, lines of a `hidden_reference` are not analysed, and `attribute` must be the
    /// same in all lines. Others are not used.
    ///
    /// # Errors
    /// Every finding of the table, if one of them is an error.
    pub fn read(bytes: &[u8], incomplete: Incomplete) -> Result<Checked<Self>, Invalid> {
        Self::read_on_scale(bytes, incomplete, None)
    }

    /// As [`Self::read`]; ratings that are not on the scale are errors, each with its line.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn read_on_scale(
        bytes: &[u8],
        incomplete: Incomplete,
        scale: Option<&RangeInclusive<f64>>,
    ) -> Result<Checked<Self>, Invalid> {
        let mut findings = Findings::default();
        let Rated { answers, simulated } = read_answers(bytes, scale, &mut findings)?;
        let ratings = Self::of_answers(answers, simulated, incomplete, &mut findings);
        let Some(ratings) = ratings else {
            return Err(invalid(findings));
        };
        ratings.judge(&mut findings);
        Sheet::finish(findings, ratings)
    }

    fn of_answers(
        answers: Answers,
        simulated: BTreeSet<String>,
        incomplete: Incomplete,
        findings: &mut Findings,
    ) -> Option<Self> {
        let names = |of: fn(&Cell) -> &String| -> Vec<String> {
            let all: BTreeSet<&String> = answers.keys().map(of).collect();
            all.into_iter().cloned().collect()
        };
        let (mut participants, textures, models) =
            (names(|c| &c.0), names(|c| &c.1), names(|c| &c.2));
        if answers.is_empty() {
            let message = "every line is a hidden reference".to_owned();
            findings.add(RATINGS_NONE_COMPLETE, "", message);
            return None;
        }
        let conditions = textures.len() * models.len();
        if conditions > MOST_CONDITIONS {
            let message = format!(
                "{} textures and {} models make {conditions} conditions",
                textures.len(),
                models.len()
            );
            findings.add(RATINGS_TOO_MANY_CONDITIONS, "", message);
            return None;
        }
        let conditions = pairs(&textures, &models);
        participants.retain(|participant| {
            is_complete(participant, &conditions, &answers, incomplete, findings)
        });
        if participants.is_empty() && !findings.has_errors() {
            let message = "no participant has rated every model in every texture".to_owned();
            findings.add(RATINGS_NONE_COMPLETE, "", message);
        }
        if findings.has_errors() {
            return None;
        }
        let mut cells = Vec::new();
        for participant in &participants {
            for (texture, model) in &conditions {
                let cell = (participant.clone(), texture.clone(), model.clone());
                let values = answers.get(&cell)?;
                cells.push((mean(values.values()), values.len()));
            }
        }
        Some(Self {
            repetitions: cells.iter().map(|cell| cell.1).max().unwrap_or(0),
            simulated: simulated
                .into_iter()
                .filter(|s| participants.contains(s))
                .collect(),
            participants,
            textures,
            models,
            cells,
        })
    }

    /// Findings about a table that can be analysed.
    fn judge(&self, findings: &mut Findings) {
        let fewest = self.cells.iter().map(|cell| cell.1).min().unwrap_or(0);
        findings.require(fewest == self.repetitions, RATINGS_UNBALANCED, "", || {
            format!(
                "conditions have {fewest} to {} repetitions",
                self.repetitions
            )
        });
        for (index, participant) in self.participants.iter().enumerate() {
            let row = self.row(index);
            let same = row.len() < 2 || row.iter().any(|value| *value != row[0]);
            findings.require(same, RATINGS_PARTICIPANT_CONSTANT, "", || {
                format!(
                    "participant {participant} gave every condition the rating {}",
                    row[0]
                )
            });
        }
        findings.require(self.simulated.is_empty(), RATINGS_SIMULATED, "", || {
            format!(
                "{} of {} participants are simulated",
                self.simulated.len(),
                self.participants.len()
            )
        });
    }

    /// The mean rating of a condition, by indices.
    pub fn mean(&self, participant: usize, texture: usize, model: usize) -> f64 {
        self.cell(participant, texture, model).0
    }

    /// The number of repetitions of a condition, by indices.
    pub fn count(&self, participant: usize, texture: usize, model: usize) -> usize {
        self.cell(participant, texture, model).1
    }

    /// All means of a participant, by texture, then model.
    pub fn row(&self, participant: usize) -> Vec<f64> {
        let conditions = self.textures.len() * self.models.len();
        let row = self.cells.iter().skip(participant * conditions);
        row.take(conditions).map(|cell| cell.0).collect()
    }

    /// All means, by participant, then texture, then model.
    pub fn means(&self) -> Vec<f64> {
        self.cells.iter().map(|cell| cell.0).collect()
    }

    fn cell(&self, participant: usize, texture: usize, model: usize) -> (f64, usize) {
        let row = participant * self.textures.len() + texture;
        self.cells[row * self.models.len() + model]
    }
}

/// Whether a participant rated all conditions.
fn is_complete(
    participant: &str,
    conditions: &[(String, String)],
    answers: &Answers,
    incomplete: Incomplete,
    findings: &mut Findings,
) -> bool {
    let is_missing = |(texture, model): &&(String, String)| {
        !answers.contains_key(&(participant.to_owned(), texture.clone(), model.clone()))
    };
    let missing: Vec<_> = conditions.iter().filter(is_missing).collect();
    let Some((texture, model)) = missing.first() else {
        return true;
    };
    let (rule, consequence) = match incomplete {
        Incomplete::Refuse => (
            RATINGS_CELL_MISSING,
            "complete it, or leave the participant out",
        ),
        Incomplete::LeaveOut => (RATINGS_LEFT_OUT, "the participant is left out"),
    };
    let more = match missing.len() {
        1 => String::new(),
        count => format!(" and {} others", count - 1),
    };
    let message = format!(
        "participant {participant} has no rating of model {model} in texture {texture}{more}; {consequence}"
    );
    findings.add(rule, "", message);
    false
}

fn pairs(textures: &[String], models: &[String]) -> Vec<(String, String)> {
    let of = |texture: &String| {
        let texture = texture.clone();
        models
            .iter()
            .map(move |model| (texture.clone(), model.clone()))
    };
    textures.iter().flat_map(of).collect()
}

fn mean<'a>(values: impl ExactSizeIterator<Item = &'a f64>) -> f64 {
    let count = values.len() as f64;
    values.sum::<f64>() / count
}
