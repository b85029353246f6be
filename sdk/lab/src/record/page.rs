//! Shows the guidance on a web page ([`crate::page`]). The recording thread stores the newest state
//! of the session, and the page requests this state.

use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use htex_format::Quantity;
use serde::Serialize;
use serde_json::{Value, json};

use crate::error::LabError;
use crate::page::{Content, LocalPage};
use crate::record::coverage::Requirements;
use crate::record::files::Outcome;
use crate::record::finish::TakeReport;
use crate::record::guide::{Force, Guidance, Moment, Phase};
use crate::record::judge::MeanRange;
use crate::record::live::{LiveSignal, LiveSpectrum};
use crate::record::setup::{Setup, Tare};
use crate::record::stored::kept_spectrum;

/// Until the next state arrives, the page extrapolates the motion, but at most for this time,
/// seconds.
const CONTINUED_S: f64 = 0.1;
/// The upper end of the spectrum's scale is a multiple of this step, decibels.
const SCALE_STEP_DB: f64 = 10.0;
/// Lowest value of the scale's upper end, decibels. Sensors cannot measure anything below it.
const LOWEST_TOP_DB: f64 = -100.0;
/// Rate at which the scale follows a falling spectrum, dB/s.
const SCALE_FALL_DB_S: f64 = 5.0;

/// The page of a recording session, served as long as this value lives.
pub struct GuidePage {
    shown: Arc<SharedState>,
    served: LocalPage,
}

/// What the page shows, shared by the server's thread and the recording thread.
struct SharedState {
    session: About,
    guidance: Guidance,
    folder: PathBuf,
    state: Mutex<State>,
}

/// The facts that do not change during a session.
#[derive(Serialize)]
struct About {
    title: String,
    attempts: u32,
    required: Requirements,
    has_tare: bool,
    unit: &'static str,
    speed_mm_s: Option<f64>,
    stroke_mm: f64,
    target_force_n: Option<f64>,
    force_range_n: Option<[f64; 2]>,
    #[serde(skip)]
    quantity: Quantity,
}

struct State {
    has_started: bool,
    is_stopped: bool,
    now: Option<Now>,
    signal: LiveSignal,
    /// Spectrum of the last accepted take, decibels.
    kept_db: Option<Vec<f64>>,
    scale: Scale,
    takes: Vec<TakeLine>,
    end: Option<End>,
    is_end_shown: bool,
}

/// A moment and its time.
#[derive(Clone, Copy)]
struct Now {
    phase: Phase,
    number: u32,
    elapsed_s: f64,
    of_s: f64,
    force_n: Option<f64>,
    position_mm: Option<f64>,
    at: Instant,
}

/// The upper end of the spectrum's scale.
#[derive(Clone, Copy)]
struct Scale {
    top_db: f64,
    at: Instant,
}

/// A completed take.
#[derive(Clone, Serialize)]
struct TakeLine {
    number: u32,
    outcome: Outcome,
    reasons: Vec<String>,
    /// Problems of the signals.
    findings: Vec<String>,
    speed_mm_s: Option<MeanRange>,
    force_n: Option<MeanRange>,
}

/// The end of a session.
#[derive(Clone, Serialize)]
struct End {
    is_kept: bool,
    text: String,
}

/// The changing state, in the form that the page receives.
#[derive(Serialize)]
struct Changing {
    /// `start`, a [`Phase`] or `end`.
    phase: &'static str,
    number: u32,
    elapsed_s: f64,
    of_s: f64,
    /// Time since the take began, seconds; negative during the countdown.
    motion_s: Option<f64>,
    position_mm: Option<f64>,
    force_n: Option<f64>,
    force: Force,
    frequency_hz: Vec<f64>,
    level_db: Vec<f64>,
}

impl GuidePage {
    /// Serves the page of a session on this machine. Port 0 means any free port. `rate_hz` is the
    /// source's sample rate.
    ///
    /// # Errors
    /// Returns [`LabError::Page`] if the port is taken or the system provides no random numbers.
    pub fn open(
        port: u16,
        setup: &Setup,
        guidance: Guidance,
        rate_hz: f64,
    ) -> Result<Self, LabError> {
        let session = About {
            title: setup.name.clone(),
            attempts: setup.attempts,
            required: setup.required,
            has_tare: setup.tare != Tare::Never,
            unit: setup.quantity.unit(),
            speed_mm_s: guidance.speed_mm_s,
            stroke_mm: guidance.stroke_mm,
            target_force_n: guidance.force_n,
            force_range_n: guidance.force_range_n(),
            quantity: setup.quantity,
        };
        let kept = kept_spectrum(&setup.folder, &setup.name, setup.quantity);
        let shown = Arc::new(SharedState {
            session,
            guidance,
            folder: setup.folder.clone(),
            state: Mutex::new(State {
                has_started: false,
                is_stopped: false,
                now: None,
                signal: LiveSignal::new(setup.quantity, rate_hz),
                kept_db: kept.map(|kept| kept.level_db),
                scale: Scale { top_db: f64::NEG_INFINITY, at: Instant::now() },
                takes: Vec::new(),
                end: None,
                is_end_shown: false,
            }),
        });
        let served = LocalPage::open(port, Arc::clone(&shown))?;
        Ok(Self { shown, served })
    }

    #[must_use]
    pub fn address(&self) -> String {
        self.served.address()
    }

    /// Returns whether the user has started the session.
    #[must_use]
    pub fn has_started(&self) -> bool {
        self.shown.lock().has_started
    }

