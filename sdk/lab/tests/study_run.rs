//! Running a session with a rig that fails and a finger that leaves its target.
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

use std::cell::RefCell;
use std::fs;
use std::time::Duration;

use htex_finding::Findings;
use htex_lab::study::{
    Asker, Clock, DeviceUsed, Ended, FeltFile, Header, Key, Plan, Played, Rig, Session, Stimulus,
    Study, StudyError, View, export, read_study, run,
};
use tempfile::TempDir;

const STUDY: &str = "
htex_study = '1.0'
participants = 1
repetitions = 2
models = ['ar']
phases = ['testing']
motion = { constant = { speed_mm_s = 80, force_n = 0.4 } }
device = { adapter = 'file' }
[[textures]]
asset = 'cloth.htex'
";
const REASON: &str = "speed: mean 95.0000 mm/s, allowed is 72.0000 to 88.0000 mm/s";

/// What a trial is to come to, one after another; a trial without an entry is played.
#[derive(Clone, Copy)]
enum Fate {
    RunsDry,
    OffTarget,
    OnTarget,
}

struct TestRig {
    fates: Vec<Fate>,
    told: RefCell<Vec<String>>,
}

#[derive(Debug, thiserror::Error)]
enum Failing {
    #[error("the buffer is empty")]
    Dry,
    #[error(transparent)]
    Study(#[from] StudyError),
}

impl Rig for TestRig {
    type Error = Failing;

    fn play(&mut self, _: &Stimulus, _: &mut dyn FnMut() -> bool) -> Result<Played, Failing> {
        let felt = |off_target: Vec<String>| FeltFile {
            file: "P01/felt/trial.npy".to_owned(),
            blake3: String::new(),
            off_target,
        };
        let felt = match self.fates.is_empty() {
            true => None,
            false => match self.fates.remove(0) {
                Fate::RunsDry => return Err(Failing::Dry),
                Fate::OffTarget => Some(felt(vec![REASON.to_owned()])),
                Fate::OnTarget => Some(felt(Vec::new())),
            },
        };
        Ok(Played {
            drive_v: None,
            reference_rms: 0.1,
            felt,
        })
    }

    fn ran_dry(error: &Failing) -> bool {
        matches!(error, Failing::Dry)
    }

    fn tell(&self, notice: &str) {
        self.told.borrow_mut().push(notice.to_owned());
    }

    fn band_error_db(&self, _: &str, _: &str) -> Option<f64> {
        None
    }

    fn is_interrupted(&self) -> bool {
        false
    }
}

/// Begins each trial and rates it by 4; keeps the notices.
#[derive(Default)]
struct Willing {
    key: Option<Key>,
    begun: usize,
    notices: Vec<String>,
}

impl Asker for Willing {
    fn show(&mut self, view: &View, _: usize, _: usize) {
        self.key = match view {
            View::Ready { notice, .. } => {
                self.begun += 1;
                self.notices.extend(notice.clone());
                Some(Key::Go)
            }
            View::Question { notice, .. } => {
                self.notices.extend(notice.clone());
                Some(Key::Digit(4))
            }
            _ => None,
        };
    }

    fn key(&mut self) -> Option<Key> {
        self.key.take()
    }
}

struct NoClock;

impl Clock for NoClock {
    fn now_ms(&self) -> u64 {
        1_000
    }
    fn pass(&mut self, _: Duration) {}
    fn played(&mut self, _: Duration) {}
    fn date(&self) -> Option<String> {
        Some("2026-11-25T10:25:25Z".to_owned())
    }
    fn go_on_at(&mut self, _: u64) {}
}

struct Place {
    folder: TempDir,
    study: Study,
    plan: Plan,
}

/// How a session went.
struct Went {
    ended: Result<Ended, Failing>,
    asker: Willing,
    told: Vec<String>,
}

impl Place {
    fn new() -> Self {
        let folder = TempDir::new().unwrap();
        fs::write(folder.path().join("study.toml"), STUDY).unwrap();
        fs::write(folder.path().join("cloth.htex"), "it is hashed alone").unwrap();
        let study = read_study(STUDY.as_bytes(), &mut Findings::default()).unwrap();
        let plan = Plan::new(&study);
        Self {
            folder,
            study,
            plan,
        }
    }

    fn run(&self, fates: &[Fate]) -> Went {
        let own = &self.plan.participants[0];
        let path = self.folder.path().join("study.toml");
        let device = DeviceUsed::default();
        let header = Header::new(&self.study, &path, own, device, "test".to_owned()).unwrap();
        let mut session = Session::open(&self.study, own, self.folder.path(), &header).unwrap();
        let mut rig = TestRig {
            fates: fates.to_vec(),
            told: RefCell::default(),
        };
        let mut asker = Willing::default();
        let ended = run(&mut session, &mut rig, &mut asker, &mut NoClock, None);
        Went {
            ended,
            asker,
            told: rig.told.into_inner(),
        }
    }

    fn lines(&self) -> Vec<serde_json::Value> {
        let text = fs::read_to_string(self.folder.path().join("P01.jsonl")).unwrap();
        let lines = text.lines();
        lines
            .map(|line| serde_json::from_str(line).unwrap())
            .collect()
    }
}

#[test]
fn a_trial_in_which_the_device_runs_dry_is_repeated_three_times_at_most() {
    use Fate::{OnTarget, RunsDry};
    let place = Place::new();
    let went = place.run(&[RunsDry, RunsDry, OnTarget, RunsDry, RunsDry, RunsDry]);
    let error = went.ended.unwrap_err().to_string();
    assert!(
        error.contains("ran dry in 3 attempts") && error.contains("the buffer is empty"),
        "{error}"
    );
    // The participant begins each attempt.
    assert_eq!((went.asker.begun, went.told.len()), (6, 4));
    assert_eq!(went.asker.notices, went.told);
    let notice = "the device ran dry, and trial-0001 is played again (the buffer is empty)";
    assert_eq!(went.told[0], notice);
    let lines = place.lines();
    let kinds: Vec<&str> = lines
        .iter()
        .map(|line| line["kind"].as_str().unwrap())
        .collect();
    assert_eq!(kinds, ["header", "session", "answer"]);
    assert_eq!(lines[1]["date"], "2026-11-25T10:25:25Z");
    assert_eq!(lines[2]["repeats"], 2);
    // The same command goes on.
    assert_eq!(place.run(&[OnTarget]).ended.unwrap(), Ended::Done);
    assert_eq!(place.lines().len(), 5);
}

#[test]
fn a_trial_off_its_target_is_said_at_once_kept_and_marked() {
    let place = Place::new();
    let went = place.run(&[Fate::OffTarget, Fate::OnTarget]);
    assert_eq!(went.ended.unwrap(), Ended::Done);
    let said = format!("trial-0001 was off its target: {REASON}");
    assert_eq!(went.told, std::slice::from_ref(&said));
    assert_eq!(went.asker.notices, [said]);
    assert_eq!(place.lines()[2]["felt"]["off_target"][0], REASON);
    let table = export(place.folder.path(), None).unwrap();
    let marks: Vec<&str> = table
        .csv
        .lines()
        .map(|row| row.rsplit(',').next().unwrap())
        .collect();
    assert_eq!(marks, ["off_target", "yes", "no"]);
    assert_eq!((table.ratings, table.off_target), (2, 1));
    assert!(
        table.warnings[0].starts_with("P01: 1 of 2 recorded trials"),
        "{:?}",
        table.warnings
    );
}
