//! The page of a session: a server on this machine alone, for one browser tab.
//!
//! The address holds a random token, and requests with another host name are refused, so that other pages in the browser and other users
//! of the machine cannot answer. One tab owns the session, until it is closed or silent for [`SILENT`]; others are refused. Each view has
//! a number, and an answer names the number that it is for: a second press of a key, or one for a view that is gone, is not an answer.

use std::collections::VecDeque;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use serde::Serialize;
use serde_json::{Value, json};
use tiny_http::{Header, Method, Request, Response, Server};

use crate::study::asking::{Asker, Key, View};
use crate::study::error::StudyError;
use crate::study::file::GainMethod;
use crate::study::gain::GainKey;

/// The page itself.
const HTML: &str = include_str!("page.html");
/// A tab that has asked for nothing for this long is gone.
const SILENT: Duration = Duration::from_secs(8);
/// A question or a matching takes no answer for this long: the second press of a key that answered the one before.
const GUARD: Duration = Duration::from_millis(300);
/// Longest wait, at the end, for the page to show that all is done.
const FAREWELL: Duration = Duration::from_secs(2);
/// Longest body of a request, bytes.
const MOST_BYTES: u64 = 4096;

/// What a page is for.
#[derive(Debug, Clone, Default)]
pub struct PageOptions {
    /// Port; 0 is any that is free.
    pub port: u16,
    /// Title.
    pub title: String,
    /// RMS level of the masking noise, decibels relative to full scale.
    pub noise_dbfs: Option<f64>,
    /// Whether the page takes the finger's motion: millimetres of a pixel of the page.
    pub touch_mm_per_px: Option<f64>,
}

/// A motion of the finger on the page.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Touched {
    /// Speed, mm/s; negative to the left.
    pub speed_mm_s: f64,
    /// Whether the finger is on the page.
    pub is_down: bool,
}

/// A page that is served while this value lives.
pub struct Page {
    state: Arc<Mutex<State>>,
    server: Arc<Server>,
    thread: Option<JoinHandle<()>>,
    url: String,
    touched: Option<Receiver<Touched>>,
}

struct State {
    /// Path that every request begins with: `/token/`.
    root: String,
    /// Host names of this server.
    hosts: [String; 2],
    options: PageOptions,
    /// Number of the view.
    step: u64,
    view: View,
    shown: Instant,
    done: usize,
    all: usize,
    keys: VecDeque<Key>,
    /// The view that has an answer.
    answered: Option<u64>,
    /// The tab that owns the session, and its last request.
    owner: Option<(String, Instant)>,
    /// The view that the owner has.
    seen: u64,
    touched: Sender<Touched>,
}

impl Page {
    /// Serves the page on this machine.
    ///
    /// # Errors
    /// [`StudyError::Page`] if the port is taken or there are no random numbers.
    pub fn open(options: PageOptions) -> Result<Self, StudyError> {
        let port = options.port;
        let failed = |problem: String| StudyError::Page { port, problem };
        let server = Server::http(("127.0.0.1", port)).map_err(|e| failed(e.to_string()))?;
        let server = Arc::new(server);
        let mut token = [0u8; 16];
        getrandom::fill(&mut token).map_err(|e| failed(e.to_string()))?;
        let token: String = token.iter().map(|byte| format!("{byte:02x}")).collect();
        let port = server.server_addr().to_ip().map_or(port, |at| at.port());
        let (sender, touched) = channel();
        let root = format!("/{token}/");
        let url = format!("http://127.0.0.1:{port}{root}");
        let state = Arc::new(Mutex::new(State {
            root,
            hosts: [format!("127.0.0.1:{port}"), format!("localhost:{port}")],
            options,
            step: 0,
            view: View::Done,
            shown: Instant::now(),
            done: 0,
            all: 0,
            keys: VecDeque::new(),
            answered: None,
            owner: None,
            seen: 0,
            touched: sender,
        }));
        let served = (Arc::clone(&server), Arc::clone(&state));
        let thread = std::thread::spawn(move || serve(&served.0, &served.1));
        Ok(Self {
            state,
            server,
            thread: Some(thread),
            url,
            touched: Some(touched),
        })
    }

    /// The address of the page.
    pub fn url(&self) -> &str {
        &self.url
    }

    /// The motions of the finger on the page; the first call takes them.
    pub fn touched(&mut self) -> Option<Receiver<Touched>> {
        self.touched.take()
    }
}

impl Asker for Page {
    fn show(&mut self, view: &View, done: usize, all: usize) {
        let mut state = lock(&self.state);
        state.step += 1;
        state.view = view.clone();
        state.shown = Instant::now();
        (state.done, state.all) = (done, all);
        state.keys.clear();
    }

    fn key(&mut self) -> Option<Key> {
        lock(&self.state).keys.pop_front()
    }
}

