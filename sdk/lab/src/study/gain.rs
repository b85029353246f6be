//! Matching of a gain: a state machine of key presses.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::study::file::{GainMethod, Matching};

/// A press of a key while a gain is matched.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum GainKey {
    /// Stronger by a step; in a staircase, it should be stronger.
    Stronger,
    /// Stronger by a large step.
    MuchStronger,
    /// Weaker by a step; in a staircase, it should be weaker.
    Weaker,
    /// Weaker by a large step.
    MuchWeaker,
    /// It matches.
    Accept,
}

/// The matching of one texture. Gains are in decibels relative to the maximum.
///
/// ```
/// use htex_lab::study::{GainKey, Match, Matching};
/// let mut descending = Match::new(&Matching::default());
/// assert!(!descending.press(GainKey::Stronger), "only down");
/// assert!(descending.press(GainKey::Weaker) && descending.press(GainKey::MuchWeaker));
/// descending.press(GainKey::Accept);
/// assert_eq!((descending.is_found(), descending.gain_db()), (true, -5.0));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Match {
    settings: Matching,
    gain_db: f64,
    is_found: bool,
    /// Gains at which a staircase turned.
    reversals: Vec<f64>,
    /// Whether the last judgement of a staircase was `stronger`.
    rose: Option<bool>,
}

impl Match {
    /// A matching at the maximum, 0 dB.
    pub fn new(settings: &Matching) -> Self {
        Self {
            settings: settings.clone(),
            gain_db: 0.0,
            is_found: false,
            reversals: Vec::new(),
            rose: None,
        }
    }

    /// The present gain; the result once it is found.
    pub fn gain_db(&self) -> f64 {
        self.gain_db
    }

    /// Whether the gain is found.
    pub fn is_found(&self) -> bool {
        self.is_found
    }

    pub fn method(&self) -> GainMethod {
        self.settings.method
    }

    /// Whether the key has a meaning in this method.
    pub fn takes(&self, key: GainKey) -> bool {
        match self.settings.method {
            GainMethod::Adjustment => true,
            GainMethod::Descending => !matches!(key, GainKey::Stronger | GainKey::MuchStronger),
            GainMethod::Staircase => matches!(key, GainKey::Stronger | GainKey::Weaker),
        }
    }

    /// Takes a key; false, and nothing changes, if it has no meaning here or the gain is found.
    pub fn press(&mut self, key: GainKey) -> bool {
        if self.is_found || !self.takes(key) {
            return false;
        }
        if key == GainKey::Accept {
            self.is_found = true;
            return true;
        }
        match self.settings.method {
            GainMethod::Staircase => self.judge(key == GainKey::Stronger),
            _ => self.change(match key {
                GainKey::Stronger => self.settings.step_db,
                GainKey::MuchStronger => self.settings.large_step_db,
                GainKey::MuchWeaker => -self.settings.large_step_db,
                _ => -self.settings.step_db,
            }),
        }
        true
    }

    fn judge(&mut self, rise: bool) {
        if self.rose.is_some_and(|rose| rose != rise) {
            self.reversals.push(self.gain_db);
        }
        self.rose = Some(rise);
        if self.reversals.len() >= self.settings.reversals as usize {
            // The first two come from large steps and from the start.
            let counted = self.reversals.get(2..).unwrap_or_default();
            self.gain_db = counted.iter().sum::<f64>() / counted.len().max(1) as f64;
            self.is_found = true;
            return;
        }
        let step_db = match self.reversals.is_empty() {
            true => self.settings.large_step_db,
            false => self.settings.step_db,
        };
        self.change(if rise { step_db } else { -step_db });
    }

    fn change(&mut self, by_db: f64) {
        let lowest = self.settings.lowest_db.min(0.0);
        self.gain_db = (self.gain_db + by_db).clamp(lowest, 0.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A person who wants the texture at a gain is found within a step by every method.
    #[test]
    fn every_method_finds_the_gain_that_is_wanted() {
        use GainMethod::{Adjustment, Descending, Staircase};
        for method in [Descending, Adjustment, Staircase] {
            for wanted_db in [-1.0, -7.3, -20.5] {
                let settings = Matching {
                    method,
                    ..Matching::default()
                };
                let mut matching = Match::new(&settings);
                let mut presses = 0;
                while !matching.is_found() && presses < 200 {
                    let off = matching.gain_db() - wanted_db;
                    let key = match method {
                        Staircase if off <= 0.0 => GainKey::Stronger,
                        Staircase => GainKey::Weaker,
                        _ if off > 4.5 => GainKey::MuchWeaker,
                        _ if off > 0.5 => GainKey::Weaker,
                        _ => GainKey::Accept,
                    };
                    assert!(matching.press(key));
                    presses += 1;
                }
                let off = (matching.gain_db() - wanted_db).abs();
                assert!(matching.is_found() && off <= 1.0, "{method:?}: {off} dB");
                assert!(!matching.press(GainKey::Weaker), "it is found");
            }
        }
    }
}
