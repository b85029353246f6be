//! Compares the answer of a reader with the expected answer.

use serde::Deserialize;
use serde_json::Value;

use super::Class;
use super::answer::{Answer, Found, Verdict};
use super::tasks::{Expected, Values, is_compared};

/// Allowed difference between two numbers, relative to the expected number.
const NEAR: f64 = 1e-8;

/// If a number is smaller than this fraction of the largest number in its list, the allowed
/// difference is relative to this fraction of the largest number.
const OF_THE_LARGEST: f64 = 1e-6;

/// The numbers of a player at a motion.
#[derive(Debug, Deserialize)]
pub(super) struct Numbers {
    pub(super) parameters: Vec<f64>,
    pub(super) frequency_factor: f64,
    pub(super) level_rms: f64,
    pub(super) magnitude: Vec<f64>,
}

/// A motion, and the expected numbers at this motion; `None` if a player must refuse to play.
#[derive(Debug)]
pub(super) struct Case {
    pub(super) what: String,
    pub(super) expected: Option<Numbers>,
}

/// The counts of one run for each class, and the mistakes that were found.
#[derive(Debug, Default)]
pub(super) struct Outcome {
    pub(super) counts: Vec<(Class, usize, usize)>,
    pub(super) wrong: Vec<(Vec<Class>, String)>,
}

impl Outcome {
    fn count(&mut self, class: Class, passed: usize, all: usize) {
        self.counts.push((class, passed, all));
    }

    /// Returns the outcome of a run without an answer: nothing has passed.
    pub(super) fn failed(expected: &Expected, sentence: String) -> Self {
        let mut outcome = Self::default();
        if expected.findings.is_some() {
            outcome.count(Class::Validator, 0, 1);
            outcome.count(Class::Reader, 0, 1);
        }
        match &expected.values {
            Values::None => {}
            Values::Hashes(_) => outcome.count(Class::Player, 0, 1),
            Values::Cases(cases) => outcome.count(Class::Player, 0, cases.len()),
        }
        let classes = outcome.counts.iter().map(|(class, ..)| *class).collect();
        outcome.wrong.push((classes, sentence));
        outcome
    }

    /// Compares an answer.
    pub(super) fn of(expected: &Expected, answer: &Answer) -> Self {
        let mut outcome = Self::default();
        let right = answer.verdict == expected.verdict;
        if let Some(findings) = &expected.findings {
            outcome.findings(findings, right, answer);
            outcome.count(Class::Reader, usize::from(right), 1);
            if !right {
                let verdict = wrong_verdict(expected.verdict, answer.verdict);
                outcome.wrong.push((vec![Class::Validator, Class::Reader], verdict));
            }
        }
        match &expected.values {
            Values::None => {}
            Values::Hashes(hashes) => outcome.hashes(hashes, answer.values.as_ref()),
            Values::Cases(cases) if right => outcome.cases(cases, answer.values.as_ref()),
            Values::Cases(cases) => {
                outcome.count(Class::Player, 0, cases.len());
                let verdict = wrong_verdict(expected.verdict, answer.verdict);
                outcome.wrong.push((vec![Class::Player], verdict));
            }
        }
        outcome
    }

    fn findings(&mut self, expected: &[Found], right: bool, answer: &Answer) {
        let found: Option<Vec<&Found>> =
            answer.findings.as_ref().map(|all| all.iter().filter(|one| is_compared(one)).collect());
        let same = found.as_ref().is_some_and(|found| found.iter().copied().eq(expected));
        self.count(Class::Validator, usize::from(same && right), 1);
        if !same {
            let expected = listed(&expected.iter().collect::<Vec<_>>());
            let sentence = match found {
                Some(found) => format!("findings: {} instead of {expected}", listed(&found)),
                None => format!("findings: the answer has none instead of {expected}"),
            };
            self.wrong.push((vec![Class::Validator], sentence));
        }
    }

