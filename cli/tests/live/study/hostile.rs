//! A page of a study on the simulated card: hostile programs that connect to it, a browser that
//! dies, and the key that stops.

use std::fs;
use std::io::{ErrorKind, Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::process::{Child, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread::{JoinHandle, sleep, spawn};
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use crate::browser::Browser;
use crate::common::{Place, signal};
use crate::studies::{PAPER, answers, short};

/// Connections in a test, and with `HTEX_WHOLE`.
const SAMPLE: usize = 60;
const WHOLE: usize = 1_000;
/// Longest time until a press has its reply.
const MOST: Duration = Duration::from_millis(100);
const RECORD: &str = "Dev1_ao0.txt";
const RATE_HZ: f64 = 20_000.0;

/// A session on a page and on the card, in real time.
struct Session {
    place: Place,
    child: Child,
    url: String,
    by_number: String,
}

impl Session {
    fn start(trial_s: f64, motion: &str, more: &[&str]) -> Self {
        let place = short(&[
            ("'Ann', 'Bob'", "'Ann'"),
            ("repetitions = 1", "repetitions = 3"),
            ("trial_s = 0.05", &format!("trial_s = {trial_s:?}")),
            ("'gain', ", ""),
            ("gain = { method = 'adjustment' }\n", ""),
            ("{ constant = { speed_mm_s = 80, force_n = 0.4 } }", motion),
            ("adapter = 'file'", "adapter = 'daq', drive_v = 120"),
        ]);
        let driver = format!("driver={}", crate::simulated::built().display());
        let run = ["study", "run", "study.toml", "--participant", "Ann", "--page"];
        let card = ["--profile", PAPER, "--set", &driver];
        let mut command = place.command(&[&run, &card[..], more].concat());
        let mut child = command
            .env("NIDAQMX_SIM_RECORD", place.path(""))
            .env("NIDAQMX_SIM_CLOCK", "wall")
            .stderr(Stdio::piped())
            .stdout(Stdio::null())
            .spawn()
            .unwrap();
        let url = crate::browser::address(&mut child);
        let by_number = crate::browser::by_number(&url);
        Self { place, child, url, by_number }
    }

    fn tab<'a>(&'a self, name: &'a str) -> TabOf<'a> {
        let rest = self.by_number.strip_prefix("http://").unwrap();
        let (host, path) = rest.split_once('/').unwrap();
        TabOf { host, path, name }
    }

    fn card_v(&self) -> Vec<f64> {
        let text = fs::read_to_string(self.place.path(RECORD)).unwrap_or_default();
        let whole = text.rfind('\n').map_or("", |end| &text[..end]);
        whole.lines().map(|line| line.parse().unwrap()).collect()
    }

    fn is_felt(&self) -> bool {
        self.card_v().iter().any(|v| *v != 0.0)
    }

    /// Waits for the end of the program, which is not far.
    fn ends(&mut self) {
        let start = Instant::now();
        while self.child.try_wait().unwrap().is_none() {
            assert!(start.elapsed() < Duration::from_secs(20), "it never ends");
            sleep(Duration::from_millis(10));
        }
        assert_eq!(self.card_v().last(), Some(&0.0));
    }

    fn ratings(&self) -> Vec<u64> {
        let all = answers(&self.place.path("answers"));
        let lines = all.values().flat_map(|text| text.lines());
        let rating = |line: &str| serde_json::from_str::<Value>(line).unwrap()["rating"].as_u64();
        lines.filter_map(rating).collect()
    }
}

impl Drop for Session {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// A tab of the page, as a program.
struct TabOf<'a> {
    host: &'a str,
    path: &'a str,
    name: &'a str,
}

impl TabOf<'_> {
    /// Status and body of the reply to a request.
    fn post(&self, what: &str, more: Value, headers: &str) -> (u16, String) {
        let mut body = json!({ "tab": self.name });
        for (key, value) in more.as_object().unwrap() {
            body[key] = value.clone();
        }
        let (host, path, body) = (self.host, self.path, body.to_string());
        let length = body.len();
        let request = format!(
            "POST /{path}{what} HTTP/1.1\r\nHost: {host}\r\n{headers}Content-Length: {length}\r\nConnection: close\r\n\r\n{body}"
        );
        let mut stream = TcpStream::connect(host).unwrap();
        let patience = Some(Duration::from_secs(10));
        stream.set_read_timeout(patience).unwrap();
        stream.write_all(request.as_bytes()).unwrap();
        let mut reply = String::new();
        stream.read_to_string(&mut reply).unwrap();
        let (head, body) = reply.split_once("\r\n\r\n").unwrap();
        (head.split(' ').nth(1).unwrap().parse().unwrap(), body.to_owned())
    }

    fn state(&self) -> Value {
        let (code, body) = self.post("state", json!({}), "");
        assert_eq!(code, 200, "{body}");
        serde_json::from_str(&body).unwrap()
    }

    /// Presses a key in the view that is shown; returns the time until the reply.
    fn press(&self, step: &Value, key: &str) -> Duration {
        let start = Instant::now();
        let (code, body) = self.post("key", json!({ "step": step, "key": key }), "");
        assert_eq!(code, 200, "{body}");
        start.elapsed()
    }

    /// Waits for a view of a kind; returns its number.
    fn waits_for(&self, kind: &str) -> Value {
        let start = Instant::now();
        loop {
            let state = self.state();
            if state["view"]["kind"] == kind {
                return state["step"].clone();
            }
            assert!(start.elapsed() < Duration::from_secs(30), "{state}");
            sleep(Duration::from_millis(20));
        }
    }

    fn begins_a_trial(&self) {
        let step = self.waits_for("ready");
        // What is shown takes no key before.
        sleep(Duration::from_millis(700));
        self.press(&step, "go");
    }
}

/// Programs of this machine that connect to a port without its token, each again when it is
/// refused.
struct Crowd {
    ends: Arc<AtomicBool>,
    connected: Arc<AtomicUsize>,
    threads: Vec<JoinHandle<()>>,
}

impl Crowd {
    const THREADS: usize = 4;

    fn start(host: &str, count: usize) -> Self {
        let at: SocketAddr = host.parse().unwrap();
        let (ends, connected) = (Arc::new(AtomicBool::new(false)), Arc::new(AtomicUsize::new(0)));
        let threads = (0..Self::THREADS).map(|thread| {
            let (ends, connected) = (Arc::clone(&ends), Arc::clone(&connected));
            let kinds: Vec<usize> = (0..count).filter(|i| i % Self::THREADS == thread).collect();
            spawn(move || {
                let mut all: Vec<(usize, Option<TcpStream>, usize)> =
                    kinds.into_iter().map(|kind| (kind, None, 0)).collect();
                while !ends.load(Ordering::Relaxed) {
                    for (kind, stream, sent) in &mut all {
                        if stream.is_none() {
                            *stream = TcpStream::connect_timeout(&at, Duration::from_secs(1)).ok();
                            (*sent, _) = (0, connected.fetch_add(1, Ordering::Relaxed));
                            if let Some(stream) = stream {
                                stream.set_nonblocking(true).unwrap();
                            }
                        }
                        if stream.as_mut().is_some_and(|stream| !goes_on(*kind, stream, sent)) {
                            *stream = None;
                        }
                    }
                    sleep(Duration::from_millis(20));
                }
            })
        });
        let threads = threads.collect();
        Self { ends, connected, threads }
    }

    fn end(self) -> usize {
        self.ends.store(true, Ordering::Relaxed);
        for thread in self.threads {
            thread.join().unwrap();
        }
        self.connected.load(Ordering::Relaxed)
    }
}

/// Sends the next part of what a hostile program sends; false when the connection is closed.
fn goes_on(kind: usize, stream: &mut TcpStream, sent: &mut usize) -> bool {
    const WITHOUT_TOKEN: &str = "POST /key HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: ";
    let next = match kind % 6 {
        // It says nothing.
        0 => Vec::new(),
        // A head that never ends, a byte at a time.
        1 => b"GET / HTTP/1.1\r\nX: aaaa"[(*sent).min(22)..(*sent + 1).min(23)].to_vec(),
        // A body that never comes.
        2 if *sent == 0 => format!("{WITHOUT_TOKEN}4000\r\n\r\n").into_bytes(),
        // A body of 3 GB.
        3 if *sent == 0 => format!("{WITHOUT_TOKEN}3000000000\r\n\r\n").into_bytes(),
        3 => vec![b'x'; 65_536],
        // A body in chunks without end.
        4 if *sent == 0 => b"POST / HTTP/1.1\r\nTransfer-Encoding: chunked\r\n\r\n".to_vec(),
        4 => b"1\r\nx\r\n".to_vec(),
        // No HTTP at all, without a line end.
        5 => vec![0xff; 4_096],
        _ => Vec::new(),
    };
    if !next.is_empty() {
        match stream.write(&next) {
            Ok(written) => *sent += written,
            Err(error) if error.kind() == ErrorKind::WouldBlock => {}
            Err(_) => return false,
        }
    }
    match stream.read(&mut [0; 4_096]) {
        Ok(0) => false,
        Ok(_) => true,
        Err(error) => error.kind() == ErrorKind::WouldBlock,
    }
}

/// No answer is lost, each press has its reply in time, and the output is at zero in the end.
#[test]
fn hostile_programs_delay_nobody() {
    let count = if xtask::prove::whole() { WHOLE } else { SAMPLE };
    let constant = "{ constant = { speed_mm_s = 80, force_n = 0.4 } }";
    let mut session = Session::start(0.2, constant, &[]);
    let crowd = Crowd::start(session.tab("a").host, count);
    sleep(Duration::from_millis(500));
    let (mut slowest, mut given) = (Duration::ZERO, Vec::new());
    for trial in 0..5u64 {
        let tab = session.tab("a");
        tab.begins_a_trial();
        let step = tab.waits_for("question");
        sleep(Duration::from_millis(400));
        let rating = trial % 7;
        slowest = slowest.max(tab.press(&step, &rating.to_string()));
        given.push(rating);
    }
    // The last trial is stopped while it plays, with all of them connected.
    let tab = session.tab("a");
    tab.begins_a_trial();
    tab.waits_for("playing");
    let start = Instant::now();
    tab.post("stop", json!({}), "");
    slowest = slowest.max(start.elapsed());
    session.ends();
    let connected = crowd.end();
    println!(
        "{count} programs, {connected} connections: the slowest reply to a press took {slowest:?}"
    );
    assert_eq!(session.ratings(), given, "all answers are kept");
    assert!(slowest <= MOST, "{slowest:?}");
    // They are not locked.
    assert!(connected >= count);
    let again = session.place.run(&["study", "export", "answers", "-o", "ratings.csv"]);
    assert_eq!(again.code(), 0, "{}", again.error());
}

/// Ctrl-C ends a session, whatever is connected.
#[test]
fn ctrl_c_ends_a_session_with_a_request_whose_body_never_comes() {
    let constant = "{ constant = { speed_mm_s = 80, force_n = 0.4 } }";
    let mut session = Session::start(10.0, constant, &[]);
    let tab = session.tab("a");
    tab.begins_a_trial();
    while !session.is_felt() {
        sleep(Duration::from_millis(10));
    }
    let mut stuck = TcpStream::connect(tab.host).unwrap();
    let head = format!("POST /x HTTP/1.1\r\nHost: {}\r\nContent-Length: 4000\r\n\r\n", tab.host);
    stuck.write_all(head.as_bytes()).unwrap();
    signal(&session.child, "-INT");
    session.ends();
}

/// A page of another address that knows the token, a body that is too long, and a body that does
/// not come.
#[test]
fn a_request_is_refused_by_its_head() {
    let constant = "{ constant = { speed_mm_s = 80, force_n = 0.4 } }";
    let session = Session::start(0.2, constant, &[]);
    let tab = session.tab("a");
    for origin in ["http://evil.example", "null", "https://127.0.0.1"] {
        let (code, _) = tab.post("state", json!({}), &format!("Origin: {origin}\r\n"));
        assert_eq!(code, 403, "{origin}");
    }
    let own = format!("Origin: http://{}\r\n", tab.host);
    assert_eq!(tab.post("state", json!({}), &own).0, 200);
    let long = json!({ "key": "x".repeat(5_000) });
    assert_eq!(tab.post("key", long, "").0, 413);
    // The head alone is answered, and a body that does not come is not waited for.
    let start = Instant::now();
    let head = |path: &str| {
        let mut stream = TcpStream::connect(tab.host).unwrap();
        let head =
            format!("POST /{path} HTTP/1.1\r\nHost: {}\r\nContent-Length: 99\r\n\r\n", tab.host);
        stream.write_all(head.as_bytes()).unwrap();
        let mut reply = String::new();
        stream.read_to_string(&mut reply).unwrap();
        reply.split(' ').nth(1).unwrap().to_owned()
    };
    assert_eq!(head("state"), "404");
    assert!(start.elapsed() < Duration::from_secs(1));
    assert_eq!(head(&format!("{}state", tab.path)), "408");
    assert!(start.elapsed() < Duration::from_secs(5));
}

/// A finger that slides on the page, until the browser dies: after 300 ms of silence there is no
/// contact.
#[test]
fn a_browser_that_dies_lifts_the_finger() {
    let session = Session::start(6.0, "'live'", &["--motion", "page", "--set", "buffer_ms=200"]);
    let tab = session.tab("a");
    tab.begins_a_trial();
    let start = Instant::now();
    while start.elapsed() < Duration::from_millis(1_500) {
        let slides = json!({ "speed_mm_s": 80, "down": true });
        assert_eq!(tab.post("motion", slides, "").0, 200);
        sleep(Duration::from_millis(30));
    }
    assert!(session.is_felt());
    let before = session.card_v().len();
    sleep(Duration::from_millis(1_800));
    let card_v = session.card_v();
    let felt = card_v.iter().rposition(|v| *v != 0.0).unwrap() + 1;
    let lost_s = felt.saturating_sub(before) as f64 / RATE_HZ;
    let played_s = (card_v.len() - before) as f64 / RATE_HZ;
    println!("zero {lost_s:.3} s after the last word of the page");
    assert!(played_s > 1.0, "the trial goes on: {played_s} s");
    assert!(lost_s <= 0.7, "{lost_s} s");
}

/// Any tab with the address stops a trial while it plays, also one that is refused.
#[test]
fn any_tab_stops_a_trial() {
    let constant = "{ constant = { speed_mm_s = 80, force_n = 0.4 } }";
    let mut session = Session::start(20.0, constant, &[]);
    session.tab("a").begins_a_trial();
    while !session.is_felt() {
        sleep(Duration::from_millis(10));
    }
    let before = session.card_v().len();
    session.tab("b").post("stop", json!({}), "");
    session.ends();
    let card_v = session.card_v();
    let felt = card_v.iter().rposition(|v| *v != 0.0).unwrap() + 1;
    let zero_s = felt.saturating_sub(before) as f64 / RATE_HZ;
    println!("zero {zero_s:.3} s after the press");
    assert!(zero_s <= 0.5, "{zero_s} s");
}

/// Escape and the button, in a browser, while a trial plays.
#[test]
fn escape_and_the_button_stop_a_trial() {
    let installed = crate::browser::installed();
    if !xtask::needs::CHROMIUM.met(installed.is_some()) {
        return;
    }
    let constant = "{ constant = { speed_mm_s = 80, force_n = 0.4 } }";
    for by_key in [true, false] {
        let mut session = Session::start(30.0, constant, &[]);
        let mut browser = Browser::start(installed.unwrap(), &session.place.path("browser"));
        let tab = browser.open(&session.url);
        browser.shows(&tab, "Begin");
        browser.shows(&tab, "Stop (Esc)");
        sleep(Duration::from_millis(700));
        browser.press(&tab, " ", 0);
        browser.shows(&tab, "Feel it");
        browser.shows(&tab, "Stop (Esc)");
        if by_key {
            browser.press(&tab, "Escape", 0)
        } else {
            browser.click(&tab, "#stop")
        }
        session.ends();
        browser.shows(&tab, "The session was stopped");
    }
}