impl Drop for Page {
    fn drop(&mut self) {
        let start = Instant::now();
        let is_behind = |state: &State| state.owner.is_some() && state.seen < state.step;
        while start.elapsed() < FAREWELL && is_behind(&lock(&self.state)) {
            std::thread::sleep(Duration::from_millis(20));
        }
        self.server.unblock();
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

fn lock(state: &Mutex<State>) -> MutexGuard<'_, State> {
    state.lock().unwrap_or_else(PoisonError::into_inner)
}

fn serve(server: &Server, state: &Mutex<State>) {
    // An error of `recv` is the end of the server, too.
    while let Ok(mut request) = server.recv() {
        let (code, kind, body) = reply(&mut request, state);
        let mut response = Response::from_string(body).with_status_code(code);
        let headers: [(&str, &str); 5] = [
            ("Content-Type", kind),
            ("Cache-Control", "no-store"),
            ("Referrer-Policy", "no-referrer"),
            ("X-Frame-Options", "DENY"),
            (
                "Content-Security-Policy",
                "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; connect-src 'self'; img-src data:",
            ),
        ];
        for (name, value) in headers {
            if let Ok(header) = Header::from_bytes(name, value) {
                response.add_header(header);
            }
        }
        // A tab that is gone needs no reply.
        let _ = request.respond(response);
    }
}

/// Status, content type and body of a reply.
fn reply(request: &mut Request, state: &Mutex<State>) -> (u16, &'static str, String) {
    let text = |code: u16, body: &str| (code, "text/plain; charset=utf-8", body.to_owned());
    let mut headers = request.headers().iter();
    let host = headers.find(|header| header.field.equiv("Host"));
    let host = host.map(|header| header.value.as_str().to_owned());
    let mut body = Vec::new();
    let read = std::io::Read::read_to_end(
        &mut std::io::Read::take(request.as_reader(), MOST_BYTES),
        &mut body,
    );
    let body: Value = match read {
        Ok(_) => serde_json::from_slice(&body).unwrap_or_default(),
        Err(_) => return text(400, "the request is incomplete"),
    };
    let mut state = lock(state);
    if !host.is_some_and(|host| state.hosts.contains(&host)) {
        return text(403, "this page is for this machine alone");
    }
    let Some(path) = request.url().strip_prefix(&state.root) else {
        return text(
            404,
            "the address is not complete; open the one that htex printed",
        );
    };
    match (request.method(), path) {
        (Method::Get, "") => (200, "text/html; charset=utf-8", HTML.to_owned()),
        (Method::Post, "state" | "key" | "leave" | "motion") => {
            let tab = body.get("tab").and_then(Value::as_str).unwrap_or_default();
            if !state.admits(tab) {
                return text(409, "the session is open in another tab");
            }
            match path {
                "key" => state.press(&body),
                "motion" => state.touch(&body),
                "leave" => state.owner = None,
                _ => {}
            }
            let reply = state.reply();
            (200, "application/json", reply.to_string())
        }
        _ => text(404, "there is no such page"),
    }
}

/// The state as the page gets it.
#[derive(Serialize)]
struct Shown<'a> {
    step: u64,
    view: &'a View,
    done: usize,
    all: usize,
    title: &'a str,
    noise_dbfs: Option<f64>,
    touch_mm_per_px: Option<f64>,
}

impl State {
    /// Whether a tab owns the session, or may own it from now on.
    fn admits(&mut self, tab: &str) -> bool {
        let now = Instant::now();
        let is_free = match &self.owner {
            None => true,
            Some((owner, last)) => owner == tab || now.duration_since(*last) > SILENT,
        };
        let admitted = is_free && !tab.is_empty();
        if admitted {
            self.owner = Some((tab.to_owned(), now));
        }
        admitted
    }

    fn reply(&mut self) -> Value {
        self.seen = self.step;
        json!(Shown {
            step: self.step,
            view: &self.view,
            done: self.done,
            all: self.all,
            title: &self.options.title,
            noise_dbfs: self.options.noise_dbfs,
            touch_mm_per_px: self.options.touch_mm_per_px,
        })
    }

    /// Takes a key, if it is for this view and the first one.
    fn press(&mut self, body: &Value) {
        let step = body.get("step").and_then(Value::as_u64);
        let name = body.get("key").and_then(Value::as_str).unwrap_or_default();
        if step != Some(self.step) || self.answered == Some(self.step) {
            return;
        }
        let is_guarded = matches!(self.view, View::Question { .. } | View::Matching { .. });
        if is_guarded && self.shown.elapsed() < GUARD {
            return;
        }
        if let Some(key) = key(name, &self.view) {
            self.answered = Some(self.step);
            self.keys.push_back(key);
        }
    }

    fn touch(&mut self, body: &Value) {
        let speed_mm_s = body.get("speed_mm_s").and_then(Value::as_f64);
        let is_down = body.get("down").and_then(Value::as_bool).unwrap_or(false);
        if let Some(speed_mm_s) = speed_mm_s.filter(|v| v.abs() <= 1e4) {
            // Nobody may listen.
            let _ = self.touched.send(Touched {
                speed_mm_s,
                is_down,
            });
        }
    }
}

/// The meaning of a key in a view.
fn key(name: &str, view: &View) -> Option<Key> {
    match view {
        View::Ready { .. } | View::Rest { seconds: 0 } => (name == "go").then_some(Key::Go),
        View::Question { scale, .. } => {
            let digit = name.parse().ok()?;
            let is_on_scale = (scale.min..=scale.max).contains(&digit);
            is_on_scale.then_some(Key::Digit(digit))
        }
        View::Matching { method, .. } => {
            let key: GainKey = serde_json::from_value(Value::String(name.to_owned())).ok()?;
            let is_up = matches!(key, GainKey::Stronger | GainKey::MuchStronger);
            let is_single = matches!(key, GainKey::Stronger | GainKey::Weaker);
            let is_taken = match method {
                GainMethod::Adjustment => true,
                GainMethod::Descending => !is_up,
                GainMethod::Staircase => is_single,
            };
            is_taken.then_some(Key::Gain(key))
        }
        View::Playing { .. } | View::Rest { .. } | View::Done => None,
    }
}
