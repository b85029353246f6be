//! Gain matching: a state machine that advances with each key press.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::study::file::{GainMethod, Matching};

/// A key that the participant presses during the gain matching.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum GainKey {
    /// Stronger by a step. In a staircase, this key means that the texture should be stronger.
    Stronger,
    /// Stronger by a large step.
    MuchStronger,
    /// Weaker by a step. In a staircase, this key means that the texture should be weaker.
    Weaker,
    /// Weaker by a large step.
    MuchWeaker,
    /// While the level rises, this key means that the participant feels the texture. During the
    /// matching, this key means that the texture matches the real texture.
    Accept,
}

/// Finds the level of one texture. The level rises from a weak start until the participant feels
/// the texture. From this level on, the participant matches the texture to the real texture. Levels
/// are in decibels relative to the maximum.
///
/// ```
/// use htex_lab::study::{GainKey, Match, Matching};
/// let mut matching = Match::new(&Matching::default(), -20.0);
/// assert!(matching.is_rising() && matching.gain_db() == -20.0);
/// for _ in 0..4 {
///     matching.press(GainKey::MuchStronger);
/// }
/// matching.press(GainKey::Accept); // It is felt at -4 dB.
/// assert!(!matching.press(GainKey::Stronger), "the descending method goes only down");
/// matching.press(GainKey::Weaker);
/// matching.press(GainKey::Accept);
/// assert_eq!((matching.is_found(), matching.gain_db()), (true, -5.0));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Match {
    settings: Matching,
    gain_db: f64,
    stage: Stage,
    /// Whether the result is the level at which the participant feels the texture. In this case
    /// there is no matching.
    ends_when_felt: bool,
    /// Gains at which a staircase turned.
    reversals: Vec<f64>,
    /// Whether the last judgement of a staircase was `stronger`.
    rose: Option<bool>,
}

/// Stage of finding a level.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Stage {
    Rising,
    Matching,
    Found,
}

impl Match {
    /// Prepares a matching that first raises the level from `start_db` until the participant feels
    /// the texture.
    pub fn new(settings: &Matching, start_db: f64) -> Self {
        Self {
            settings: settings.clone(),
            // Nothing may be stronger than the maximum.
            gain_db: start_db.min(0.0),
            stage: Stage::Rising,
            ends_when_felt: false,
            reversals: Vec::new(),
            rose: None,
        }
    }

    /// Prepares a search without a matching: the level only rises from `start_db`. The result is
    /// the level at which the participant feels the texture. The step sizes come from `settings`.
    pub fn rise(settings: &Matching, start_db: f64) -> Self {
        Self { ends_when_felt: true, ..Self::new(settings, start_db) }
    }

    /// Returns the current gain. After the gain is found, the current gain is the result.
    pub fn gain_db(&self) -> f64 {
        self.gain_db
    }

    /// Returns whether the gain is found.
    pub fn is_found(&self) -> bool {
        self.stage == Stage::Found
    }

    /// Returns whether the level is still rising, because the participant has not felt the texture
    /// yet.
    pub fn is_rising(&self) -> bool {
        self.stage == Stage::Rising
    }

    pub fn method(&self) -> GainMethod {
        self.settings.method
    }

    /// Returns whether the key has a meaning now. While the level rises, all keys have a meaning,
    /// so a participant can always ask for a weaker level.
    pub fn takes(&self, key: GainKey) -> bool {
        takes(self.settings.method, self.is_rising(), key)
    }

    /// Applies a key. Returns false and changes nothing if the key has no meaning now or the gain
    /// is already found.
    pub fn press(&mut self, key: GainKey) -> bool {
        if self.is_found() || !self.takes(key) {
            return false;
        }
        if key == GainKey::Accept {
            self.stage = if self.is_rising() && !self.ends_when_felt {
                Stage::Matching
            } else {
                Stage::Found
            };
            return true;
        }
        match self.settings.method {
            GainMethod::Staircase if !self.is_rising() => self.judge(key == GainKey::Stronger),
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
            // The first two reversals are left out, because they come from large steps and from the
            // start.
            let counted = self.reversals.get(2..).unwrap_or_default();
            self.gain_db = counted.iter().sum::<f64>() / counted.len().max(1) as f64;
            self.stage = Stage::Found;
            return;
        }
        let step_db = if self.reversals.is_empty() {
            self.settings.large_step_db
        } else {
            self.settings.step_db
        };
        self.change(if rise { step_db } else { -step_db });
    }

    fn change(&mut self, by_db: f64) {
        // If the gain starts below the lowest gain, it stays below it until the participant raises
        // it.
        let lowest = self.settings.lowest_db.min(self.gain_db);
        self.gain_db = (self.gain_db + by_db).clamp(lowest, 0.0);
    }
}

/// Returns whether a key has a meaning while the level rises, or in a method of matching.
pub(crate) fn takes(method: GainMethod, is_rising: bool, key: GainKey) -> bool {
    match method {
        _ if is_rising => true,
        GainMethod::Adjustment => true,
        GainMethod::Descending => !matches!(key, GainKey::Stronger | GainKey::MuchStronger),
        GainMethod::Staircase => matches!(key, GainKey::Stronger | GainKey::Weaker),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// With every method, the gain that is found differs by at most one step from the gain that the
    /// participant wants.
    #[test]
    fn every_method_finds_the_gain_that_is_wanted() {
        use GainMethod::{Adjustment, Descending, Staircase};
        for method in [Descending, Adjustment, Staircase] {
            for wanted_db in [-1.0, -7.3, -20.5] {
                let settings = Matching { method, ..Matching::default() };
                let mut matching = Match::new(&settings, -20.0);
                while matching.is_rising() {
                    let key = if matching.gain_db() < 0.0 {
                        GainKey::MuchStronger
                    } else {
                        GainKey::Accept
                    };
                    assert!(matching.press(key));
                }
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

    /// No method exceeds its start level before the participant asks for a higher level. A matching
    /// starts at the level at which the texture was felt.
    #[test]
    fn every_method_starts_weak_and_goes_on_from_the_level_that_is_felt() {
        use GainMethod::{Adjustment, Descending, Staircase};
        for method in [Descending, Adjustment, Staircase] {
            let settings = Matching { method, ..Matching::default() };
            let mut matching = Match::new(&settings, -20.0);
            assert_eq!(matching.gain_db(), -20.0);
            let rise = [GainKey::MuchStronger, GainKey::Stronger, GainKey::Weaker];
            assert!(rise.into_iter().all(|key| matching.press(key)));
            assert!(matching.is_rising() && matching.gain_db() == -16.0);
            assert!(matching.press(GainKey::Accept) && !matching.is_found());
            assert!(!matching.is_rising() && matching.gain_db() == -16.0);
        }
        let mut rise = Match::rise(&Matching::default(), -20.0);
        assert!(rise.press(GainKey::Stronger) && rise.press(GainKey::Accept));
        assert_eq!((rise.is_found(), rise.gain_db()), (true, -19.0));
    }
}
