//! Guidance in a terminal. One square shows the target, another one the finger. The colour of the
//! finger's square shows the force. The bell rings when the target turns. Bars show the spectrum of
//! the recording.

use std::io::{IsTerminal, Write};
use std::time::{Duration, Instant};

use htex_format::Quantity;
use htex_lab::record::{Force, Guidance, LiveSignal, LiveSpectrum, Moment, Phase, Requirements};

use crate::output::tell;

/// Width of the path on which the squares move, characters.
const WAY: usize = 24;
/// Shortest time between two drawings.
const PERIOD: Duration = Duration::from_millis(33);
/// The heights of a band's bar, in steps of [`STEP_DB`].
const BARS: [char; 9] = [' ', '▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];
/// Difference of level between two heights of a bar, decibels.
const STEP_DB: f64 = 6.0;
/// Width of a band's bar, characters.
const BAR_WIDTH: usize = 2;

/// Draws on standard error if it is a terminal. Otherwise only prints a line when a phase begins,
/// such as a countdown or a take.
pub(super) struct Screen {
    guidance: Guidance,
    required: Requirements,
    signal: LiveSignal,
    is_terminal: bool,
    drawn: Option<Instant>,
    turns: Option<i64>,
    begun: Option<(Phase, u32)>,
    has_lines: bool,
}

impl Screen {
    pub(super) fn new(
        guidance: Guidance,
        required: Requirements,
        quantity: Quantity,
        rate_hz: f64,
    ) -> Self {
        Self {
            guidance,
            required,
            signal: LiveSignal::new(quantity, rate_hz),
            is_terminal: std::io::stderr().is_terminal(),
            drawn: None,
            turns: None,
            begun: None,
            has_lines: false,
        }
    }

    pub(super) fn show(&mut self, moment: &Moment<'_>) {
        if self.begun != Some((moment.phase, moment.number)) {
            self.begun = Some((moment.phase, moment.number));
            self.signal.clear();
            // Otherwise the text would be written into the two lines that are redrawn.
            self.end();
            tell!("{}", beginning(moment, self.required));
        }
        self.signal.push(moment.texture);
        let motion_s = moment.phase.motion_s(moment.elapsed_s, moment.of_s);
        let turns = motion_s.and_then(|at_s| self.guidance.turns(at_s));
        // The first moment has no turn before it, so the bell does not ring at the start.
        let is_beat = self.turns.is_some() && turns > self.turns;
        self.turns = turns;
        let is_due = self.drawn.is_none_or(|drawn| drawn.elapsed() >= PERIOD);
        if !self.is_terminal || !(is_due || is_beat) {
            return;
        }
        self.drawn = Some(Instant::now());
        let bell = if is_beat { "\x07" } else { "" };
        let [ways, felt] = drawn(&self.guidance, moment, self.signal.spectrum().as_ref());
        let mut error = std::io::stderr();
        // The cursor waits at the beginning of the first line.
        let lines = format!("\r\x1b[K{ways}\n\x1b[K{felt}{bell}\r\x1b[A");
        let _ = write!(error, "{lines}").and_then(|()| error.flush());
        self.has_lines = true;
    }

    /// Moves the cursor below the lines that are redrawn.
    pub(super) fn end(&mut self) {
        if std::mem::take(&mut self.has_lines) {
            // Two line ends, because the cursor is in the first of two lines.
            tell!("\n");
        }
    }
}

fn beginning(moment: &Moment<'_>, required: Requirements) -> String {
    let Moment { number, of_s, .. } = *moment;
    match moment.phase {
        Phase::Lift => format!("take the finger off the surface within {of_s} s"),
        Phase::Tare => format!("tare: leave the surface alone for {of_s} s"),
        Phase::Countdown => format!("take {number} begins in {of_s} s{}", asked(required)),
        Phase::Take => format!("take {number}: {of_s} s{}", asked(required)),
    }
}

/// Says what a take needs to be accepted.
fn asked(required: Requirements) -> String {
    let Requirements { on_target, sweeps } = required;
    let share = (on_target > 0.0).then(|| format!("on target {:.0} % or more", 100.0 * on_target));
    let sweeps = (sweeps > 0).then(|| format!("complete sweeps {sweeps} or more"));
    let all: Vec<String> = share.into_iter().chain(sweeps).collect();
    if all.is_empty() { String::new() } else { format!("; it needs: {}", all.join(", ")) }
}

/// Returns two lines. The first has the seconds left, the target as a square on its path, and the
/// finger as a square in the colour of its force. The second has the force and the spectrum.
fn drawn(guidance: &Guidance, moment: &Moment<'_>, spectrum: Option<&LiveSpectrum>) -> [String; 2] {
    let left_s = (moment.of_s - moment.elapsed_s).max(0.0);
    let motion_s = moment.phase.motion_s(moment.elapsed_s, moment.of_s);
    let target = motion_s.and_then(|at_s| guidance.target_mm(at_s));
    // Without a motion, there is no finger to show.
    let force_n = moment.force_n.filter(|_| motion_s.is_some());
    let colour = match guidance.force(force_n) {
        Force::Unknown => "",
        Force::Below => "\x1b[33m",
        Force::Within => "\x1b[32m",
        Force::Above => "\x1b[31m",
    };
    let newtons = match moment.force_n {
        Some(force_n) => format!("{force_n:6.3} N"),
        None => " ".repeat(8),
    };
    let bars = spectrum.map_or(String::new(), |spectrum| bars(&spectrum.band_db));
    [
        format!(
            "{left_s:5.1} s  target {}  finger {colour}{}\x1b[0m",
            way(target, guidance.stroke_mm),
            way(moment.position_mm, guidance.stroke_mm)
        ),
        format!("  force {colour}{newtons}\x1b[0m  20 Hz {bars:18} 1000 Hz, {STEP_DB} dB a step"),
    ]
}

/// Draws a path with a square at a position, or without a square if the position is unknown.
fn way(at_mm: Option<f64>, stroke_mm: f64) -> String {
    let place =
        at_mm.map(|mm| ((mm / stroke_mm).clamp(0.0, 1.0) * (WAY - 1) as f64).round() as usize);
    let cell = |i: usize| if place == Some(i) { '■' } else { '·' };
    (0..WAY).map(cell).collect()
}

/// Draws a bar for the level of each band. The loudest band has the full height.
fn bars(band_db: &[f64]) -> String {
    let top_db = band_db.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let full = (BARS.len() - 1) as f64;
    let height = |db: &f64| (full - (top_db - db) / STEP_DB).clamp(0.0, full).round() as usize;
    let bar = |db: &f64| [BARS[height(db)]; BAR_WIDTH];
    band_db.iter().flat_map(bar).collect()
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
        let lines = |phase: Phase, elapsed_s: f64, force_n: f64| {
            let moment = Moment {
                phase,
                number: 1,
                elapsed_s,
                of_s: 10.0,
                force_n: Some(force_n),
                position_mm: Some(0.0),
                texture: &[],
            };
            drawn(&guidance, &moment, None)
        };
        let begin = format!("■{}", "·".repeat(WAY - 1));
        let end: String = begin.chars().rev().collect();
        let [ways, felt] = lines(Phase::Take, 0.0, 0.3);
        assert_eq!(ways, format!(" 10.0 s  target {begin}  finger \x1b[33m{begin}\x1b[0m"));
        assert!(felt.starts_with("  force \x1b[33m 0.300 N\x1b[0m "), "{felt}");
        let [ways, _] = lines(Phase::Take, 1.0, 0.4);
        assert_eq!(ways, format!("  9.0 s  target {end}  finger \x1b[32m{begin}\x1b[0m"));
        // A countdown of 10 s has 10 strokes and ends at the position where the take begins.
        let [ways, felt] = lines(Phase::Countdown, 9.0, 0.45);
        assert!(ways.contains(&end) && felt.contains("\x1b[31m"), "{ways} {felt}");
    }

    #[test]
    fn bars_fall_by_a_step_for_each_6_db() {
        assert_eq!(bars(&[-40.0, -34.0, -46.0, -200.0, -76.0]), "▇▇██▆▆  ▁▁");
    }
}
