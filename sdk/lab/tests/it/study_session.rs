//! Sessions: answers are preserved, damaged files are refused, and versions are not mixed.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use htex_base::finding::Findings;
use htex_lab::LabError;
use htex_lab::study::{
    DeviceUsed, GainKey, Header, OutputLevels, Phase, Plan, Playback, Presentation, Session,
    SimulatedParticipant, Step, Study, export, read_study,
};
use tempfile::TempDir;

const STUDY: &str = "
htex_study = '1.0'
participants = 2
repetitions = 2
models = ['ar', 'sbeta']
training = { trials = 1 }
rests = { every = 2, seconds = 5 }
motion = 'live'
device = { adapter = 'file' }
attributes = [{ name = 'similarity', question = '?' }, { name = 'roughness', question = '?' }]
[[textures]]
asset = 'cloth.htex'
";

struct Place {
    folder: TempDir,
    study: Study,
    plan: Plan,
}

impl Place {
    fn new() -> Self {
        let folder = TempDir::new().unwrap();
        fs::write(folder.path().join("study.toml"), STUDY).unwrap();
        fs::write(folder.path().join("cloth.htex"), "its bytes are hashed alone").unwrap();
        let study = read_study(STUDY.as_bytes(), &mut Findings::default()).unwrap();
        let plan = Plan::new(&study);
        Self { folder, study, plan }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn header(&self, simulated: Option<u64>) -> Header {
        self.header_with(simulated, [("amplifier_gain", "50"), ("limit_v", "150")])
    }

    fn header_with(&self, simulated: Option<u64>, settings: [(&str, &str); 2]) -> Header {
        let device = DeviceUsed {
            adapter: "file".to_owned(),
            settings: settings.map(|(name, value)| (name.to_owned(), value.to_owned())).into(),
            limit: Some(150.0),
            ..DeviceUsed::default()
        };
        let own = &self.plan.participants[0];
        let header =
            Header::new(&self.study, &self.path("study.toml"), own, device, "test".to_owned());
        let simulated = simulated.map(|seed| SimulatedParticipant::new(seed, "P01").header());
        Header { simulated, ..header.unwrap() }
    }

    fn open(&self) -> Result<Session<'_>, LabError> {
        let own = &self.plan.participants[0];
        Session::open(&self.study, own, self.folder.path(), &self.header(None))
    }

    fn answers(&self) -> PathBuf {
        self.path("P01.jsonl")
    }
}

/// Does one step.
fn act(session: &mut Session<'_>) -> bool {
    match session.step() {
        Step::Rate(_, trial, _) => {
            session.rate((trial.number % 7) as u8, 1, 2, Presentation::default()).unwrap()
        }
        Step::Match { matching, .. } => {
            let gain_db = matching.gain_db();
            let key = match (matching.is_rising(), gain_db) {
                (true, 0.0) => GainKey::Accept,
                (true, _) => GainKey::MuchStronger,
                (false, gain_db) if gain_db < -2.0 => GainKey::Accept,
                (false, _) => GainKey::Weaker,
            };
            let played = Playback {
                drive_v: None,
                output: OutputLevels::default(),
                reference_rms: 0.5,
                felt: None,
            };
            session.press(key, &played, 3).unwrap();
        }
        Step::Rest { .. } => session.rested(4).unwrap(),
        Step::Done => return false,
    }
    true
}

/// A session that is cut off at any byte of its file continues to the same file.
#[test]
fn a_session_goes_on_from_every_byte() {
    let place = Place::new();
    let mut session = place.open().unwrap();
    while act(&mut session) {}
    assert_eq!(session.trials(), (4, 4));
    drop(session);
    let whole = fs::read(place.answers()).unwrap();
    let header = whole.iter().position(|b| *b == b'\n').unwrap() + 1;
    let lines = whole.iter().filter(|b| **b == b'\n').count();
    // 2 training, 4 gain (each after 6 of a rise), 8 ratings, 1 rest.
    assert_eq!(lines, 1 + 6 + 2 + 6 + 4 + 8 + 1);
    for cut in (header..whole.len()).step_by(17).chain([header, whole.len() - 1]) {
        fs::write(place.answers(), &whole[..cut]).unwrap();
        let mut session = place.open().unwrap();
        while act(&mut session) {}
        drop(session);
        assert_eq!(fs::read(place.answers()).unwrap(), whole, "cut at {cut}");
    }
}

