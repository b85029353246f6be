//! Progress by the crate `indicatif`.

use std::io;
use std::io::IsTerminal;
use std::sync::Mutex;
use std::time::{Duration, Instant};

use htex_base::finding::plain;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle, TermLike};

use super::{BETWEEN, is_quiet};
use crate::output::tell;

/// Returns a progress bar over steps.
pub(crate) fn bar(steps: u64) -> ProgressBar {
    progress(steps, "{bar:24} {pos}/{len} {msg}", "{pos}/{len} {msg}")
}

/// Returns a progress bar over bytes, with the rate and the time left.
#[cfg(feature = "build")]
pub(crate) fn byte_bar(bytes: u64) -> ProgressBar {
    let rest = "{msg}, {bytes} of {total_bytes}, {bytes_per_sec}, {eta} left";
    progress(bytes, &format!("{{bar:24}} {rest}"), rest)
}

fn progress(length: u64, on_terminal: &str, elsewhere: &str) -> ProgressBar {
    let is_terminal = io::stderr().is_terminal();
    let target = if is_quiet() {
        ProgressDrawTarget::hidden()
    } else if is_terminal {
        ProgressDrawTarget::stderr()
    } else {
        ProgressDrawTarget::term_like(Box::new(Lines::every(BETWEEN)))
    };
    let bar = ProgressBar::with_draw_target(Some(length), target);
    let template = if is_terminal { on_terminal } else { elsewhere };
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
    if !is_terminal && !is_quiet() {
        // So that a step that takes long also has its lines.
        bar.enable_steady_tick(Duration::from_secs(1));
    }
    bar
}

/// Prints a drawing as a line, unless the last one was printed a short time ago.
#[derive(Debug)]
struct Lines {
    between: Duration,
    state: Mutex<Drawing>,
}

#[derive(Debug)]
struct Drawing {
    text: String,
    last: Instant,
}

impl Lines {
    fn every(between: Duration) -> Self {
        Self { between, state: Mutex::new(Drawing { text: String::new(), last: Instant::now() }) }
    }

    fn with<T>(&self, then: impl FnOnce(&mut Drawing) -> T) -> T {
        then(&mut self.state.lock().unwrap_or_else(std::sync::PoisonError::into_inner))
    }
}

impl TermLike for Lines {
    fn width(&self) -> u16 {
        100
    }

    fn move_cursor_up(&self, _: usize) -> io::Result<()> {
        Ok(())
    }

    fn move_cursor_down(&self, _: usize) -> io::Result<()> {
        Ok(())
    }

    fn move_cursor_right(&self, _: usize) -> io::Result<()> {
        Ok(())
    }

    fn move_cursor_left(&self, _: usize) -> io::Result<()> {
        Ok(())
    }

    fn write_line(&self, text: &str) -> io::Result<()> {
        self.write_str(text)
    }

    fn write_str(&self, text: &str) -> io::Result<()> {
        self.with(|drawing| drawing.text += text);
        Ok(())
    }

    fn clear_line(&self) -> io::Result<()> {
        self.with(|drawing| drawing.text.clear());
        Ok(())
    }

    fn flush(&self) -> io::Result<()> {
        self.with(|drawing| {
            let text = std::mem::take(&mut drawing.text);
            let text = text.trim();
            if !text.is_empty() && drawing.last.elapsed() >= self.between {
                drawing.last = Instant::now();
                tell!("{}", plain(text));
            }
        });
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A drawing is one line, and the next one comes only after the time between them.
    #[test]
    fn lines_are_rare() {
        let lines = Lines::every(Duration::from_secs(3600));
        lines.write_str("1/9 a").unwrap();
        lines.flush().unwrap();
        assert_eq!(lines.with(|drawing| drawing.text.clone()), "");
        let before = lines.with(|drawing| drawing.last);
        let at_once = Lines::every(Duration::ZERO);
        at_once.write_line("2/9 b").unwrap();
        at_once.flush().unwrap();
        assert!(at_once.with(|drawing| drawing.last) > before);
        assert_eq!(lines.with(|drawing| drawing.last), before);
    }
}
