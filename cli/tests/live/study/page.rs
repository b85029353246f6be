//! The page of a study in a browser.

use std::fs;
use std::process::{Child, Stdio};
use std::time::Duration;

use crate::browser::{Browser, Tab, fits_tablets, status};
use crate::common::{Place, until};
use crate::studies::{self, Edits, RATED};
use serde_json::Value;

const STUDY: Edits<'_> = &[
    ("'Ann', 'Bob'", "'Ann'"),
    ("trial_s = 0.05", "trial_s = 0.1\nrests = { every = 1 }\ntraining = { trials = 1 }"),
    ("phases = ['gain', 'testing']", "masking_noise = { level_dbfs = -30 }"),
    ("gain = { method = 'adjustment' }", "name = 'Similarity <of> textures'"),
    ("{ constant = { speed_mm_s = 80, force_n = 0.4 } }", "'live'"),
    ("[[textures]]", RATED),
];

/// A session that asks on a page, and the page's address.
fn session(place: &Place) -> (Child, String) {
    asked(place, STUDY, &["--motion", "page"])
}

/// A session of a study.
fn asked(place: &Place, study: Edits<'_>, more: &[&str]) -> (Child, String) {
    studies::write(place, study);
    let run = ["study", "run", "study.toml", "--participant", "Ann", "--page"];
    let mut command = place.command(&[&run, more].concat());
    let mut child = command.stderr(Stdio::piped()).stdout(Stdio::null()).spawn().unwrap();
    let url = crate::browser::address(&mut child);
    (child, url)
}

/// Presses the space bar, later than what is shown takes no key.
fn go(browser: &mut Browser, tab: &Tab) {
    std::thread::sleep(Duration::from_millis(700));
    browser.press(tab, " ", 0);
}

