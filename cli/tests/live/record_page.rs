//! Guidance on a page in a browser: what it shows of a replayed recording, and that it cannot harm
//! a take.

use std::f64::consts::TAU;
use std::process::{Child, Stdio};
use std::time::Duration;

use crate::browser::{Browser, Tab, fits_tablets, pictured, status};
use crate::common::{Place, entries, until, words};
use serde_json::Value;

/// Rows of a second.
const RATE: usize = 2_000;

/// Recording on a page.
fn command(place: &Place, more: &[&str]) -> (Child, String) {
    let base = ["record", "--page", "--source", "file:source.csv", "--set"];
    let rest = ["rate_hz=2000", "--take", "vinyl", "-o", "takes", "--json"];
    let mut child = place
        .command(&[&base[..], &rest, more].concat())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let url = crate::browser::address(&mut child);
    (child, url)
}

/// Rows of eight seconds of a simulated finger at this force (N) and 80 mm/s.
fn sweeps(place: &Place, force_n: &str) -> Vec<String> {
    let run = place.run(&words(&format!(
        "simulate --surface vinyl --seconds 8 --rate 2000 --force {force_n} -o sim.csv"
    )));
    assert_eq!(run.code(), 0, "{}", run.error());
    let csv = std::fs::read_to_string(place.path("sim.csv")).unwrap();
    let row = |line: &str| line.split_once(',').unwrap().1.to_owned();
    csv.lines().skip(2).map(row).collect()
}

/// The source of a session: a second without a finger, three of a light one, a take that presses
/// too much, three seconds of a light finger, and a take that does not. The sensor has an offset of
/// 0.05 N.
fn session(place: &Place) {
    let with_offset = |row: &String| {
        let mut cells: Vec<f64> = row.split(',').map(|cell| cell.parse().unwrap()).collect();
        cells[2] += 0.05;
        cells.iter().map(f64::to_string).collect::<Vec<_>>().join(",")
    };
    let still = |seconds: usize, force_n: f64| vec![format!("0,0,{force_n},0,0"); seconds * RATE];
    let rows =
        [still(1, 0.0), still(3, 0.2), sweeps(place, "0.6"), still(3, 0.2), sweeps(place, "0.4")];
    let rows: Vec<String> = rows.concat().iter().map(with_offset).collect();
    place.write("source.csv", format!("fx_n,fy_n,fz_n,x_mm,y_mm\n{}\n", rows.join("\n")));
}

fn text(browser: &mut Browser, tab: &Tab, id: &str) -> String {
    let text = browser.value(tab, &format!("document.getElementById('{id}').textContent"));
    text.as_str().unwrap().to_owned()
}

/// The number at the beginning of a text.
fn number(browser: &mut Browser, tab: &Tab, id: &str) -> f64 {
    let text = text(browser, tab, id);
    text.split(' ').next().unwrap().parse().unwrap()
}

/// Waits until an expression is true in a tab.
fn becomes(browser: &mut Browser, tab: &Tab, expression: &str) {
    until(expression, || browser.value(tab, expression) == true);
}

const TARGETS: &str = "--seconds 8 --countdown 3 --target-speed 80 --target-force 0.4 --attempts 3";

