//! The web page through which the participant answers during a session ([`crate::page`]).
//!
//! Each view has a number, and an answer contains the number of the view that it answers.
//! Therefore, a second press of a key does not count, because the view with this number has already
//! been answered. A press for a view that is no longer shown does not count either.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use serde::Serialize;
use serde_json::{Value, json};

use crate::error::LabError;
use crate::page::{Content, LocalPage};
use crate::study::asking::{Asker, Key, View};
use crate::study::gain::{GainKey, takes};

/// If a page has not reported the finger for this time, the page may be closed. The finger then
/// counts as lifted.
const SILENT: Duration = Duration::from_millis(300);

/// Options of a session's page.
#[derive(Debug, Clone, Default)]
pub struct PageOptions {
    /// Port; 0 means any free port.
    pub port: u16,
    pub title: String,
    /// RMS level of the masking noise, decibels relative to full scale. `None` plays no noise.
    pub noise_dbfs: Option<f64>,
    /// Size of a pixel of the page, mm. If `None`, the page does not report the finger's motion.
    pub touch_mm_per_px: Option<f64>,
}

/// Motion of the finger that touches the page.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TouchMotion {
    /// Speed, mm/s; negative to the left; NaN if the page did not report one.
    pub speed_mm_s: f64,
    /// Whether the finger is on the page.
    pub is_down: bool,
}

/// A handle that reads the motion of the finger on a page.
#[derive(Clone)]
pub struct Touch(Arc<PageState>);

impl Touch {
    /// Returns the finger's current motion, or `None` if the page has not reported for 300 ms.
    pub fn now(&self) -> Option<TouchMotion> {
        let state = self.0.lock();
        let (touched, at) = state.touched?;
        (touched.is_down && at.elapsed() < SILENT).then_some(touched)
    }
}

/// A session's page. This machine serves the page until this value is dropped.
pub struct Page {
    asked: Arc<PageState>,
    served: LocalPage,
}

/// The state of the page, shared by the server's thread and the session's thread.
struct PageState(Mutex<State>);

struct State {
    options: PageOptions,
    /// Number of the current view.
    step: u64,
    view: View,
    shown: Instant,
    done: usize,
    all: usize,
    keys: VecDeque<Key>,
    /// Number of the view that has been answered.
    answered: Option<u64>,
    /// Number of the view that the page has received.
    seen: u64,
    /// Whether a tab has stopped the session.
    is_stopped: bool,
    /// The last motion and its time.
    touched: Option<(TouchMotion, Instant)>,
}

impl Page {
    /// Serves the page on this machine.
    ///
    /// # Errors
    /// Returns [`LabError::Page`] if the port is taken or the system provides no random numbers.
    pub fn open(options: PageOptions) -> Result<Self, LabError> {
        let port = options.port;
        let asked = Arc::new(PageState(Mutex::new(State::new(options))));
        Ok(Self { served: LocalPage::open(port, Arc::clone(&asked))?, asked })
    }

    pub fn address(&self) -> String {
        self.served.address()
    }

    /// Returns a handle that reads the motion of the finger on the page.
    pub fn touch(&self) -> Touch {
        Touch(Arc::clone(&self.asked))
    }
}

impl Asker for Page {
    fn show(&mut self, view: &View, done: usize, all: usize) {
        self.asked.lock().show(view, done, all);
    }

    fn key(&mut self) -> Option<Key> {
        let mut state = self.asked.lock();
        if state.is_stopped { Some(Key::Quit) } else { state.keys.pop_front() }
    }
}

impl Drop for Page {
    fn drop(&mut self) {
        self.served.wait_for_end(|| {
            // Without this wait, the page would stay at the previous view and never show the end.
            let state = self.asked.lock();
            state.seen == state.step
        });
    }
}

