//! Questions and answers in a terminal, with single keys from a keyboard or lines from a pipe.

use std::io::IsTerminal;
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::time::Instant;

use htex_lab::study::{Asker, GainKey, GainMethod, Key, View};

#[cfg(unix)]
use super::keys::Keys;
use crate::failure::Result;
use crate::output::tell;

/// Asks on standard error and reads answers from standard input.
pub(super) struct Terminal {
    input: Input,
    view: View,
    /// When the current view was shown.
    shown: Instant,
}

enum Input {
    /// Keys of a terminal.
    #[cfg(unix)]
    Keys(Keys),
    /// Lines. Lines typed before a question are discarded; lines from a pipe are not.
    Lines { lines: Receiver<String>, is_typed: bool },
}

impl Terminal {
    pub(super) fn new() -> Self {
        Self { input: input(), view: View::Done, shown: Instant::now() }
    }

    fn words(&self, view: &View) -> String {
        let is_line = matches!(self.input, Input::Lines { .. });
        htex_base::finding::plain(&text(view, is_line)).into_owned()
    }

    fn refuse(&self, typed: &str) {
        tell!("{typed:?} is no answer; {}", self.words(&self.view));
    }
}

/// Reads keys if standard input is a terminal, else lines.
fn input() -> Input {
    let is_typed = std::io::stdin().is_terminal();
    #[cfg(unix)]
    if let Some(keys) = is_typed.then(Keys::begin).flatten() {
        return Input::Keys(keys);
    }
    let (sender, lines) = channel();
    std::thread::spawn(move || {
        for line in std::io::stdin().lines().map_while(Result::ok) {
            if sender.send(line).is_err() {
                return;
            }
        }
    });
    Input::Lines { lines, is_typed }
}

impl Asker for Terminal {
    fn show(&mut self, view: &View, done: usize, all: usize) {
        let goes_on = matches!((view, &self.view), (View::Rest { .. }, View::Rest { .. }));
        let is_countdown = goes_on && matches!(view, View::Rest { seconds } if *seconds > 0);
        match &mut self.input {
            _ if is_countdown => {}
            #[cfg(unix)]
            Input::Keys(keys) => keys.forget(),
            Input::Lines { lines, is_typed } => while *is_typed && lines.try_recv().is_ok() {},
        }
        self.view = view.clone();
        self.shown = Instant::now();
        if !is_countdown {
            tell!("[{done}/{all}] {}", self.words(view));
        }
    }

    fn key(&mut self) -> Option<Key> {
        let line = match &mut self.input {
            #[cfg(unix)]
            Input::Keys(keys) => {
                let press = keys.next(&self.view)?;
                let key = press.line(&self.view).and_then(|line| key(&line, &self.view));
                if key.is_none() && !matches!(self.view, View::Playing { .. }) {
                    self.refuse(&press.name());
                }
                return key;
            }
            // Lines from a pipe wait for the question.
            Input::Lines { is_typed: false, .. } if matches!(self.view, View::Playing { .. }) => {
                return None;
            }
            Input::Lines { lines, is_typed } => match lines.try_recv() {
                Ok(_) if *is_typed && self.shown.elapsed() < self.view.guard() => return None,
                Ok(line) => line,
                Err(TryRecvError::Empty) => return None,
                Err(TryRecvError::Disconnected) => return Some(Key::Quit),
            },
        };
        let key = key(line.trim(), &self.view);
        if key.is_none() {
            self.refuse(&line);
        }
        key
    }
}

/// Returns the meaning of a line.
fn key(line: &str, view: &View) -> Option<Key> {
    let is_matching = matches!(view, View::Matching { .. });
    Some(match line {
        "q" => Key::Quit,
        "" if is_matching => Key::Gain(GainKey::Accept),
        "+" => Key::Gain(GainKey::Stronger),
        "-" => Key::Gain(GainKey::Weaker),
        "++" => Key::Gain(GainKey::MuchStronger),
        "--" => Key::Gain(GainKey::MuchWeaker),
        "" => Key::Go,
        digit => match (view, digit.parse()) {
            (View::Question { scale, .. }, Ok(digit))
                if (scale.min..=scale.max).contains(&digit) =>
            {
                Key::Digit(digit)
            }
            _ => return None,
        },
    })
}

/// Returns the text of the question, with the keys or lines that answer it.
fn text(view: &View, is_line: bool) -> String {
    match view {
        View::Ready { texture, .. } => format!("{texture}: Enter to begin, q to leave"),
        View::Playing { texture } => format!("{texture} plays"),
        View::Question { attribute, scale, .. } => format!(
            "{} {} {} to {} {}{}",
            attribute.question,
            scale.min,
            scale.low,
            scale.max,
            scale.high,
            if is_line { ", and Enter" } else { "" }
        ),
        View::Matching { texture, rising: true, .. } => {
            let keys = if is_line {
                "+ or ++ stronger, - or -- weaker, Enter alone: you feel it"
            } else {
                "+ or Page Up stronger, - or Page Down weaker, Enter: you feel it"
            };
            format!(
                "{texture}: make it stronger until you feel it as strongly as the real one, or more strongly: {keys}"
            )
        }
        View::Matching { texture, method, .. } => {
            let keys = match (method, is_line) {
                (GainMethod::Descending, true) => "- or -- weaker, Enter alone: it matches",
                (GainMethod::Adjustment, true) => {
                    "+ or ++ stronger, - or -- weaker, Enter alone: it matches"
                }
                (GainMethod::Descending, false) => "- or Page Down weaker, Enter: it matches",
                (GainMethod::Adjustment, false) => {
                    "+ or Page Up stronger, - or Page Down weaker, Enter: it matches"
                }
                (GainMethod::Staircase, _) => "+ it should be stronger, - it should be weaker",
            };
            format!("{texture}, compared with the real one: {keys}")
        }
        View::Rest { seconds: 0 } => "Rest; Enter to go on".to_owned(),
        View::Rest { seconds } => format!("Rest for {seconds} s"),
        View::Done => "All trials are done. Thank you".to_owned(),
    }
}