#[test]
fn a_session_is_guided_from_its_start_to_the_take_that_is_kept() {
    let installed = crate::browser::installed();
    if !xtask::needs::CHROMIUM.met(installed.is_some()) {
        return;
    }
    let place = Place::new();
    session(&place);
    let (child, url) = command(&place, &words(&format!("{TARGETS} --tare")));
    let mut browser = Browser::start(installed.unwrap(), &place.path("browser"));
    let tab = browser.open(&url);
    browser.shows(&tab, "Lift the finger, then start");
    fits_tablets(&mut browser, &tab, "record-start");
    let second = browser.open(&url);
    browser.shows(&second, "open in another tab");
    pictured(&mut browser, &second, "record-refused");
    // Neither the second tab nor time starts the session.
    browser.press(&second, " ", 0);
    std::thread::sleep(Duration::from_millis(500));
    assert_eq!(text(&mut browser, &tab, "what"), "Lift the finger, then start");
    browser.close(&second);
    browser.press(&tab, " ", 0);
    browser.shows(&tab, "Leave the surface alone");
    fits_tablets(&mut browser, &tab, "record-tare");
    let is_judged = "state.now.phase === 'tare' && state.now.force !== 'unknown'";
    assert_eq!(browser.value(&tab, is_judged), false, "no finger");
    browser.shows(&tab, "Take 1 is about to begin");
    becomes(&mut browser, &tab, "Math.abs(state.now.force_n - 0.2) < 0.0005");
    assert_eq!(text(&mut browser, &tab, "judged"), "too light");
    assert!((number(&mut browser, &tab, "newtons") - 0.2).abs() < 0.001, "without the offset");
    fits_tablets(&mut browser, &tab, "record-countdown");
    browser.shows(&tab, "Take 1 is being recorded");
    becomes(&mut browser, &tab, "document.getElementById('judged').textContent === 'too strong'");
    becomes(&mut browser, &tab, "state.now.level_db.length === 197");
    fits_tablets(&mut browser, &tab, "record-above");
    assert_eq!(browser.value(&tab, "document.getElementById('finger').className"), "square above");
    // The target starts at the beginning and moves at 80 mm/s. The finger also moves.
    becomes(&mut browser, &tab, "state.now.motion_s > 1.2");
    let places = "['target', 'finger'].map((id) => Number(document.getElementById(id).dataset.mm)).concat(state.now.motion_s)";
    let mut finger_mm = Vec::new();
    for _ in 0..6 {
        let seen = crate::common::numbers(&browser.value(&tab, places));
        let expected_mm = (80.0 * (seen[2] + 1.0) % 160.0 - 80.0).abs();
        assert!((seen[0] - expected_mm).abs() < 12.0, "{seen:?}");
        finger_mm.push(seen[1]);
        std::thread::sleep(Duration::from_millis(100));
    }
    let [low, high] =
        [f64::min, f64::max].map(|end| finger_mm.iter().copied().reduce(end).unwrap());
    assert!(high - low > 5.0, "{finger_mm:?}");
    browser.shows(&tab, "Take 1 was rejected and is repeated");
    fits_tablets(&mut browser, &tab, "record-rejected");
    let beside = |file: &str| -> Value {
        serde_json::from_slice(&std::fs::read(place.path("takes").join(file)).unwrap()).unwrap()
    };
    let rejected = beside("rejected/vinyl-001.json");
    let reason = rejected["verdict"]["reasons"][0].as_str().unwrap();
    assert!(reason.starts_with("force: mean 0."), "{reason}");
    let takes = text(&mut browser, &tab, "takes");
    assert!(takes.contains(&format!("Take 1 rejected{reason}")), "{takes}");
    // The page also shows the findings about its signals.
    let findings = rejected["verdict"]["findings"].as_array().unwrap();
    assert!(!findings.is_empty(), "{rejected}");
    assert!(findings.iter().all(|finding| takes.contains(finding.as_str().unwrap())), "{takes}");
    let hint = text(&mut browser, &tab, "hint");
    assert!(
        hint.contains("The take needs: on target 50 % or more, complete sweeps 3 or more."),
        "{hint}"
    );
    assert_eq!(text(&mut browser, &tab, "attempt"), "attempt 2 of at most 3");
    // Turns at 0 s, 1 s, 2 s and so on of the first take.
    let beats = browser.value(&tab, "Number(document.getElementById('lamp').dataset.beats)");
    assert!((6.0..=14.0).contains(&beats.as_f64().unwrap()), "{beats}");
    browser.shows(&tab, "Take 2 is being recorded");
    becomes(&mut browser, &tab, "document.getElementById('judged').textContent === 'in range'");
    fits_tablets(&mut browser, &tab, "record-take");
    // A page that is closed ends nothing; one that is opened again goes on.
    browser.close(&tab);
    std::thread::sleep(Duration::from_millis(300));
    let tab = browser.open(&url);
    browser.shows(&tab, "Take 2 is");
    browser.shows(&tab, "Take 2 is kept");
    fits_tablets(&mut browser, &tab, "record-kept");
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success());
    let said: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(said["kept"]["number"], 2);
    assert_eq!(entries(&place.path("takes")), ["rejected", "vinyl-002.csv", "vinyl-002.json"]);
    // The page shows the same verdict and spectrum of the take as the files.
    let force = &beside("vinyl-002.json")["verdict"]["force_n"];
    let [mean, min, max] =
        ["mean", "min", "max"].map(|what| format!("{:.3}", force[what].as_f64().unwrap()));
    assert!(
        text(&mut browser, &tab, "takes").contains(&format!("force {mean} N ({min} to {max})"))
    );
    let read = place.json(&["process", "takes/vinyl-002.csv", "--json"]);
    let shown = crate::common::numbers(&browser.value(&tab, "state.kept_db"));
    let expected = crate::common::numbers(&read["magnitude"]);
    assert_eq!((shown.len(), expected.len()), (197, 197));
    for (shown_db, magnitude) in shown.iter().zip(expected) {
        assert!((shown_db - 20.0 * magnitude.log10()).abs() < 0.0051, "{shown_db} {magnitude}");
    }
    let points = browser
        .value(&tab, "document.getElementById('kept').getAttribute('d').split(/[ML]/).length - 1");
    assert_eq!(points, 197);
}

