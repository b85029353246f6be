//! Questions and answers in a terminal.

use std::io::IsTerminal;
use std::sync::mpsc::{Receiver, TryRecvError, channel};

use htex_lab::study::{Asker, GainKey, GainMethod, Key, View};

use crate::output::tell;

/// Asks on standard error and reads lines of standard input.
pub(super) struct Terminal {
    lines: Receiver<String>,
    view: View,
    /// Lines that were typed before a question are forgotten; those of a pipe are not.
    is_typed: bool,
}

impl Terminal {
    pub(super) fn new() -> Self {
        let (sender, lines) = channel();
        std::thread::spawn(move || {
            for line in std::io::stdin().lines().map_while(Result::ok) {
                if sender.send(line).is_err() {
                    return;
                }
            }
        });
        Self {
            lines,
            view: View::Done,
            is_typed: std::io::stdin().is_terminal(),
        }
    }
}

impl Asker for Terminal {
    fn show(&mut self, view: &View, done: usize, all: usize) {
        let is_countdown = matches!((view, &self.view), (View::Rest { seconds }, View::Rest { .. }) if *seconds > 0);
        if self.is_typed && !matches!((view, &self.view), (View::Rest { .. }, View::Rest { .. })) {
            while self.lines.try_recv().is_ok() {}
        }
        self.view = view.clone();
        if !is_countdown {
            tell!("[{done}/{all}] {}", htex_format::plain(&text(view)));
        }
    }

    fn key(&mut self) -> Option<Key> {
        // The lines of a pipe wait for the question.
        if !self.is_typed && matches!(self.view, View::Playing { .. }) {
            return None;
        }
        let line = match self.lines.try_recv() {
            Ok(line) => line,
            Err(TryRecvError::Empty) => return None,
            Err(TryRecvError::Disconnected) => return Some(Key::Quit),
        };
        let key = key(line.trim(), &self.view);
        if key.is_none() {
            tell!(
                "{line:?} is no answer; {}",
                htex_format::plain(&text(&self.view))
            );
        }
        key
    }
}

/// The meaning of a line.
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

fn text(view: &View) -> String {
    match view {
        View::Ready { texture, .. } => format!("{texture}: Enter to begin, q to leave"),
        View::Playing { texture } => format!("{texture} plays"),
        View::Question { attribute, scale } => format!(
            "{} {} {} to {} {}, and Enter",
            attribute.question, scale.min, scale.low, scale.max, scale.high
        ),
        View::Matching {
            texture, method, ..
        } => {
            let keys = match method {
                GainMethod::Descending => "- or -- weaker, Enter alone: it matches",
                GainMethod::Adjustment => {
                    "+ or ++ stronger, - or -- weaker, Enter alone: it matches"
                }
                GainMethod::Staircase => "+ it should be stronger, - it should be weaker",
            };
            format!("{texture}, compared with the real one: {keys}")
        }
        View::Rest { seconds: 0 } => "Rest; Enter to go on".to_owned(),
        View::Rest { seconds } => format!("Rest for {seconds} s"),
        View::Done => "All trials are done. Thank you".to_owned(),
    }
}
