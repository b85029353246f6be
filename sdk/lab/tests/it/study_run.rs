//! Tests of sessions with a rig that fails, and with a finger that leaves its target.

use std::cell::RefCell;
use std::fs;
use std::time::Duration;

use htex_base::finding::Findings;
use htex_lab::LabError;
use htex_lab::study::{
    Asker, Clock, DeviceUsed, FeltFile, GainKey, Header, Key, OutputLevels, Plan, Playback, Rig,
    Session, SessionEnd, Stimulus, Study, View, export, read_study, run,
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

/// How trials end, one after another. A trial without an entry is played normally.
#[derive(Clone, Copy)]
enum Fate {
    RunsDry,
    OffTarget,
    OnTarget,
    NotMeasured,
}

#[derive(Default)]
struct TestRig {
    fates: Vec<Fate>,
    told: RefCell<Vec<String>>,
    /// The name and the gain of everything that was played.
    played: Vec<(String, Option<f64>)>,
}

/// A display with at most 100 V, whose drive follows the gain.
fn levels(stimulus: &Stimulus) -> (Option<f64>, OutputLevels) {
    let drive_v = 100.0 * 10f64.powf(stimulus.gain_db.unwrap_or(0.0) / 20.0);
    let output = OutputLevels {
        unit: "V".to_owned(),
        peak: drive_v,
        rms: drive_v / 2.0,
        direct: 0.25,
        duration_s: 1.5,
    };
    (Some(drive_v), output)
}

#[derive(Debug, thiserror::Error)]
enum Failing {
    #[error("the buffer is empty")]
    Dry,
    #[error(transparent)]
    Study(#[from] LabError),
}

impl Rig for TestRig {
    type Error = Failing;

    fn play(
        &mut self,
        stimulus: &Stimulus,
        ends: &mut dyn FnMut() -> bool,
    ) -> Result<Playback, Failing> {
        let (file, gain_db) = (stimulus.file.clone(), stimulus.gain_db);
        self.played.push((file, gain_db));
        if stimulus.seconds.is_none() {
            while !ends() {}
        } else {
            ends();
        }
        let felt = |off_target: Vec<String>, compared: bool| FeltFile {
            file: "P01/felt/trial.npy".to_owned(),
            blake3: String::new(),
            off_target,
            compared,
        };
        let felt = if self.fates.is_empty() {
            None
        } else {
            match self.fates.remove(0) {
                Fate::RunsDry => return Err(Failing::Dry),
                Fate::OffTarget => Some(felt(vec![REASON.to_owned()], true)),
                Fate::OnTarget => Some(felt(Vec::new(), true)),
                Fate::NotMeasured => Some(felt(Vec::new(), false)),
            }
        };
        let (drive_v, output) = levels(stimulus);
        Ok(Playback { drive_v, output, reference_rms: 0.1, felt })
    }

    fn output_before_error(&mut self) -> Option<(Option<f64>, OutputLevels)> {
        Some((None, OutputLevels::default()))
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

/// A participant who begins each trial, rates it 4, and collects the notices.
#[derive(Default)]
struct Willing {
    key: Option<Key>,
    begun: usize,
    notices: Vec<String>,
    /// Leaves while the first trial plays.
    leaves: bool,
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
            // Felt at -12 dB, and 4 dB weaker feels like the real texture.
            View::Matching { rising: true, gain_db, .. } => Some(Key::Gain(if *gain_db < -12.0 {
                GainKey::MuchStronger
            } else {
                GainKey::Accept
            })),
            View::Matching { gain_db, .. } => Some(Key::Gain(if *gain_db > -16.0 {
                GainKey::MuchWeaker
            } else {
                GainKey::Accept
            })),
            View::Playing { .. } if std::mem::take(&mut self.leaves) => Some(Key::Quit),
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
    ended: Result<SessionEnd, Failing>,
    asker: Willing,
    told: Vec<String>,
    played: Vec<(String, Option<f64>)>,
}

impl Place {
    fn new() -> Self {
        Self::with(STUDY)
    }

    fn with(text: &str) -> Self {
        let folder = TempDir::new().unwrap();
        fs::write(folder.path().join("study.toml"), text).unwrap();
        fs::write(folder.path().join("cloth.htex"), "it is hashed alone").unwrap();
        let study = read_study(text.as_bytes(), &mut Findings::default()).unwrap();
        let plan = Plan::new(&study);
        Self { folder, study, plan }
    }

    fn run(&self, fates: &[Fate]) -> Went {
        self.run_with(fates, Willing::default())
    }

    fn run_with(&self, fates: &[Fate], mut asker: Willing) -> Went {
        let own = &self.plan.participants[0];
        let path = self.folder.path().join("study.toml");
        let device = DeviceUsed::default();
        let header = Header::new(&self.study, &path, own, device, "test".to_owned()).unwrap();
        let mut session = Session::open(&self.study, own, self.folder.path(), &header).unwrap();
        let mut rig = TestRig { fates: fates.to_vec(), ..TestRig::default() };
        let ended = run(&mut session, &mut rig, &mut asker, &mut NoClock, None);
        Went { ended, asker, told: rig.told.into_inner(), played: rig.played }
    }

    fn lines(&self) -> Vec<serde_json::Value> {
        let text = fs::read_to_string(self.folder.path().join("P01.jsonl")).unwrap();
        let lines = text.lines();
        lines.map(|line| serde_json::from_str(line).unwrap()).collect()
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
    let kinds: Vec<&str> = lines.iter().map(|line| line["kind"].as_str().unwrap()).collect();
    let dry = "stopped";
    assert_eq!(kinds, ["header", "session", dry, dry, "answer", dry, dry, dry]);
    assert_eq!(lines[1]["date"], "2026-11-25T10:25:25Z");
    assert_eq!(lines[2]["reason"], "ran_dry");
    assert_eq!((&lines[4]["repeats"], &lines[4]["stops"]), (&2.into(), &2.into()));
    // Running the same command again continues the session.
    assert_eq!(place.run(&[OnTarget]).ended.unwrap(), SessionEnd::Done);
    let lines = place.lines();
    assert_eq!((lines.len(), &lines[9]["stops"]), (10, &3.into()));
}

/// Training and gain matching start 20 dB below the maximum. Nothing is played stronger than the
/// participant asked for. Each line of each phase states what the device was given.
#[test]
fn every_phase_starts_weak_and_says_what_the_device_was_given() {
    let phases = "phases = ['training', 'gain', 'testing']\ntraining = { trials = 1 }";
    let place = Place::with(&STUDY.replace("phases = ['testing']", phases));
    let leaving = Willing { leaves: true, ..Willing::default() };
    let went = place.run_with(&[], leaving);
    assert_eq!(went.ended.unwrap(), SessionEnd::Left);
    let mut played = went.played;
    let went = place.run(&[]);
    assert_eq!(went.ended.unwrap(), SessionEnd::Done);
    played.extend(went.played);
    let rise = |name: &'static str| [-20.0, -16.0, -12.0].map(|gain_db| (name, gain_db));
    let mut expected = rise("rise-cloth").to_vec();
    // The first one was left.
    expected.extend([("training-0001", -12.0); 2]);
    expected.extend(rise("gain-cloth"));
    expected.extend([("gain-cloth", -12.0), ("gain-cloth", -16.0)]);
    expected.extend([("trial-0001", -16.0), ("trial-0002", -16.0)]);
    let played: Vec<_> =
        played.iter().map(|(file, gain_db)| (&file[..], gain_db.unwrap())).collect();
    assert_eq!(played, expected);
    let lines = place.lines();
    let plays: Vec<_> =
        lines.iter().filter(|line| line["kind"] != "header" && line["kind"] != "session").collect();
    assert_eq!(plays.len(), expected.len());
    let stop = plays.iter().position(|line| line["kind"] == "stopped").unwrap();
    assert_eq!((stop, &plays[stop]["reason"]), (3, &"left".into()));
    for (i, (line, (_, gain_db))) in plays.iter().zip(expected).enumerate() {
        let drive_v = 100.0 * 10f64.powf(gain_db / 20.0);
        let output = &line["output"];
        for (found, is) in [
            (&line["drive_v"], drive_v),
            (&output["peak"], drive_v),
            (&output["rms"], drive_v / 2.0),
            (&output["direct"], 0.25),
            (&output["duration_s"], 1.5),
        ] {
            let found = found.as_f64().unwrap_or(f64::NAN);
            assert!((found - is).abs() < 1e-9, "{found}, expected {is}: {line}");
        }
        assert_eq!(output["unit"], "V");
        if i != stop {
            assert_eq!(line["stops"], u32::from(i == stop + 1), "{line}");
        }
    }
}

#[test]
fn a_trial_off_its_target_is_said_at_once_kept_and_marked() {
    let place = Place::new();
    let went = place.run(&[Fate::OffTarget, Fate::OnTarget]);
    assert_eq!(went.ended.unwrap(), SessionEnd::Done);
    let said = format!("trial-0001 was off its target: {REASON}");
    assert_eq!(went.told, std::slice::from_ref(&said));
    assert_eq!(went.asker.notices, [said]);
    assert_eq!(place.lines()[2]["felt"]["off_target"][0], REASON);
    let table = export(place.folder.path(), None).unwrap();
    let marks: Vec<&str> = table.csv.lines().map(|row| row.rsplit(',').next().unwrap()).collect();
    assert_eq!(marks, ["off_target", "yes", "no"]);
    assert_eq!((table.ratings, table.off_target), (2, 1));

    // If neither speed nor force was measured, the table does not claim that the trial kept to the
    // target.
    let unknown = Place::new();
    unknown.run(&[Fate::NotMeasured, Fate::OnTarget]).ended.unwrap();
    let rows = export(unknown.folder.path(), None).unwrap().csv;
    let marks: Vec<&str> = rows.lines().map(|row| row.rsplit(',').next().unwrap()).collect();
    assert_eq!(marks, ["off_target", "", "no"]);
    assert!(
        table.warnings[0].starts_with("P01: 1 of 2 trials whose motion was measured"),
        "{:?}",
        table.warnings
    );
}
