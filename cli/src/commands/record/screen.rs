//! Guidance in a terminal: the target and the finger as two squares, the force by its colour, a metronome by the bell.

use std::io::{IsTerminal, Write};
use std::time::{Duration, Instant};

use htex_lab::record::{Force, Guidance, Moment, Phase};

use crate::output::tell;

/// Width of the way that the squares move on, characters.
const WAY: usize = 32;
/// Shortest time between two drawings.
const PERIOD: Duration = Duration::from_millis(33);

/// Draws on standard error if that is a terminal; elsewhere tells only what begins.
pub(super) struct Screen {
    guidance: Guidance,
    is_terminal: bool,
    drawn: Option<Instant>,
    beats: u64,
    begun: Option<(Phase, u32)>,
    has_line: bool,
}

impl Screen {
    pub(super) fn new(guidance: Guidance) -> Self {
        Self {
            guidance,
            is_terminal: std::io::stderr().is_terminal(),
            drawn: None,
            beats: 0,
            begun: None,
            has_line: false,
        }
    }

    pub(super) fn show(&mut self, moment: &Moment) {
        if self.begun != Some((moment.phase, moment.number)) {
            self.begun = Some((moment.phase, moment.number));
            self.beats = 0;
            self.end();
            tell!("{}", beginning(moment));
        }
        let beats = self.guidance.beats(moment.elapsed_s);
        let is_beat = beats > self.beats && moment.phase != Phase::Tare;
        self.beats = beats;
        let is_due = self.drawn.is_none_or(|drawn| drawn.elapsed() >= PERIOD);
        if !self.is_terminal || !(is_due || is_beat) {
            return;
        }
        self.drawn = Some(Instant::now());
        let bell = if is_beat { "\x07" } else { "" };
        let line = drawn(&self.guidance, moment);
        let mut error = std::io::stderr();
        let _ = write!(error, "\r\x1b[K{line}{bell}").and_then(|()| error.flush());
        self.has_line = true;
    }

    /// Ends the line that is redrawn.
    pub(super) fn end(&mut self) {
        if std::mem::take(&mut self.has_line) {
            tell!();
        }
    }
}

fn beginning(moment: &Moment) -> String {
    let Moment { number, of_s, .. } = *moment;
    match moment.phase {
        Phase::Tare => format!("tare: leave the surface alone for {of_s} s"),
        Phase::Countdown => format!("take {number} begins in {of_s} s"),
        Phase::Take => format!("take {number}: {of_s} s"),
    }
}

/// A line: the seconds left, the target above as a square on its way, the finger as one in the colour of its force.
fn drawn(guidance: &Guidance, moment: &Moment) -> String {
    let left_s = (moment.of_s - moment.elapsed_s).max(0.0);
    let target = match moment.phase {
        Phase::Tare => None,
        _ => guidance.target_mm(moment.elapsed_s),
    };
    let colour = match guidance.force(moment.force_n) {
        Force::Unknown => "",
        Force::Below => "\x1b[33m",
        Force::Within => "\x1b[32m",
        Force::Above => "\x1b[31m",
    };
    let newtons = moment
        .force_n
        .map_or(String::new(), |n| format!(" {n:6.3} N"));
    format!(
        "{left_s:5.1} s  target {}  finger {colour}{}{newtons}\x1b[0m",
        way(target, guidance.stroke_mm),
        way(moment.position_mm, guidance.stroke_mm)
    )
}

/// A way with a square at a position; without one if that is not known.
fn way(at_mm: Option<f64>, stroke_mm: f64) -> String {
    let place =
        at_mm.map(|mm| ((mm / stroke_mm).clamp(0.0, 1.0) * (WAY - 1) as f64).round() as usize);
    let cell = |i: usize| if place == Some(i) { '■' } else { '·' };
    (0..WAY).map(cell).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn squares_move_and_the_force_has_its_colour() {
        let guidance = Guidance {
            speed_mm_s: Some(80.0),
            force_n: Some(0.4),
            tolerance: 0.1,
            stroke_mm: 80.0,
        };
        let line = |elapsed_s: f64, force_n: f64| {
            let moment = Moment {
                phase: Phase::Take,
                number: 1,
                elapsed_s,
                of_s: 10.0,
                force_n: Some(force_n),
                position_mm: Some(0.0),
            };
            drawn(&guidance, &moment)
        };
        let begin = format!("■{}", "·".repeat(WAY - 1));
        let end: String = begin.chars().rev().collect();
        assert_eq!(
            line(0.0, 0.3),
            format!(" 10.0 s  target {begin}  finger \x1b[33m{begin}  0.300 N\x1b[0m")
        );
        assert_eq!(
            line(1.0, 0.4),
            format!("  9.0 s  target {end}  finger \x1b[32m{begin}  0.400 N\x1b[0m")
        );
        assert!(line(1.0, 0.45).contains("\x1b[31m"));
    }
}
