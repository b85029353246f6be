//! Simulated participants, for trying out and testing a study. Every file with their answers states
//! that they are simulated.

use crate::study::file::{Phase, Scale};
use crate::study::gain::{GainKey, Match};
use crate::study::lines::Simulated;
use crate::study::plan::Trial;
use crate::study::random::Dice;

/// The rule, as the header of answers states it.
const RULE: &str = "rating = top - span * e / (e + 6) + b + n, rounded and held to the scale; e: nine-band error of the representation, \
    dB; b: bias of the participant, standard deviation 0.07 of the span; n: noise of the trial, 0.1 of the span";
/// Nine-band error at which the rating is in the middle of the scale, dB.
const MIDDLE_DB: f64 = 6.0;
/// Standard deviations, as fractions of the scale's span.
const BIAS: f64 = 0.07;
const NOISE: f64 = 0.1;
/// Range of the gains that simulated participants accept, dB relative to the maximum.
const GAIN_DB: (f64, f64) = (-18.0, -2.0);

/// A simulated participant. Representations with a larger nine-band error get lower ratings,
/// because this error was the paper's best predictor of similarity. A rating does not depend on
/// earlier ratings, but only on the seed, the participant and the trial.
#[derive(Debug, Clone)]
pub struct SimulatedParticipant {
    seed: u64,
    name: String,
}

impl SimulatedParticipant {
    pub fn new(seed: u64, name: &str) -> Self {
        let name = name.to_owned();
        Self { seed, name }
    }

    /// Returns the participant's entry in the header of answers.
    pub fn header(&self) -> Simulated {
        Simulated { seed: self.seed, rule: RULE.split_whitespace().collect::<Vec<_>>().join(" ") }
    }

    /// Returns the participant's rating of a trial in a phase. `error_db` is the nine-band error of
    /// the representation, dB.
    pub fn rating(
        &self,
        phase: Phase,
        trial: &Trial,
        attribute: &str,
        error_db: f64,
        scale: &Scale,
    ) -> u8 {
        let (low, top) = (f64::from(scale.min), f64::from(scale.max));
        let span = top - low;
        let bias = Dice::new(self.seed, &["bias", &self.name]).normal();
        let noise = self.dice("noise", phase, trial, attribute).normal();
        let error_db = error_db.max(0.0);
        let mean = top - span * error_db / (error_db + MIDDLE_DB);
        let felt = mean + span * (BIAS * bias + NOISE * noise);
        felt.round().clamp(low, top) as u8
    }

    /// Returns the time that the participant takes for a rating, milliseconds.
    pub fn response_ms(&self, phase: Phase, trial: &Trial, attribute: &str) -> u64 {
        800 + self.dice("response", phase, trial, attribute).bits() % 1200
    }

    /// Returns the participant's next key while a texture's gain is matched. Each texture has a
    /// different wanted gain.
    pub(crate) fn gain_key(&self, texture: &str, matching: &Match) -> GainKey {
        let mut dice = Dice::new(self.seed, &["gain", &self.name, texture]);
        let share = (dice.bits() >> 11) as f64 / (1u64 << 53) as f64;
        let wanted_db = GAIN_DB.0 + share * (GAIN_DB.1 - GAIN_DB.0);
        let off_db = matching.gain_db() - wanted_db;
        if matching.is_rising() {
            // The rise stops when the texture is at least as strong as the participant wants.
            return if off_db < 0.0 && matching.gain_db() < 0.0 {
                GainKey::MuchStronger
            } else {
                GainKey::Accept
            };
        }
        let key = match off_db {
            off if off > 5.0 => GainKey::MuchWeaker,
            off if off > 0.5 => GainKey::Weaker,
            _ => GainKey::Accept,
        };
        match (matching.takes(key), off_db > 0.0) {
            (true, _) => key,
            // A staircase only asks for a direction.
            (false, true) => GainKey::Weaker,
            (false, false) => GainKey::Stronger,
        }
    }

    fn dice(&self, what: &str, phase: Phase, trial: &Trial, attribute: &str) -> Dice {
        let number = format!("{phase:?} {}", trial.number);
        Dice::new(self.seed, &[what, &self.name, &number, attribute])
    }
}
