//! The page of a study in a browser.
#![cfg(unix)]
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

#[path = "common/browser.rs"]
mod browser;
mod common;

use std::fs;
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

use browser::{Browser, fits, pictured, status};
use common::Place;
use serde_json::Value;

const VINYL: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/scenes/vinyl.htex");
const STUDY: &str = "
htex_study = '1.0'
name = 'Similarity <of> textures'
participants = ['Ann']
models = ['ar', 'sbeta']
repetitions = 1
trial_s = 0.1
masking_noise = { level_dbfs = -30 }
rests = { every = 1 }
motion = 'live'
device = { adapter = 'file' }
training = { trials = 1 }
[[attributes]]
name = 'similarity'
question = 'How similar is the rendered texture to the real one?'
[[attributes]]
name = 'roughness'
question = 'How rough is it?'
[[textures]]
name = 'vinyl'
asset = 'vinyl.htex'
";

/// A session that asks on a page, and the page's address.
fn session(place: &Place) -> (Child, String) {
    place.write("vinyl.htex", fs::read(VINYL).unwrap());
    place.write("study.toml", STUDY);
    let run = [
        "study",
        "run",
        "study.toml",
        "--participant",
        "Ann",
        "--page",
        "--motion",
        "page",
    ];
    let mut command = place.command(&run);
    let mut child = command
        .stderr(Stdio::piped())
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    let url = browser::address(&mut child);
    (child, url)
}

fn kept(place: &Place) -> Vec<Value> {
    let text = fs::read_to_string(place.path("answers/Ann.jsonl")).unwrap_or_default();
    let whole = &text[..text.rfind('\n').map_or(0, |end| end + 1)];
    whole
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect()
}

/// Ratings so far.
fn ratings(place: &Place) -> Vec<u64> {
    kept(place)
        .iter()
        .filter_map(|line| line["rating"].as_u64())
        .collect()
}

fn wait_for(place: &Place, expected: &[u64]) {
    let start = Instant::now();
    while ratings(place) != expected && start.elapsed() < Duration::from_secs(60) {
        std::thread::sleep(Duration::from_millis(10));
    }
    assert_eq!(ratings(place), expected);
}

#[test]
fn one_press_is_one_answer_in_one_tab() {
    let installed = browser::installed();
    if !xtask::needs::CHROMIUM.met(installed.is_some()) {
        return;
    }
    let place = Place::new();
    let (mut child, url) = session(&place);
    let mut browser = Browser::start(installed.unwrap(), &place.path("browser"));
    let tab = browser.open(&url);
    browser.shows(&tab, "A trial for practice");
    fits(&mut browser, &tab);
    pictured(&mut browser, &tab, "ready");
    browser.press(&tab, " ", 0);
    browser.shows(&tab, "How similar");
    fits(&mut browser, &tab);
    pictured(&mut browser, &tab, "question");
    std::thread::sleep(Duration::from_millis(400));
    // A press that is held, and a second one at once: the next question stays open.
    browser.press(&tab, "3", 4);
    browser.press(&tab, "3", 0);
    wait_for(&place, &[3]);
    browser.shows(&tab, "How rough");
    std::thread::sleep(Duration::from_millis(800));
    assert_eq!(ratings(&place), [3]);
    // A reload goes on with the same question.
    browser.reload(&tab);
    browser.shows(&tab, "How rough");
    assert_eq!(ratings(&place), [3]);
    // A key that is not on the scale is none.
    browser.press(&tab, "7", 0);
    // A second tab is refused, and its keys are no answers.
    let second = browser.open(&url);
    browser.shows(&second, "open in another tab");
    pictured(&mut browser, &second, "refused");
    browser.press(&second, "1", 0);
    std::thread::sleep(Duration::from_millis(500));
    assert_eq!(ratings(&place), [3]);
    browser.press(&tab, "6", 0);
    wait_for(&place, &[3, 6]);
    // The gain is matched on the pad from the maximum down.
    browser.shows(&tab, "You will match its strength");
    browser.press(&tab, " ", 0);
    browser.shows(&tab, "it matches");
    fits(&mut browser, &tab);
    pictured(&mut browser, &tab, "matching");
    browser.slide(&tab);
    for (key, lines) in [("-", 1), ("-", 2), ("Enter", 3)] {
        browser.press(&tab, key, 0);
        let start = Instant::now();
        let gains = || {
            kept(&place)
                .iter()
                .filter(|line| line["kind"] == "gain")
                .count()
        };
        while gains() < lines && start.elapsed() < Duration::from_secs(60) {
            std::thread::sleep(Duration::from_millis(10));
        }
        assert_eq!(gains(), lines);
        if lines == 1 {
            // The finger on the pad was felt.
            let file = place.path("answers/Ann/gain-vinyl.wav");
            let mut wav = hound::WavReader::open(file).unwrap();
            assert!(wav.samples::<f32>().any(|x| x.unwrap() != 0.0));
        }
        std::thread::sleep(Duration::from_millis(500));
    }
    let found = kept(&place)
        .into_iter()
        .rfind(|line| line["kind"] == "gain")
        .unwrap();
    assert_eq!(
        (&found["gain_db"], &found["found"]),
        (&(-2.0).into(), &true.into())
    );
    // When the first tab is closed, the second one goes on.
    browser.close(&tab);
    browser.shows(&second, "Begin");
    for trial in 0..2 {
        browser.press(&second, " ", 0);
        browser.shows(&second, "How similar");
        std::thread::sleep(Duration::from_millis(400));
        browser.press(&second, "5", 0);
        browser.shows(&second, "How rough");
        std::thread::sleep(Duration::from_millis(400));
        browser.press(&second, "0", 0);
        if trial == 0 {
            browser.shows(&second, "Rest");
            browser.press(&second, " ", 0);
            browser.shows(&second, "Begin");
        }
    }
    browser.shows(&second, "Thank you");
    assert!(child.wait().unwrap().success());
    assert_eq!(ratings(&place), [3, 6, 5, 0, 5, 0]);
}

#[test]
fn other_pages_and_programs_cannot_answer() {
    let place = Place::new();
    let (mut child, url) = session(&place);
    let rest = url.strip_prefix("http://127.0.0.1:").unwrap();
    let (port, path) = rest.trim().split_once('/').unwrap();
    let host = format!("127.0.0.1:{port}");
    let get = |path: &str, host: &str| {
        status(
            port,
            &format!("GET /{path} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n"),
        )
    };
    assert_eq!(get(path, &host), "200");
    assert_eq!(get("", &host), "404", "without the token");
    assert_eq!(
        get(&path.to_uppercase(), &host),
        "404",
        "with another token"
    );
    assert_eq!(get(path, "evil.example"), "403", "under another name");
    let post = |body: &str| {
        let length = body.len();
        status(
            port,
            &format!(
                "POST /{path}key HTTP/1.1\r\nHost: {host}\r\nContent-Length: {length}\r\nConnection: close\r\n\r\n{body}"
            ),
        )
    };
    for body in ["", "{", "[1]", "{\"tab\":3}", "{\"tab\":\"\"}"] {
        assert_eq!(post(body), "409", "{body}");
    }
    assert_eq!(post("{\"tab\":\"a\",\"step\":-1,\"key\":[]}"), "200");
    assert_eq!(post("{\"tab\":\"b\",\"step\":1,\"key\":\"go\"}"), "409");
    assert_eq!(post(&"x".repeat(100_000)), "409");
    child.kill().unwrap();
    child.wait().unwrap();
    assert_eq!(kept(&place).len(), 1, "there is a header and no answer");
}
