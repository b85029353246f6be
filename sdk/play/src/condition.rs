//! The condition at which a texture is played when no motion is given.

use htex_format::{AtCondition, Condition, Representation};

use crate::exploration::slides;

/// Returns the default condition of a representation, as an index into its `at`: the first
/// condition, or the strongest if the first is silent. A condition is silent if its level is 0, or
/// if a finger does not slide at its stated speed or force. The strongest condition is the one with
/// the highest level among those that are not silent; of equal ones it is the first. If all are
/// silent, the first condition is the default.
///
/// ```no_run
/// let asset = htex::Texture::open("sandpaper.htex")?;
/// let manifest = asset.manifest();
/// let representation = &manifest.representations[0];
/// let at = &representation.at[htex::default_condition(representation, &manifest.conditions)];
/// println!("{:?} at {}", manifest.conditions[at.condition], at.level_rms);
/// # Ok::<(), htex::Error>(())
/// ```
pub fn default_condition(representation: &Representation, conditions: &[Condition]) -> usize {
    let at = &representation.at;
    let sounds = |i: &usize| !is_silent(&at[*i], conditions);
    let stronger =
        |best: usize, i: usize| if at[i].level_rms > at[best].level_rms { i } else { best };
    if at.is_empty() || sounds(&0) {
        0
    } else {
        (1..at.len()).filter(sounds).reduce(stronger).unwrap_or(0)
    }
}

/// Returns whether nothing is felt at a condition. An unknown speed or force does not make it
/// silent.
fn is_silent(at: &AtCondition, conditions: &[Condition]) -> bool {
    let known = conditions.get(at.condition).copied().unwrap_or_default();
    let [speed_mm_s, force_n] = [known.speed_mm_s, known.force_n].map(|x| x.unwrap_or(f64::MAX));
    at.level_rms <= 0.0 || !slides(speed_mm_s, force_n)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the default condition, given the speed, force and level of each condition.
    fn default_of(all: &[(Option<f64>, Option<f64>, f64)]) -> usize {
        let condition = |(speed_mm_s, force_n, _): &(Option<f64>, Option<f64>, f64)| Condition {
            speed_mm_s: *speed_mm_s,
            force_n: *force_n,
            ..Condition::default()
        };
        let conditions: Vec<Condition> = all.iter().rev().map(condition).collect();
        let at = all.iter().enumerate().map(|(i, (_, _, level_rms))| AtCondition {
            // In reverse order, so that the index into `at` differs from the index of the
            // condition.
            condition: all.len() - 1 - i,
            level_rms: *level_rms,
            quality: None,
            left_out: None,
        });
        let representation = Representation {
            model: "org.example.x".to_owned(),
            model_version: "1.0.0".to_owned(),
            fields: Vec::new(),
            at: at.collect(),
            triangles: Vec::new(),
            parameters: String::new(),
        };
        default_condition(&representation, &conditions)
    }

    #[test]
    fn the_strongest_takes_the_place_of_a_silent_first() {
        let at = |speed, force, level| (Some(speed), Some(force), level);
        assert_eq!(default_of(&[at(80.0, 0.4, 0.1), at(160.0, 0.4, 0.3)]), 0, "it sounds");
        for silent in [at(80.0, 0.4, 0.0), at(0.0, 0.4, 0.9), at(80.0, 0.0, 0.9), at(0.4, 0.4, 0.9)]
        {
            let all = [silent, at(40.0, 0.4, 0.1), at(80.0, 0.4, 0.3), at(160.0, 0.4, 0.3)];
            assert_eq!(default_of(&all), 2, "{silent:?}: the first of the strongest");
            assert_eq!(default_of(&[silent, at(0.0, 0.0, 0.5)]), 0, "all are silent");
        }
        let unknown = (None, None, 0.2);
        assert_eq!(default_of(&[unknown, at(80.0, 0.4, 0.3)]), 0, "not known, not at rest");
        assert_eq!(default_of(&[at(0.0, 0.0, 0.0), unknown]), 1);
        assert_eq!(default_of(&[]), 0);
    }
}