fn kept(place: &Place) -> Vec<Value> {
    let text = fs::read_to_string(place.path("answers/Ann.jsonl")).unwrap_or_default();
    let whole = &text[..text.rfind('\n').map_or(0, |end| end + 1)];
    whole.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

/// Ratings so far.
fn ratings(place: &Place) -> Vec<u64> {
    kept(place).iter().filter_map(|line| line["rating"].as_u64()).collect()
}

fn wait_for(place: &Place, expected: &[u64]) {
    until(&format!("ratings {expected:?}"), || ratings(place) == expected);
}

#[test]
fn one_press_is_one_answer_in_one_tab() {
    let installed = crate::browser::installed();
    if !xtask::needs::CHROMIUM.met(installed.is_some()) {
        return;
    }
    let place = Place::new();
    let (mut child, url) = session(&place);
    let mut browser = Browser::start(installed.unwrap(), &place.path("browser"));
    let tab = browser.open(&url);
    browser.shows(&tab, "This is for practice");
    fits_tablets(&mut browser, &tab, "practice");
    // The texture starts weak, and rises until it is felt.
    go(&mut browser, &tab);
    felt_after(&mut browser, &tab, 1);
    browser.shows(&tab, "Begin");
    assert_eq!(levels(&place, "rise"), [-16.0, -16.0]);
    go(&mut browser, &tab);
    browser.shows(&tab, "How similar");
    fits_tablets(&mut browser, &tab, "question");
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
    // A key outside the scale is not an answer.
    browser.press(&tab, "7", 0);
    // A second tab is refused, and its keys do not answer.
    let second = browser.open(&url);
    browser.shows(&second, "open in another tab");
    fits_tablets(&mut browser, &second, "refused");
    browser.press(&second, "1", 0);
    std::thread::sleep(Duration::from_millis(500));
    assert_eq!(ratings(&place), [3]);
    browser.press(&tab, "6", 0);
    wait_for(&place, &[3, 6]);
    // The gain is matched on the pad, from where the texture is felt down.
    browser.shows(&tab, "You will match its strength");
    go(&mut browser, &tab);
    fits_tablets(&mut browser, &tab, "rising-pad");
    felt_after(&mut browser, &tab, 5);
    browser.shows(&tab, "it matches");
    fits_tablets(&mut browser, &tab, "descending-pad");
    browser.slide(&tab);
    for (key, lines) in [("-", 1), ("-", 2), ("Enter", 3)] {
        browser.press(&tab, key, 0);
        let gains = || kept(&place).iter().filter(|line| line["kind"] == "gain").count();
        until("the gain is kept", || gains() >= lines);
        assert_eq!(gains(), lines);
        if lines == 1 {
            // The finger on the pad was felt.
            let samples = place.samples("answers/Ann/gain-vinyl.wav");
            assert!(samples.iter().any(|x| *x != 0.0));
        }
        std::thread::sleep(Duration::from_millis(500));
    }
    let found = kept(&place).into_iter().rfind(|line| line["kind"] == "gain").unwrap();
    assert_eq!((&found["gain_db"], &found["found"]), (&(-2.0).into(), &true.into()));
    // When the first tab is closed, the second one goes on.
    browser.close(&tab);
    browser.shows(&second, "Begin");
    for trial in 0..2 {
        go(&mut browser, &second);
        browser.shows(&second, "How similar");
        std::thread::sleep(Duration::from_millis(400));
        browser.press(&second, "5", 0);
        browser.shows(&second, "How rough");
        std::thread::sleep(Duration::from_millis(400));
        browser.press(&second, "0", 0);
        if trial == 0 {
            browser.shows(&second, "Rest");
            fits_tablets(&mut browser, &second, "rest-over");
            // A double press ends the rest, and begins no trial.
            go(&mut browser, &second);
            std::thread::sleep(Duration::from_millis(200));
            browser.press(&second, " ", 0);
            browser.shows(&second, "Begin");
            std::thread::sleep(Duration::from_millis(500));
            browser.shows(&second, "Begin");
        }
    }
    browser.shows(&second, "Thank you");
    fits_tablets(&mut browser, &second, "done");
    assert!(child.wait().unwrap().success());
    assert_eq!(ratings(&place), [3, 6, 5, 0, 5, 0]);
}

/// A session of two trials that are matched.
fn matching(place: &Place, method: &str) -> (Child, String) {
    let gain = format!("start_db = 0\ngain = {{ method = '{method}', reversals = 3 }}");
    let study = [
        ("'Ann', 'Bob'", "'Ann'"),
        ("'ar', 'sbeta'", "'ar'"),
        ("repetitions = 1", "repetitions = 2\nmasking_noise = { level_dbfs = -30 }"),
        ("trial_s = 0.05", "trial_s = 2\nrests = { every = 1, seconds = 2 }"),
        ("gain = { method = 'adjustment' }", &gain),
        ("[[textures]]", "[[textures]]\nname = 'coarse_fabric'"),
    ];
    asked(place, &study, &[])
}

/// Presses Page Up so many times, and says that the texture is felt.
fn felt_after(browser: &mut Browser, tab: &Tab, steps: usize) {
    browser.shows(tab, "Make it stronger until you feel it");
    for key in std::iter::repeat_n("PageUp", steps).chain(["Enter"]) {
        // What is shown takes no key at once.
        std::thread::sleep(Duration::from_millis(900));
        browser.press(tab, key, 0);
    }
    std::thread::sleep(Duration::from_millis(500));
}

/// Gains after each key of the matching so far, decibels.
fn gains(place: &Place) -> Vec<f64> {
    levels(place, "gain")
}

/// Levels of lines of a kind so far, decibels.
fn levels(place: &Place, kind: &str) -> Vec<f64> {
    let lines = kept(place).into_iter();
    let gains = lines.filter(|line| line["kind"] == kind);
    gains.map(|line| line["gain_db"].as_f64().unwrap()).collect()
}

/// Waits until the last gain is this one and the page asks for the next key.
fn gain_is(place: &Place, expected: &[f64]) {
    until(&format!("gains {expected:?}"), || gains(place) == expected);
    // A second answer would be there by then, and the next key is not the second press of this one.
    std::thread::sleep(Duration::from_millis(600));
    assert_eq!(gains(place), expected);
}

/// A matching on the page: each key or button (in angle brackets) and the gain after it, decibels;
/// `None` where it has no meaning.
fn matched(method: &str, buttons: &[&str], keys: &[(&str, Option<f64>)]) {
    let installed = crate::browser::installed();
    if !xtask::needs::CHROMIUM.met(installed.is_some()) {
        return;
    }
    let place = Place::new();
    let (mut child, url) = matching(&place, method);
    let mut browser = Browser::start(installed.unwrap(), &place.path("browser"));
    let tab = browser.open(&url);
    browser.shows(&tab, "You will match its strength");
    fits_tablets(&mut browser, &tab, "ready");
    go(&mut browser, &tab);
    fits_tablets(&mut browser, &tab, "rising");
    felt_after(&mut browser, &tab, 0);
    browser.shows(&tab, "Compare it");
    fits_tablets(&mut browser, &tab, method);
    let shown = "[...document.querySelectorAll('main button')].map((b) => b.dataset.key)";
    assert_eq!(browser.value(&tab, shown), serde_json::json!(buttons));
    std::thread::sleep(Duration::from_millis(400));
    let mut expected = Vec::new();
    for (index, (key, gain_db)) in keys.iter().enumerate() {
        match key.strip_prefix('<') {
            Some(button) => {
                browser.click(&tab, &format!("[data-key={}]", button.trim_end_matches('>')))
            }
            None => {
                // Held, and pressed a second time at once: one step.
                browser.press(&tab, key, 3);
                browser.press(&tab, key, 0);
            }
        }
        expected.extend(*gain_db);
        gain_is(&place, &expected);
        if index == 1 {
            browser.reload(&tab);
            browser.shows(&tab, "Compare it");
            std::thread::sleep(Duration::from_millis(400));
            assert_eq!(gains(&place), expected, "a reload goes on");
        }
    }
    browser.shows(&tab, "Begin");
    let found = kept(&place).into_iter().rfind(|line| line["kind"] == "gain");
    assert_eq!(found.unwrap()["found"], true);
    go(&mut browser, &tab);
    browser.shows(&tab, "Feel it");
    fits_tablets(&mut browser, &tab, "playing");
    browser.shows(&tab, "How similar");
    std::thread::sleep(Duration::from_millis(400));
    browser.press(&tab, "4", 0);
    browser.shows(&tab, "It goes on in");
    fits_tablets(&mut browser, &tab, "rest");
    child.kill().unwrap();
    child.wait().unwrap();
}

#[test]
fn a_gain_is_adjusted_up_and_down() {
    let buttons = ["much_weaker", "weaker", "stronger", "much_stronger", "accept"];
    let keys = [
        ("PageDown", Some(-4.0)),
        ("<much_weaker>", Some(-8.0)),
        ("-", Some(-9.0)),
        ("ArrowDown", Some(-10.0)),
        ("5", None),
        ("+", Some(-9.0)),
        ("ArrowUp", Some(-8.0)),
        ("<stronger>", Some(-7.0)),
        ("PageUp", Some(-3.0)),
        ("<much_stronger>", Some(0.0)),
        ("<weaker>", Some(-1.0)),
        ("Enter", Some(-1.0)),
    ];
    matched("adjustment", &buttons, &keys);
}

#[test]
fn a_staircase_asks_for_a_direction_alone() {
    // Steps of 4 dB until the first reversal, then of 1 dB; the gain is the mean of the reversals
    // after the second.
    let keys = [
        ("-", Some(-4.0)),
        ("<weaker>", Some(-8.0)),
        ("Enter", None),
        ("PageDown", None),
        ("ArrowUp", Some(-7.0)),
        ("<weaker>", Some(-8.0)),
        ("<stronger>", Some(-8.0)),
    ];
    matched("staircase", &["weaker", "stronger"], &keys);
}

/// White noise of the stated level in both ears while a texture is felt, and silence else.
#[test]
fn masking_noise_has_its_level_and_its_times() {
    let installed = crate::browser::installed();
    if !xtask::needs::CHROMIUM.met(installed.is_some()) {
        return;
    }
    let place = Place::new();
    let (mut child, url) = matching(&place, "descending");
    let mut browser = Browser::start(installed.unwrap(), &place.path("browser"));
    let tab = browser.open(&url);
    browser.shows(&tab, "You will match its strength");
    assert_eq!(browser.value(&tab, "audio"), Value::Null, "nothing sounds before");
    // A listener at everything that goes to the headphones.
    let listen = "window.heard = []; const connect = AudioNode.prototype.connect; AudioNode.prototype.connect = function (to, ...rest) { \
        if (to instanceof AudioDestinationNode) { const split = this.context.createChannelSplitter(2); connect.call(this, split); \
        heard = [0, 1].map((ear) => { const made = new AnalyserNode(this.context, { fftSize: 32768 }); connect.call(split, made, ear); return made; }); } \
        return connect.call(this, to, ...rest); }; true";
    assert_eq!(browser.value(&tab, listen), true);
    go(&mut browser, &tab);
    felt_after(&mut browser, &tab, 0);
    browser.shows(&tab, "Compare it");
    // Level, decibels relative to full scale, and bands of an octave above the first, decibels
    // relative to the mean power of a bin. Means of four pieces of 0.7 s.
    let measure = "(async () => { for (let i = 0; i < 100 && audio.state !== 'running'; i++) await new Promise((r) => setTimeout(r, 50)); \
        const size = 32768; const squares = heard.map(() => 0); const powers = heard.map(() => new Float64Array(size / 2)); \
        for (let piece = 0; piece < 4; piece++) { await new Promise((r) => setTimeout(r, 1000)); \
            heard.forEach((ear, i) => { const time = new Float32Array(size); ear.getFloatTimeDomainData(time); \
            squares[i] += time.reduce((sum, x) => sum + x * x, 0) / size / 4; \
            ear.smoothingTimeConstant = 0; const bins = new Float32Array(size / 2); ear.getFloatFrequencyData(bins); \
            bins.forEach((db, k) => (powers[i][k] += 10 ** (db / 10))); }); } \
        const hz = audio.sampleRate / size; return powers.map((power, i) => { \
        const mean = (from, to) => { const part = power.slice(Math.round(from / hz), Math.round(to / hz)); return part.reduce((a, b) => a + b, 0) / part.length; }; \
        const all = mean(200, 20000); \
        return [10 * Math.log10(squares[i]), ...[200, 400, 800, 1600, 3200, 6400, 12800].map((f) => 10 * Math.log10(mean(f, Math.min(2 * f, 20000)) / all))]; }); })()";
    let heard = browser.promised(&tab, measure);
    let heard: Vec<Vec<f64>> = serde_json::from_value(heard).unwrap();
    assert_eq!(heard.len(), 2);
    for ear in &heard {
        assert!((ear[0] + 30.0).abs() < 0.5, "{ear:?}");
        // An octave from 200 Hz has 137 bins, about 80 of which are independent under the analyser's
        // window: a standard deviation of 0.25 dB for four pieces, and 0.12 dB from 800 Hz.
        assert!(ear[1..].iter().all(|db| db.abs() < 1.6), "{ear:?}");
        assert!(ear[3..].iter().all(|db| db.abs() < 0.8), "{ear:?}");
    }
    assert!(heard[0] != heard[1], "the ears have noise of their own");
    std::thread::sleep(Duration::from_millis(400));
    browser.press(&tab, "Enter", 0);
    browser.shows(&tab, "Begin");
    let stopped = "(async () => { for (let i = 0; i < 100 && audio.state !== 'suspended'; i++) await new Promise((r) => setTimeout(r, 50)); return audio.state; })()";
    assert_eq!(browser.promised(&tab, stopped), "suspended", "between trials");
    go(&mut browser, &tab);
    browser.shows(&tab, "Feel it");
    let running = stopped.replace("suspended", "running");
    assert_eq!(browser.promised(&tab, &running), "running", "in a trial");
    browser.shows(&tab, "How similar");
    assert_eq!(browser.promised(&tab, stopped), "suspended", "at a question");
    std::thread::sleep(Duration::from_millis(400));
    browser.press(&tab, "4", 0);
    browser.shows(&tab, "Go on");
    go(&mut browser, &tab);
    browser.shows(&tab, "Begin");
    go(&mut browser, &tab);
    browser.shows(&tab, "Feel it");
    assert_eq!(browser.promised(&tab, &running), "running");
    child.kill().unwrap();
    child.wait().unwrap();
    browser.shows(&tab, "not running");
    assert_eq!(browser.promised(&tab, stopped), "suspended", "after the end of htex");
}

#[test]
fn other_pages_and_programs_cannot_answer() {
    let place = Place::new();
    let (mut child, url) = session(&place);
    let number = crate::browser::by_number(&url);
    let rest = number.strip_prefix("http://127.0.0.1:").unwrap();
    let (port, path) = rest.trim().split_once('/').unwrap();
    let host = format!("127.0.0.1:{port}");
    let get = |path: &str, host: &str| {
        status(port, &format!("GET /{path} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n"))
    };
    assert_eq!(get(path, &host), "200");
    assert_eq!(get("", &host), "404", "without the token");
    assert_eq!(get(&path.to_uppercase(), &host), "404", "with another token");
    assert_eq!(get(path, "evil.example"), "403", "under another name");
    let name = url.split('/').nth(2).unwrap();
    assert_eq!(get(path, name), "200", "by the name that is printed");
    let other = format!("{}.localhost:{port}", "0".repeat(32));
    for name in [other, format!("localhost:{port}")] {
        assert_eq!(get(path, &name), "403", "{name}");
    }
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
    assert_eq!(post(&"x".repeat(100_000)), "413");
    child.kill().unwrap();
    child.wait().unwrap();
    assert_eq!(kept(&place).len(), 2, "there are a header, a session and no answer");
}

/// At a port that another program may have had, only the name is served at which nothing was
/// before: a script that the program left at the number (a service worker) sees no request.
#[test]
fn at_a_port_that_was_chosen_only_a_new_name_is_served() {
    let place = Place::new();
    let listener = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let port = listener.local_addr().unwrap().port().to_string();
    drop(listener);
    let mut names = std::collections::BTreeSet::new();
    for _ in 0..2 {
        let (mut child, url) = asked(&place, STUDY, &["--motion", "page", "--port", &port]);
        let (host, path) = url.strip_prefix("http://").unwrap().split_once('/').unwrap();
        let get = |host: &str| {
            status(
                &port,
                &format!("GET /{path} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n"),
            )
        };
        assert_eq!(get(host), "200");
        assert_eq!(get(&format!("127.0.0.1:{port}")), "403");
        names.insert(host.to_owned());
        child.kill().unwrap();
        child.wait().unwrap();
    }
    assert_eq!(names.len(), 2, "each session has another name");
}