#[test]
fn gains_are_adopted_by_the_other_models() {
    let place = Place::new();
    let mut session = place.open().unwrap();
    let mut seen = 0;
    loop {
        if let Step::Rate(phase, trial, _) = session.step() {
            let stimulus = session.stimulus(phase, &trial);
            let gain_db = match phase {
                Phase::Training => 0.0,
                _ => -3.0,
            };
            assert_eq!(stimulus.gain_db, Some(gain_db), "{}", trial.model);
            assert_eq!(stimulus.reference_rms, Some(0.5));
            seen += 1;
        }
        if !act(&mut session) {
            break;
        }
    }
    assert_eq!(seen, 2 + 8);
}

fn refused(place: &Place, words: &[&str]) {
    let error = place.open().expect_err("it is refused").to_string();
    for word in words {
        assert!(error.contains(word), "{word}: {error}");
    }
}

#[test]
fn versions_are_not_mixed() {
    let place = Place::new();
    let mut session = place.open().unwrap();
    act(&mut session);
    refused(&place, &["P01.jsonl", "another htex is running"]);
    drop(session);
    let before = fs::read(place.answers()).unwrap();
    fs::write(place.path("study.toml"), format!("{STUDY}\n# changed")).unwrap();
    refused(&place, &["study has changed", "-o"]);
    fs::write(place.path("study.toml"), STUDY).unwrap();
    fs::write(place.path("cloth.htex"), "others").unwrap();
    refused(&place, &["file cloth.htex has changed"]);
    fs::write(place.path("cloth.htex"), "its bytes are hashed alone").unwrap();
    let own = &place.plan.participants[0];
    let simulated = place.header(Some(1));
    let error = Session::open(&place.study, own, place.folder.path(), &simulated).unwrap_err();
    assert!(error.to_string().contains("they come from a participant"), "{error}");
    let weaker = place.header_with(None, [("amplifier_gain", "20"), ("limit_v", "150")]);
    let error = Session::open(&place.study, own, place.folder.path(), &weaker).unwrap_err();
    assert!(
        error.to_string().contains(
            "the device's setting amplifier_gain was 50, and is 20. Restore what was there"
        ),
        "{error}"
    );
    assert_eq!(fs::read(place.answers()).unwrap(), before);
    place.open().unwrap();
}

#[test]
fn damaged_lines_are_named_and_kept() {
    let place = Place::new();
    let mut session = place.open().unwrap();
    while act(&mut session) {}
    drop(session);
    let text = fs::read_to_string(place.answers()).unwrap();
    let damaged = |from: &str, to: &str, words: &[&str]| {
        assert!(text.contains(from), "{from}");
        let changed = text.replacen(from, to, 1);
        fs::write(place.answers(), &changed).unwrap();
        refused(&place, words);
        assert_eq!(fs::read_to_string(place.answers()).unwrap(), changed);
    };
    damaged("\"number\":1,", "\"number\":9,", &["line 8", "trial 1 of the plan"]);
    damaged("\"rating\":1,", "\"rating\":9,", &["line 8", "not on the scale"]);
    damaged(
        "\"rating\":1,",
        "\"rating\":1,\"ratting\":2,",
        &["line 8", "unknown field `ratting`, expected one of", "`rating`"],
    );
    // A level that the keys do not give was written under other rules, and nobody knows what was
    // felt.
    damaged(
        "\"gain_db\":-16.0",
        "\"gain_db\":-1.0",
        &["line 2", "cloth is at -16 dB, and the line says -1 dB"],
    );
    damaged("\"kind\":\"rest\"", "\"kind\":\"nap\"", &["line 24"]);
    damaged("{\"kind\":\"header\"", "{\"kind\":\"leader\"", &["line 1"]);
    let header = text.lines().next().unwrap();
    damaged(
        "{\"kind\":\"rest\"",
        &format!("{header}\n{{\"kind\":\"rest\""),
        &["line 24", "second header"],
    );
    fs::write(place.answers(), "").unwrap();
    refused(&place, &["line 1"]);
}

