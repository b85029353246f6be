//! Rules for the contents of a study, without looking at its files.

use std::collections::BTreeSet;

use htex_base::finding::{Findings, Rule};

use crate::study::file::{Matching, Participants, Phase, Study};
use crate::study::rules as rule;

/// Largest number of trials in one session, and in the whole study.
const MOST_TRIALS: usize = 100_000;
const MOST_IN_ALL: usize = 1_000_000;
const MOST_PARTICIPANTS: usize = 1000;

pub(crate) fn check(study: &Study, findings: &mut Findings) {
    check_participants(&study.participants, findings);
    check_textures(study, findings);
    check_models(study, findings);
    check_names("attributes", attributes(study), findings);
    let count = study.attributes.len();
    let range = |what: &str| format!("{count} {what}; write 1 to 32");
    let fits = (1..=32).contains(&count);
    findings.require(fits, rule::STUDY_NUMBER_INVALID, "/attributes", || range("attributes"));
    check_numbers(study, findings);
    check_matching(&study.gain, findings);
    let scale = &study.scale;
    // Participants answer with one digit key.
    let sound = scale.min < scale.max && scale.max <= 9;
    findings.require(sound, rule::STUDY_SCALE_INVALID, "/scale", || {
        let (min, max) = (scale.min, scale.max);
        format!(
            "the scale is {min} to {max}; write two digits, the lower one as min, such as 0 and 6"
        )
    });
    check_phases(study, findings);
    check_size(study, findings);
}

fn check_participants(participants: &Participants, findings: &mut Findings) {
    let count = participants.count();
    let fits = (1..=MOST_PARTICIPANTS).contains(&count);
    findings.require(fits, rule::STUDY_PARTICIPANTS_INVALID, "/participants", || {
        format!("there are {count} participants; write 1 to {MOST_PARTICIPANTS}")
    });
    let Participants::Names(names) = participants else {
        return;
    };
    let mut seen = BTreeSet::new();
    for (i, name) in names.iter().enumerate() {
        let plain = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
        let sound = !name.is_empty() && name.len() <= 64 && name.chars().all(plain);
        // Each participant has a file, and some file systems ignore case.
        let is_new = seen.insert(name.to_ascii_lowercase());
        let pointer = format!("/participants/{i}");
        let rule = rule::STUDY_PARTICIPANTS_INVALID;
        findings.require(sound, rule, &pointer, || {
            format!(
                "{name:?} is no name of a participant; use letters, digits, - and _, at most 64"
            )
        });
        findings.require(is_new, rule, &pointer, || {
            format!("{name:?} occurs twice, perhaps in another case; name each participant once")
        });
    }
}

fn check_textures(study: &Study, findings: &mut Findings) {
    let count = study.textures.len();
    let fits = (1..=256).contains(&count);
    findings.require(fits, rule::STUDY_TEXTURES_INVALID, "/textures", || {
        format!("there are {count} textures; write 1 to 256")
    });
    let names = study.textures.iter().map(|texture| texture.name());
    check_names("textures", names, findings);
}

fn check_models(study: &Study, findings: &mut Findings) {
    let count = study.models.len();
    let rule = rule::STUDY_MODELS_INVALID;
    let fits = (1..=64).contains(&count);
    findings.require(fits, rule, "/models", || format!("there are {count} models; write 1 to 64"));
    check_names("models", study.models.iter().cloned(), findings);
    let named = study.models.iter().enumerate().map(|(i, model)| (format!("/models/{i}"), model));
    let reference =
        study.hidden_reference.iter().map(|model| ("/hidden_reference".to_owned(), model));
    let gain = [("/gain/model".to_owned(), &study.gain.model)];
    for (pointer, model) in named.chain(reference).chain(gain) {
        // With `auto` the planner would choose, and two conditions could be the same model.
        findings.require(model != "auto", rule, pointer, || {
            "auto is no model of a study; name one".to_owned()
        });
    }
    if let Some(reference) = &study.hidden_reference {
        let apart = !study.models.contains(reference) && !reference.trim().is_empty();
        findings.require(apart, rule, "/hidden_reference", || {
            format!("the hidden reference {reference:?} is empty or also in models; name another")
        });
    }
}

