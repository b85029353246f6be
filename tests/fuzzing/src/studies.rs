//! Studies, and files of answers.

use std::sync::OnceLock;

use htex_base::finding::{Findings, plain};
use htex_lab::study::{
    Line, ParticipantPlan, Participants, Plan, Presentation, Session, Study, export, read_study,
};

use crate::promise::{self, sentence};

/// Largest number of trials of a plan that is made.
const MOST_TRIALS: usize = 100_000;

/// A study with two participants.
pub(crate) const STUDY: &str = "htex_study = '1.0'\nname = 'S'\nseed = 5\ntrial_s = 0.05\nparticipants = 2\nrepetitions = 1\n\
    models = ['ar', 'sbeta']\nphases = ['testing']\nmotion = { constant = { speed_mm_s = 80, force_n = 0.4 } }\n\
    device = { adapter = 'file' }\n[[textures]]\nasset = 'vinyl.htex'\n";

/// Reads a file `study.toml`, and makes the order of its participants.
pub fn study(input: &[u8]) -> bool {
    let mut findings = Findings::default();
    let study = read_study(input, &mut findings);
    let errors = findings.has_errors();
    assert_ne!(study.is_some(), errors, "a study, or a reason");
    promise::findings(&findings.into_list());
    let Some(study) = study else {
        return false;
    };
    if trials(&study) <= MOST_TRIALS {
        let plan = Plan::new(&study);
        assert_eq!(plan, Plan::new(&study), "the same study, another order");
    }
    true
}

fn trials(study: &Study) -> usize {
    let each = study.textures.len() * (study.models.len() + 1);
    let repeated = each.saturating_mul(study.repetitions as usize);
    let participants = match &study.participants {
        Participants::Count(count) => *count as usize,
        Participants::Names(names) => names.len(),
    };
    repeated.saturating_mul(participants)
}

/// Reads a participant's answers, exports them, and continues them with the session that they name.
pub fn answers(input: &[u8]) -> bool {
    static PLANNED: OnceLock<(Study, Plan)> = OnceLock::new();
    let (study, plan) = PLANNED.get_or_init(|| {
        let study = read_study(STUDY.as_bytes(), &mut Findings::default());
        let study = study.expect("a study");
        let plan = Plan::new(&study);
        (study, plan)
    });
    let folder = tempfile::tempdir().expect("a folder");
    let own: &ParticipantPlan = plan.participants.first().expect("a participant");
    let file = htex_lab::study::participant_file(folder.path(), &own.participant);
    std::fs::write(&file, input).expect("it can be written");
    let exported = match export(folder.path(), None) {
        Ok(export) => {
            export.warnings.iter().for_each(|warning| sentence(&plain(warning)));
            true
        }
        Err(error) => {
            sentence(&plain(&error.to_string()));
            false
        }
    };
    let first = input.split(|b| *b == b'\n').next().unwrap_or_default();
    let Ok(Line::Header(header)) = serde_json::from_slice(first) else {
        return exported;
    };
    match Session::open(study, own, folder.path(), &header) {
        Ok(session) => {
            let (done, all) = session.trials();
            assert!(done <= all, "{done} of {all} trials");
            session.step();
        }
        Err(error) => sentence(&plain(&error.to_string())),
    }
    exported
}

/// Answers of a session that was left after its first rating.
pub(crate) fn answered() -> String {
    let study = read_study(STUDY.as_bytes(), &mut Findings::default()).expect("a study");
    let plan = Plan::new(&study);
    let own = plan.participants.first().expect("a participant");
    let header = serde_json::json!({
        "htex_answers": "1.0", "study": "S", "participant": own.participant, "files": {}, "ratings": 2, "tool": "htex",
        "device": { "adapter": "org.htex.file", "profile": "" },
    });
    let header = serde_json::from_value(header).expect("a header");
    let folder = tempfile::tempdir().expect("a folder");
    let mut session = Session::open(&study, own, folder.path(), &header).expect("a new session");
    session.rate(3, 900, 1000, Presentation::default()).expect("the first trial");
    std::fs::read_to_string(session.file()).expect("it was written")
}