/// A file that does not belong to this session is not changed, not even its incomplete last line. A
/// link to such a file is not followed.
#[test]
fn a_file_that_is_not_ours_is_not_changed() {
    let place = Place::new();
    let mut session = place.open().unwrap();
    act(&mut session);
    drop(session);
    let own = fs::read_to_string(place.answers()).unwrap();
    let cut = format!("{own}{{\"kind\":\"ris");
    let of_other = cut.replace("\"participant\":\"P01\"", "\"participant\":\"P02\"");
    assert_ne!(of_other, cut);
    let notes = "field notes\nof the year, without a last line's end";
    let damaged = cut.replacen("\"kind\":\"rise\"", "\"kind\":\"nap\"", 1);
    for text in [notes, "one line without an end", &of_other, &damaged] {
        fs::write(place.answers(), text).unwrap();
        assert!(place.open().is_err());
        assert_eq!(fs::read_to_string(place.answers()).unwrap(), text);
    }
    #[cfg(unix)]
    for (target, text) in [("notes", notes), ("answers", &*cut), ("new", "")] {
        let target = place.path(target);
        if !text.is_empty() {
            fs::write(&target, text).unwrap();
        }
        fs::remove_file(place.answers()).unwrap();
        std::os::unix::fs::symlink(&target, place.answers()).unwrap();
        refused(&place, &["P01.jsonl", "is a symbolic link"]);
        assert_eq!(fs::read_to_string(&target).unwrap_or_default(), text);
    }
    // In the session's own file, the incomplete line is removed only when a new line is written.
    fs::remove_file(place.answers()).unwrap();
    fs::write(place.answers(), &cut).unwrap();
    let mut session = place.open().unwrap();
    assert_eq!(fs::read_to_string(place.answers()).unwrap(), cut);
    act(&mut session);
    let text = fs::read_to_string(place.answers()).unwrap();
    assert!(text.starts_with(&own) && text.lines().count() == own.lines().count() + 1);
}

fn rows(folder: &Path, attribute: Option<&str>) -> Result<String, LabError> {
    Ok(export(folder, attribute)?.csv)
}

#[test]
fn ratings_are_exported_by_attribute() {
    let place = Place::new();
    let folder = place.folder.path();
    let error = rows(folder, None).unwrap_err().to_string();
    assert!(error.contains("no answers"), "{error}");
    let mut session = place.open().unwrap();
    while session.trials().0 < 3 {
        act(&mut session);
    }
    drop(session);
    // An incomplete line that is still being written is left out.
    let mut file = fs::OpenOptions::new().append(true).open(place.answers()).unwrap();
    file.write_all(b"{\"kind\":\"answ").unwrap();
    let error = rows(folder, None).unwrap_err().to_string();
    assert!(error.contains("roughness, similarity"), "{error}");
    let table = export(folder, Some("roughness")).unwrap();
    assert_eq!((table.participants, table.ratings), (1, 3));
    assert_eq!(table.warnings, ["P01 is not complete: 6 of 8 ratings"]);
    let mut lines = table.csv.lines();
    let head = "participant,texture,model,repetition,rating,attribute,hidden_reference,response_ms,gain_db,simulated,off_target";
    assert_eq!(lines.next(), Some(head));
    assert!(lines.next().unwrap().ends_with(",1,roughness,no,1,-3,no,"), "{}", table.csv);
    fs::write(place.path("P02.jsonl"), "{}\n").unwrap();
    assert!(rows(folder, None).unwrap_err().to_string().contains("P02.jsonl, line 1"));
}

/// Text that a spreadsheet would treat as a formula, which may open an address or run a program,
/// stays text in the table.
#[test]
fn cells_that_begin_like_formulas_are_text() {
    let place = Place::new();
    let mut session = place.open().unwrap();
    while session.trials().0 < 3 {
        act(&mut session);
    }
    drop(session);
    let whole = fs::read_to_string(place.answers()).unwrap();
    for start in ["=", "+", "-", "@", "\\t", "\\r"] {
        let evil = format!("{start}HYPERLINK(0)");
        let mut text =
            whole.replace("\"participant\":\"P01\"", &format!("\"participant\":\"{evil}\""));
        for key in ["texture", "model", "attribute"] {
            text = renamed(&text, key, &evil);
        }
        fs::write(place.answers(), text).unwrap();
        let table = export(place.folder.path(), None).unwrap();
        // All ratings of both attributes, which now have the same name.
        assert_eq!(table.ratings, 6);
        let mut cells = csv::Reader::from_reader(table.csv.as_bytes());
        for row in cells.records() {
            let row = row.unwrap();
            for column in [0, 1, 2, 5] {
                let cell = &row[column];
                assert!(cell.starts_with('\'') && cell.ends_with("HYPERLINK(0)"), "{cell:?}");
            }
        }
    }
}

/// Returns JSON lines with another text at a key of the answers.
fn renamed(lines: &str, key: &str, to: &str) -> String {
    let start = format!("\"{key}\":\"");
    let changed = lines.lines().map(|line| match line.split_once(&start) {
        Some((before, rest)) if line.contains("\"kind\":\"answer\"") => {
            let (_, after) = rest.split_once('"').unwrap();
            format!("{before}{start}{to}\"{after}\n")
        }
        _ => format!("{line}\n"),
    });
    changed.collect()
}