fn attributes(study: &Study) -> impl Iterator<Item = String> {
    study.attributes.iter().map(|a| a.name.clone())
}

fn check_names(key: &str, names: impl Iterator<Item = String>, findings: &mut Findings) {
    let mut seen = BTreeSet::new();
    for (i, name) in names.enumerate() {
        let sound = !name.trim().is_empty()
            && name.chars().count() <= 100
            && !name.chars().any(char::is_control);
        let is_new = seen.insert(name.clone());
        let pointer = format!("/{key}/{i}");
        findings.require(sound, rule::STUDY_NAME_INVALID, &pointer, || {
            format!("the name {name:?} is empty, too long, or has control characters; correct it")
        });
        findings.require(is_new, rule::STUDY_NAME_INVALID, &pointer, || {
            format!("the name {name:?} occurs twice; give each another name")
        });
    }
}

/// Checks that a number is in a range. `pointer` names it in findings.
fn require_in(value: f64, pointer: &str, from: f64, to: f64, findings: &mut Findings) {
    let rule: &Rule = rule::STUDY_NUMBER_INVALID;
    findings.require((from..=to).contains(&value), rule, pointer, || {
        format!("{value} is out of range; write {from} to {to}")
    });
}

fn check_numbers(study: &Study, findings: &mut Findings) {
    let repetitions = f64::from(study.repetitions);
    require_in(repetitions, "/repetitions", 1.0, 1000.0, findings);
    require_in(study.trial_s, "/trial_s", 0.01, 3600.0, findings);
    let trials = f64::from(study.training.trials);
    require_in(trials, "/training/trials", 1.0, 1000.0, findings);
    require_in(study.start_db, "/start_db", -120.0, 0.0, findings);
    if let Some(noise) = &study.masking_noise {
        let level = noise.level_dbfs;
        require_in(level, "/masking_noise/level_dbfs", -80.0, -10.0, findings);
    }
    if let Some(rests) = &study.rests {
        let every = f64::from(rests.every);
        require_in(every, "/rests/every", 1.0, 1e5, findings);
        require_in(rests.seconds, "/rests/seconds", 0.0, 3600.0, findings);
    }
}

fn check_matching(gain: &Matching, findings: &mut Findings) {
    require_in(gain.step_db, "/gain/step_db", 0.01, 20.0, findings);
    let large = gain.large_step_db;
    require_in(large, "/gain/large_step_db", 0.01, 40.0, findings);
    require_in(gain.lowest_db, "/gain/lowest_db", -120.0, -1.0, findings);
    let reversals = f64::from(gain.reversals);
    require_in(reversals, "/gain/reversals", 3.0, 50.0, findings);
}

fn check_phases(study: &Study, findings: &mut Findings) {
    let once = |phase| study.phases.iter().filter(|p| **p == phase).count() <= 1;
    let all = [Phase::Training, Phase::Gain, Phase::Testing];
    let sound = all.into_iter().all(once) && study.has(Phase::Testing);
    findings.require(sound, rule::STUDY_PHASES_INVALID, "/phases", || {
        "each phase is listed once, and testing among them; correct the list".to_owned()
    });
}

fn check_size(study: &Study, findings: &mut Findings) {
    let conditions = study.textures.len() * study.all_models().len();
    let trials = conditions.saturating_mul(study.repetitions as usize);
    let all = trials.saturating_mul(study.participants.count().max(1));
    let fits = trials <= MOST_TRIALS && all <= MOST_IN_ALL;
    findings.require(fits, rule::STUDY_TOO_LARGE, "", || {
        format!(
            "a session has {trials} trials and the study {all}; at most {MOST_TRIALS} and {MOST_IN_ALL}"
        )
    });
}