impl PageState {
    fn lock(&self) -> MutexGuard<'_, State> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Content for PageState {
    const HTML: &'static str = include_str!("page.html");
    const REQUESTS: &'static [&'static str] = &["key", "motion"];

    fn handle(&self, request: &str, body: &Value) {
        let mut state = self.lock();
        match request {
            "key" => state.press(body),
            "motion" => state.touch(body),
            _ => state.is_stopped = true,
        }
    }

    fn state(&self) -> Value {
        self.lock().reply()
    }
}

/// The state in the form that the page receives.
#[derive(Serialize)]
struct PageReply<'a> {
    step: u64,
    view: &'a View,
    done: usize,
    all: usize,
    title: &'a str,
    noise_dbfs: Option<f64>,
    touch_mm_per_px: Option<f64>,
}

impl State {
    fn new(options: PageOptions) -> Self {
        Self {
            options,
            step: 0,
            view: View::Done,
            shown: Instant::now(),
            done: 0,
            all: 0,
            keys: VecDeque::new(),
            answered: None,
            seen: 0,
            is_stopped: false,
            touched: None,
        }
    }

    fn show(&mut self, view: &View, done: usize, all: usize) {
        self.step += 1;
        self.view = view.clone();
        self.shown = Instant::now();
        (self.done, self.all) = (done, all);
        self.keys.clear();
    }

    fn reply(&mut self) -> Value {
        self.seen = self.step;
        json!(PageReply {
            step: self.step,
            view: &self.view,
            done: self.done,
            all: self.all,
            title: &self.options.title,
            noise_dbfs: self.options.noise_dbfs,
            touch_mm_per_px: self.options.touch_mm_per_px,
        })
    }

    /// Accepts a key only if it is the first key that answers the current view.
    fn press(&mut self, body: &Value) {
        let step = body.get("step").and_then(Value::as_u64);
        let name = body.get("key").and_then(Value::as_str).unwrap_or_default();
        if step != Some(self.step) || self.answered == Some(self.step) {
            return;
        }
        if self.shown.elapsed() < self.view.guard() {
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
        let touched = TouchMotion { speed_mm_s: speed_mm_s.unwrap_or(f64::NAN), is_down };
        self.touched = Some((touched, Instant::now()));
    }
}

/// Returns the meaning of a key in a view.
fn key(name: &str, view: &View) -> Option<Key> {
    match view {
        View::Ready { .. } | View::Rest { seconds: 0 } => (name == "go").then_some(Key::Go),
        View::Question { scale, .. } => {
            let digit = name.parse().ok()?;
            let is_on_scale = (scale.min..=scale.max).contains(&digit);
            is_on_scale.then_some(Key::Digit(digit))
        }
        View::Matching { method, rising, .. } => {
            let key: GainKey = serde_json::from_value(Value::String(name.to_owned())).ok()?;
            takes(*method, *rising, key).then_some(Key::Gain(key))
        }
        View::Playing { .. } | View::Rest { .. } | View::Done => None,
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;
    use crate::study::file::Phase;

    /// If a key is pressed twice, 0.15 to 0.45 s apart, the first press ends the rest, and the
    /// second press does not begin a trial.
    #[test]
    fn a_double_press_at_a_rest_begins_no_trial() {
        let mut state = State::new(PageOptions::default());
        let ready =
            View::Ready { phase: Phase::Testing, texture: "vinyl".to_owned(), notice: None };
        let pressed = |state: &mut State| {
            state.press(&json!({ "step": state.step, "key": "go" }));
            state.keys.pop_front()
        };
        for apart_ms in [150, 300, 450] {
            state.show(&View::Rest { seconds: 0 }, 1, 2);
            assert_eq!(pressed(&mut state), None, "before the message is read");
            std::thread::sleep(View::Rest { seconds: 0 }.guard());
            assert_eq!(pressed(&mut state), Some(Key::Go));
            state.show(&ready, 1, 2);
            std::thread::sleep(Duration::from_millis(apart_ms));
            assert_eq!(pressed(&mut state), None, "{apart_ms} ms");
            std::thread::sleep(ready.guard());
            assert_eq!(pressed(&mut state), Some(Key::Go));
        }
    }
}