    /// Returns whether the user has ended the session.
    #[must_use]
    pub fn is_stopped(&self) -> bool {
        self.shown.lock().is_stopped
    }

    /// Stores the newest state of the session.
    pub fn show(&self, moment: &Moment<'_>) {
        let mut state = self.shown.lock();
        let before = state.now.map(|now| (now.phase, now.number));
        // A spectrum must not mix the samples of two phases.
        if before != Some((moment.phase, moment.number)) {
            state.signal.clear();
        }
        state.signal.push(moment.texture);
        state.now = Some(Now {
            phase: moment.phase,
            number: moment.number,
            elapsed_s: moment.elapsed_s,
            of_s: moment.of_s,
            force_n: moment.force_n,
            position_mm: moment.position_mm,
            at: Instant::now(),
        });
    }

    /// Shows a completed take.
    pub fn told(&self, take: &TakeReport) {
        let about = &self.shown.session;
        // The spectrum is read before the lock is taken, because otherwise the recording would wait
        // for the lock.
        let kept = match take.outcome {
            Outcome::Kept => kept_spectrum(&self.shown.folder, &about.title, about.quantity),
            Outcome::Rejected | Outcome::Incomplete => None,
        };
        let mut state = self.shown.lock();
        if let Some(kept) = kept {
            state.kept_db = Some(kept.level_db);
        }
        state.takes.push(TakeLine {
            number: take.number,
            outcome: take.outcome,
            reasons: take.verdict.reasons.clone(),
            findings: take.verdict.findings.clone(),
            speed_mm_s: take.verdict.speed_mm_s,
            force_n: take.verdict.force_n,
        });
    }

    /// Shows the end of the session. If the page is open in a browser, waits until the page has
    /// received the result of the session.
    pub fn end(&self, recorded: &Result<TakeReport, LabError>) {
        self.shown.lock().end = Some(match recorded {
            Ok(take) => End { is_kept: true, text: take.file.display().to_string() },
            Err(error) => End { is_kept: false, text: error.to_string() },
        });
        self.served.wait_for_end(|| self.shown.lock().is_end_shown);
    }
}

impl SharedState {
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn changing(
        &self,
        now: Option<Now>,
        has_ended: bool,
        spectrum: Option<LiveSpectrum>,
    ) -> Changing {
        let spectrum = spectrum.map(|spectrum| (spectrum.frequency_hz, spectrum.level_db));
        let (frequency_hz, level_db) = spectrum.unwrap_or_default();
        let elapsed_s = now.map_or(0.0, |now| {
            let since_s = now.at.elapsed().as_secs_f64().min(CONTINUED_S);
            (now.elapsed_s + since_s).min(now.of_s)
        });
        let motion_s = now.and_then(|now| now.phase.motion_s(elapsed_s, now.of_s));
        let force_n = now.and_then(|now| now.force_n);
        Changing {
            phase: match now {
                _ if has_ended => "end",
                None => "start",
                Some(now) => now.phase.name(),
            },
            number: now.map_or(0, |now| now.number),
            elapsed_s,
            of_s: now.map_or(0.0, |now| now.of_s),
            motion_s,
            position_mm: now.and_then(|now| now.position_mm),
            force_n,
            // In a phase without motion, the finger is not on the surface, so the force is not
            // compared.
            force: self.guidance.force(force_n.filter(|_| motion_s.is_some())),
            frequency_hz,
            level_db: level_db.iter().copied().map(hundredths).collect(),
        }
    }
}

impl Content for SharedState {
    const HTML: &'static str = include_str!("page.html");
    const REQUESTS: &'static [&'static str] = &["start"];

    fn handle(&self, request: &str, _: &Value) {
        let mut state = self.lock();
        match request {
            "start" => state.has_started = true,
            _ => state.is_stopped = true,
        }
    }

    fn state(&self) -> Value {
        let (now, signal, has_ended) = {
            let mut state = self.lock();
            state.is_end_shown = state.end.is_some();
            (state.now, state.signal.clone(), state.end.is_some())
        };
        // The spectrum is computed after the lock is released, so that the recording does not wait
        // for it.
        let spectrum = signal.spectrum();
        let changing = self.changing(now, has_ended, spectrum);
        let mut state = self.lock();
        let highest = changing.level_db.iter().chain(state.kept_db.iter().flatten());
        let highest_db = highest.copied().fold(f64::NEG_INFINITY, f64::max);
        let top_db = state.scale.follow(highest_db);
        json!({
            "session": self.session,
            "now": changing,
            "top_db": top_db,
            "kept_db": state.kept_db.as_ref().map(|kept| kept.iter().copied().map(hundredths).collect::<Vec<_>>()),
            "has_started": state.has_started,
            "is_stopped": state.is_stopped,
            "takes": state.takes,
            "end": state.end,
        })
    }
}

impl Scale {
    /// Returns the upper end of the scale, a multiple of 10 dB. It rises with the spectrum at once
    /// and falls slowly. Returns `None` as long as there is no spectrum.
    fn follow(&mut self, highest_db: f64) -> Option<f64> {
        let fallen_db = self.top_db - SCALE_FALL_DB_S * self.at.elapsed().as_secs_f64();
        *self = Self { top_db: fallen_db.max(highest_db), at: Instant::now() };
        let top_db = SCALE_STEP_DB * (self.top_db / SCALE_STEP_DB).ceil();
        top_db.is_finite().then_some(top_db.max(LOWEST_TOP_DB))
    }
}

fn hundredths(value: f64) -> f64 {
    (100.0 * value).round() / 100.0
}
