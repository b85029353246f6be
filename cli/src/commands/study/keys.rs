//! Reads single keys from a terminal, without Enter.

use std::io::Read;
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use htex_lab::study::View;
use rustix::stdio::stdin;
use rustix::termios::{
    LocalModes, OptionalActions, SpecialCodeIndex, Termios, tcgetattr, tcsetattr,
};

/// A key that repeats within this time is considered held down.
const HELD: Duration = Duration::from_millis(700);

/// A key of a keyboard.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Press {
    Char(char),
    Up,
    Down,
    PageUp,
    PageDown,
    /// The end of the input.
    End,
    /// Any other key.
    Other,
}

impl Press {
    /// Returns the input line that has the same meaning as this key in a view; `None` if the key
    /// has no meaning.
    pub(super) fn line(self, view: &View) -> Option<String> {
        let is_matching = matches!(view, View::Matching { .. });
        Some(match self {
            Self::Char('\r' | '\n') => String::new(),
            Self::Char(' ') if !is_matching => String::new(),
            Self::Char('=') | Self::Up => "+".to_owned(),
            Self::Down => "-".to_owned(),
            Self::PageUp => "++".to_owned(),
            Self::PageDown => "--".to_owned(),
            Self::End => "q".to_owned(),
            Self::Char(' ') | Self::Other => return None,
            Self::Char(key) => key.to_string(),
        })
    }

    /// Returns the name of the key for messages.
    pub(super) fn name(self) -> String {
        match self {
            Self::Char(key) => key.to_string(),
            Self::Up => "Up".to_owned(),
            Self::Down => "Down".to_owned(),
            Self::PageUp => "Page Up".to_owned(),
            Self::PageDown => "Page Down".to_owned(),
            Self::End | Self::Other => "this key".to_owned(),
        }
    }
}

/// Reads single keys from the terminal on standard input. Dropping this value restores the
/// terminal's settings. Ctrl-C is still a signal.
pub(super) struct Keys {
    before: Termios,
    presses: Receiver<Press>,
    /// The most recent key and when it came.
    last: Option<(Press, Instant)>,
    shown: Instant,
}

impl Keys {
    /// Starts reading single keys; `None` if standard input is not a terminal.
    pub(super) fn begin() -> Option<Self> {
        let before = tcgetattr(stdin()).ok()?;
        let mut single = before.clone();
        single.local_modes -= LocalModes::ICANON | LocalModes::ECHO;
        // A read waits for at least one byte, and then returns all bytes that have arrived.
        single.special_codes[SpecialCodeIndex::VMIN] = 1;
        single.special_codes[SpecialCodeIndex::VTIME] = 0;
        tcsetattr(stdin(), OptionalActions::Now, &single).ok()?;
        let (sender, presses) = channel();
        // A read from a terminal cannot be cancelled, so the thread ends with the process.
        std::thread::spawn(move || {
            let mut bytes = [0; 64];
            loop {
                let count = std::io::stdin().lock().read(&mut bytes).unwrap_or(0);
                let read = match count {
                    0 => vec![Press::End],
                    _ => presses_of(&bytes[..count]),
                };
                if read.into_iter().any(|press| sender.send(press).is_err()) || count == 0 {
                    return;
                }
            }
        });
        Some(Self { before, presses, last: None, shown: Instant::now() })
    }

    /// Discards the keys that were pressed before a new view is shown.
    pub(super) fn forget(&mut self) {
        while let Some(press) = self.pressed() {
            if press == Press::End {
                // The end of the input comes only once, so it must not be discarded. `next` looks
                // for it here.
                self.last = Some((Press::End, Instant::now()));
                break;
            }
        }
        self.shown = Instant::now();
    }

    /// Returns the next key. Skips a key that is held down, and keys that come too soon after the
    /// view was shown.
    pub(super) fn next(&mut self, view: &View) -> Option<Press> {
        if matches!(self.last, Some((Press::End, _))) {
            return Some(Press::End);
        }
        loop {
            // This is read first, because `pressed` replaces `self.last`.
            let before = self.last;
            let press = self.pressed()?;
            let is_held = before.is_some_and(|(own, at)| own == press && at.elapsed() < HELD);
            let is_early = self.shown.elapsed() < view.guard();
            if press == Press::End || !(is_held || is_early) {
                return Some(press);
            }
        }
    }

    fn pressed(&mut self) -> Option<Press> {
        let press = self.presses.try_recv().ok()?;
        self.last = Some((press, Instant::now()));
        Some(press)
    }
}

impl Drop for Keys {
    fn drop(&mut self) {
        // If the terminal is gone, nothing can be done about it.
        let _ = tcsetattr(stdin(), OptionalActions::Flush, &self.before);
    }
}

/// Decodes the keys in bytes that a terminal sent at once.
fn presses_of(bytes: &[u8]) -> Vec<Press> {
    let mut presses = Vec::new();
    let mut rest = bytes;
    while let Some(first) = rest.first() {
        let special = [
            (&b"\x1b[A"[..], Press::Up),
            (b"\x1bOA", Press::Up),
            (b"\x1b[B", Press::Down),
            (b"\x1bOB", Press::Down),
            (b"\x1b[5~", Press::PageUp),
            (b"\x1b[6~", Press::PageDown),
        ];
        if let Some((code, press)) = special.iter().find(|(code, _)| rest.starts_with(code)) {
            presses.push(*press);
            rest = &rest[code.len()..];
            continue;
        }
        presses.push(match first {
            // Ctrl-D.
            4 => Press::End,
            b' '..=b'~' | b'\r' | b'\n' => Press::Char(char::from(*first)),
            _ => Press::Other,
        });
        // The bytes after an unknown escape belong to this escape.
        rest = match first {
            0x1b => &[],
            _ => &rest[1..],
        };
    }
    presses
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_told_from_their_bytes() {
        let bytes = b"3\x1b[A\x1bOB\x1b[5~\x1b[6~-\r\x04";
        let expected = [
            Press::Char('3'),
            Press::Up,
            Press::Down,
            Press::PageUp,
            Press::PageDown,
            Press::Char('-'),
            Press::Char('\r'),
            Press::End,
        ];
        assert_eq!(presses_of(bytes), expected);
        assert_eq!(presses_of(b"\x1b[15~"), [Press::Other], "no digits of a function key");
        assert_eq!(presses_of("ä".as_bytes()), [Press::Other; 2]);
    }
}