    fn hashes(&mut self, expected: &[(&'static str, String)], values: Option<&Value>) {
        let mut wrong = Vec::new();
        for (name, hash) in expected {
            let given = values.and_then(|values| values.get(name)).and_then(Value::as_str);
            if given != Some(hash) {
                wrong.push(match given {
                    Some(given) => format!("values: {name} is {given} instead of {hash}"),
                    None => format!("values: {name} is missing"),
                });
            }
        }
        self.count(Class::Player, usize::from(wrong.is_empty()), 1);
        self.wrong.extend(wrong.into_iter().map(|sentence| (vec![Class::Player], sentence)));
    }

    fn cases(&mut self, expected: &[Case], values: Option<&Value>) {
        let given = values.and_then(|values| values.get("cases")).and_then(Value::as_array);
        let (mut passed, mut wrong) = (0, Vec::new());
        match given {
            Some(given) if given.len() == expected.len() => {
                for (case, given) in expected.iter().zip(given) {
                    match difference(case.expected.as_ref(), given) {
                        None => passed += 1,
                        Some(problem) => wrong.push(format!("{}: {problem}", case.what)),
                    }
                }
            }
            Some(given) => {
                let (given, expected) = (given.len(), expected.len());
                wrong.push(format!("values: {given} cases instead of {expected}"));
            }
            None => wrong.push("values: `cases` is missing".to_owned()),
        }
        self.count(Class::Player, passed, expected.len());
        self.wrong.extend(wrong.into_iter().map(|sentence| (vec![Class::Player], sentence)));
    }
}

fn wrong_verdict(expected: Verdict, given: Verdict) -> String {
    format!("verdict: {} instead of {}", given.name(), expected.name())
}

/// Returns findings for a sentence.
fn listed(findings: &[&Found]) -> String {
    const MOST: usize = 4;
    if findings.is_empty() {
        return "no finding".to_owned();
    }
    let shown: Vec<String> = findings.iter().take(MOST).map(ToString::to_string).collect();
    match findings.len().saturating_sub(MOST) {
        0 => shown.join(", "),
        more => format!("{} and {more} more", shown.join(", ")),
    }
}

/// Returns what is wrong with the numbers of a case. `null` means that the player refuses to play.
fn difference(expected: Option<&Numbers>, given: &Value) -> Option<String> {
    let Some(expected) = expected else {
        return (!given.is_null()).then(|| "it is played, and has to be refused".to_owned());
    };
    if given.is_null() {
        return Some("it is refused, and has to be played".to_owned());
    }
    let given: Numbers = match Numbers::deserialize(given) {
        Ok(given) => given,
        Err(error) => return Some(format!("its numbers are wrong: {error}")),
    };
    let lists = [
        ("parameters", &expected.parameters[..], &given.parameters[..]),
        ("frequency_factor", &[expected.frequency_factor], &[given.frequency_factor]),
        ("level_rms", &[expected.level_rms], &[given.level_rms]),
        ("magnitude", &expected.magnitude, &given.magnitude),
    ];
    lists.into_iter().find_map(|(name, expected, given)| far(name, expected, given))
}

/// Returns what differs in two lists of numbers.
fn far(name: &str, expected: &[f64], given: &[f64]) -> Option<String> {
    if expected.len() != given.len() {
        return Some(format!("{name}: {} numbers instead of {}", given.len(), expected.len()));
    }
    let largest = expected.iter().fold(0.0f64, |most, x| most.max(x.abs()));
    let is_near =
        |(a, b): &(&f64, &f64)| (*a - *b).abs() <= NEAR * a.abs().max(OF_THE_LARGEST * largest);
    let place = expected.iter().zip(given).position(|pair| !is_near(&pair))?;
    let at = if expected.len() == 1 { String::new() } else { format!("[{place}]") };
    Some(format!("{name}{at}: {} instead of {}", given[place], expected[place]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_near_to_themselves_or_to_the_largest() {
        let differs = |expected: &[f64], given: &[f64]| far("x", expected, given).is_some();
        assert!(!differs(&[1.0, 1e-9], &[1.0 + 0.9e-8, 1e-9 + 0.9e-14]));
        assert!(differs(&[1.0, 1e-9], &[1.0 + 1.1e-8, 1e-9]));
        assert!(differs(&[1.0, 1e-9], &[1.0, 1e-9 + 1.1e-14]));
        assert!(differs(&[0.0], &[1e-300]));
        assert!(!differs(&[0.0], &[0.0]));
        assert!(differs(&[1.0], &[f64::NAN]));
        assert!(differs(&[1.0], &[1.0, 1.0]));
    }
}