#[test]
fn a_sinusoid_appears_at_its_height_and_q_keeps_what_was_recorded() {
    let installed = crate::browser::installed();
    if !xtask::needs::CHROMIUM.met(installed.is_some()) {
        return;
    }
    let place = Place::new();
    let row = |i: usize| format!("{}\n", 0.3 + 0.02 * (TAU * 250.0 * i as f64 / RATE as f64).sin());
    let rows: String = (0..30 * RATE).map(row).collect();
    place.write("source.csv", format!("lateral_n\n{rows}"));
    let (child, url) = command(&place, &["--seconds", "20", "--countdown", "0"]);
    let mut browser = Browser::start(installed.unwrap(), &place.path("browser"));
    let tab = browser.open(&url);
    browser.shows(&tab, "Put the finger down, then start");
    browser.press(&tab, " ", 0);
    // 0.02 N are -33.98 dB relative to 1 N.
    browser.shows(&tab, "peak 250 Hz, −34.0 dB (1 N = 0 dB)");
    let height = "(() => { \
        const d = document.getElementById('level').getAttribute('d').split(/[ML]/).slice(1).map((p) => p.split(' ').map(Number)); \
        const peak = d.reduce((best, p) => (p[1] < best[1] ? p : best)); \
        const { clientWidth: w, clientHeight: h } = document.getElementById('plot'); \
        return [20 * 50 ** ((peak[0] - 44) / (w - 56)), state.top_db - 70 * (peak[1] - 10) / (h - 32)]; })()";
    let [hz, db] = crate::common::numbers(&browser.value(&tab, height)).try_into().unwrap();
    assert!((hz - 250.0).abs() < 2.0 && (db + 33.98).abs() < 0.5, "drawn at {hz} Hz, {db} dB");
    fits_tablets(&mut browser, &tab, "record-no-target");
    std::thread::sleep(Duration::from_millis(1_200));
    browser.press(&tab, "q", 0);
    browser.shows(&tab, "The session has ended");
    browser.shows(&tab, "incomplete/vinyl-001.csv");
    fits_tablets(&mut browser, &tab, "record-ended");
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    let kept = std::fs::read_to_string(place.path("takes/incomplete/vinyl-001.csv")).unwrap();
    assert!(kept.lines().count() > RATE);
}

#[test]
fn other_pages_and_programs_neither_start_nor_stop_a_session() {
    let place = Place::new();
    place.write("source.csv", format!("lateral_n\n{}", "0.1\n0.2\n".repeat(RATE)));
    let (mut child, url) = command(&place, &["--seconds", "1", "--countdown", "0"]);
    let url = crate::browser::by_number(&url);
    let rest = url.strip_prefix("http://127.0.0.1:").unwrap();
    let (port, path) = rest.split_once('/').unwrap();
    let host = format!("127.0.0.1:{port}");
    let post = |path: &str, host: &str, body: &str| {
        let length = body.len();
        status(
            port,
            &format!(
                "POST /{path} HTTP/1.1\r\nHost: {host}\r\nContent-Length: {length}\r\nConnection: close\r\n\r\n{body}"
            ),
        )
    };
    let own = "{\"tab\":\"a\"}";
    for request in ["start", "stop", "state"] {
        assert_eq!(post(request, &host, own), "404", "without the token");
        assert_eq!(post(&format!("{path}{request}"), "evil.example", own), "403");
    }
    assert_eq!(post(&format!("{path}key"), &host, own), "404", "a request of another page");
    assert_eq!(post(&format!("{path}state"), &host, own), "200");
    assert_eq!(post(&format!("{path}start"), &host, "{\"tab\":\"b\"}"), "409");
    std::thread::sleep(Duration::from_millis(300));
    assert!(child.try_wait().unwrap().is_none());
    assert_eq!(entries(&place.path("takes")), [""; 0], "nothing was recorded");
    assert_eq!(post(&format!("{path}start"), &host, own), "200");
    assert!(child.wait().unwrap().success());
    assert_eq!(entries(&place.path("takes")), ["vinyl-001.csv", "vinyl-001.json"]);
}
