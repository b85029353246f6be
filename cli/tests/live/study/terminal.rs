//! Sessions of a study at a keyboard: a pseudo-terminal in place of the real one.

use std::fs::{self, File};
use std::io::{BufRead, BufReader, Write};
use std::process::{Child, Stdio};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use crate::common::Place;
use crate::studies::{Edits, RATED, short};
use rustix::process::{Pid, Signal, kill_process};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{LocalModes, tcgetattr};

const STUDY: Edits<'_> = &[
    ("'Ann', 'Bob'", "'Ann'"),
    ("'ar', 'sbeta'", "'ar'"),
    ("repetitions = 1", "repetitions = 2"),
    ("trial_s = 0.05", "trial_s = 0.2"),
    ("gain = {", "start_db = -4\ngain = {"),
    ("[[textures]]", RATED),
];
/// Longer than a key counts as held.
const APART: Duration = Duration::from_millis(800);

struct Session {
    child: Child,
    keyboard: File,
    /// The terminal's other end, whose settings are looked at.
    terminal: File,
    said: Arc<Mutex<String>>,
}

impl Session {
    fn start(place: &Place) -> Self {
        let master = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY).unwrap();
        grantpt(&master).unwrap();
        unlockpt(&master).unwrap();
        let name = ptsname(&master, Vec::new()).unwrap();
        let terminal = File::options().read(true).write(true).open(name.to_str().unwrap()).unwrap();
        let mut child = place
            .command(&["study", "run", "study.toml", "--participant", "Ann"])
            .stdin(Stdio::from(terminal.try_clone().unwrap()))
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let said = Arc::new(Mutex::new(String::new()));
        let (errors, heard) = (child.stderr.take().unwrap(), Arc::clone(&said));
        std::thread::spawn(move || {
            for line in BufReader::new(errors).lines().map_while(Result::ok) {
                *heard.lock().unwrap() += &(line + "\n");
            }
        });
        Self { child, keyboard: File::from(master), terminal, said }
    }

    fn said(&self) -> String {
        self.said.lock().unwrap().clone()
    }

    /// Waits until it has said a text so many times.
    fn says(&self, text: &str, times: usize) {
        let start = Instant::now();
        while self.said().matches(text).count() < times {
            assert!(start.elapsed() < Duration::from_secs(60), "{text}: {}", self.said());
            std::thread::sleep(Duration::from_millis(10));
        }
    }

    fn press(&mut self, keys: &[u8]) {
        std::thread::sleep(APART);
        self.keyboard.write_all(keys).unwrap();
    }

    /// Whether lines are echoed and need Enter, as a shell leaves a terminal.
    fn is_restored(&self) -> bool {
        let modes = tcgetattr(&self.terminal).unwrap().local_modes;
        modes.contains(LocalModes::ICANON | LocalModes::ECHO | LocalModes::ISIG)
    }
}

/// Enter and the space bar, of which the second one comes when the next trial waits: the rest ends,
/// and no trial begins.
#[test]
fn a_double_press_at_a_rest_begins_no_trial() {
    let rests = [
        ("phases = ['gain', 'testing']", "phases = ['testing']\nrests = { every = 1 }"),
        ("start_db = -4\ngain = { method = 'adjustment' }\n", ""),
    ];
    let place = short(&[STUDY, &rests].concat());
    for apart_ms in [150, 450] {
        let mut session = Session::start(&place);
        session.says("Enter to begin", 1);
        session.press(b" ");
        session.says("How similar", 1);
        session.press(b"4");
        session.says("How rough", 1);
        session.press(b"2");
        session.says("Rest; Enter to go on", 1);
        session.press(b"\r");
        std::thread::sleep(Duration::from_millis(apart_ms));
        session.keyboard.write_all(b" ").unwrap();
        session.says("Enter to begin", 2);
        std::thread::sleep(APART);
        assert_eq!(
            session.said().matches("vinyl plays").count(),
            1,
            "{apart_ms} ms: {}",
            session.said()
        );
        // A deliberate press begins it.
        session.press(b" ");
        session.says("vinyl plays", 2);
        session.press(b"q");
        assert!(session.child.wait().unwrap().success());
        fs::remove_dir_all(place.path("answers")).unwrap();
    }
}

fn kept(place: &Place, key: &str) -> Vec<serde_json::Value> {
    let text = fs::read_to_string(place.path("answers/Ann.jsonl")).unwrap();
    let lines = text.lines().map(|line| serde_json::from_str::<serde_json::Value>(line).unwrap());
    lines.filter_map(|line| line.get(key).cloned()).collect()
}

#[test]
fn single_keys_answer_without_enter() {
    let place = short(STUDY);
    let mut session = Session::start(&place);
    session.says("Enter to begin", 1);
    let modes = tcgetattr(&session.terminal).unwrap().local_modes;
    assert!(!modes.intersects(LocalModes::ICANON | LocalModes::ECHO));
    assert!(modes.contains(LocalModes::ISIG), "Ctrl-C is a signal");
    session.press(b"\r");
    // 4 dB stronger by Page Up, where it is felt.
    session.says("make it stronger until you feel it", 1);
    for keys in [&b"\x1b[5~"[..], b"\r"] {
        session.press(keys);
    }
    // 1 dB weaker by a key that is held, 4 dB by Page Down, 1 dB stronger by the arrow.
    session.says("compared with the real one", 1);
    for keys in [&b"---"[..], b"\x1b[6~", b"\x1b[A", b"\r"] {
        session.press(keys);
    }
    session.says("Enter to begin", 2);
    let levels = [0.0, 0.0, -1.0, -5.0, -4.0, -4.0];
    assert_eq!(kept(&place, "gain_db"), levels);
    session.press(b" ");
    session.says("How similar", 1);
    // No rating of the scale; a rating twice at once, which is one answer.
    session.press(b"7");
    session.says("\"7\" is no answer", 1);
    session.press(b"44");
    session.says("How rough", 1);
    session.press(b"2");
    session.says("Enter to begin", 3);
    assert_eq!(kept(&place, "rating"), [4, 2]);
    session.press(b"q");
    assert!(session.child.wait().unwrap().success());
    assert!(session.is_restored());
    session.says("Ann is not done", 1);
    assert!(!session.said().contains("and Enter"), "{}", session.said());
}

#[test]
fn the_terminal_is_restored_after_a_signal() {
    for signal in [Signal::INT, Signal::TERM, Signal::HUP] {
        let place = short(STUDY);
        let mut session = Session::start(&place);
        session.says("Enter to begin", 1);
        assert!(!session.is_restored());
        session.press(b"\r");
        session.says("make it stronger until you feel it", 1);
        let id = Pid::from_raw(session.child.id() as i32).unwrap();
        kill_process(id, signal).unwrap();
        assert!(session.child.wait().unwrap().success(), "{}", session.said());
        assert!(session.is_restored(), "{signal:?}");
        assert_eq!(kept(&place, "reason"), ["interrupted"], "{signal:?}");
    }
}
