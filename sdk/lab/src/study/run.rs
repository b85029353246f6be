//! Runs a session: plays trials, shows views and asks questions.

use std::time::Duration;

use crate::error::LabError;
use crate::study::asking::{Asker, Clock, Key, Playback, Rig, View};
use crate::study::file::{Attribute, Phase};
use crate::study::gain::{GainKey, Match};
use crate::study::lines::StopReason;
use crate::study::plan::Trial;
use crate::study::progress::Step;
use crate::study::session::{Presentation, Session};
use crate::study::simulated::SimulatedParticipant;
use crate::study::stimulus::Stimulus;

/// Time between two checks for keys while nothing plays.
const LOOK: Duration = Duration::from_millis(5);
/// How many times a stimulus is played again after the device ran out of samples. If the cause is
/// another program that takes the processor for a moment, the device seldom runs out of samples
/// three times in a row. If the cause is a buffer that is too small, it happens every time.
const MOST_REPEATS: u32 = 2;

/// How a run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SessionEnd {
    /// The session is over.
    Done,
    /// The session was interrupted before its end. A later call of [`run`] continues the session at
    /// the same step.
    Left,
}

/// Runs a session to its end, or until the participant leaves. Each answer is on disk before the
/// next trial begins.
///
/// # Errors
/// Returns the errors of the session ([`LabError`]) and the errors of the rig.
pub fn run<R: Rig>(
    session: &mut Session<'_>,
    rig: &mut R,
    asker: &mut dyn Asker,
    clock: &mut dyn Clock,
    simulated: Option<&SimulatedParticipant>,
) -> Result<SessionEnd, R::Error> {
    clock.go_on_at(session.last_ms());
    if let Some(date) = clock.date() {
        session.begin(date, clock.now_ms())?;
    }
    let mut run = Run {
        session,
        rig,
        asker,
        clock,
        simulated,
        felt: None,
        presented: Presentation::default(),
        notice: None,
    };
    loop {
        let goes_on = match run.session.step() {
            Step::Rate(phase, trial, attribute) => run.rate(phase, &trial, &attribute)?,
            Step::Match { phase, texture, model, matching } => {
                run.matching(phase, &texture, &model, &matching)?
            }
            Step::Rest { seconds, .. } => run.rest(seconds)?,
            Step::Done => {
                run.show(&View::Done);
                return Ok(SessionEnd::Done);
            }
        };
        if !goes_on {
            return Ok(SessionEnd::Left);
        }
    }
}

struct Run<'r, 's, R: Rig> {
    session: &'r mut Session<'s>,
    rig: &'r mut R,
    asker: &'r mut dyn Asker,
    clock: &'r mut dyn Clock,
    simulated: Option<&'r SimulatedParticipant>,
    /// The file name of the stimulus that was played last. The stimulus is a trial before its
    /// questions, or a texture that is being matched.
    felt: Option<(Phase, String)>,
    /// How the last trial was played.
    presented: Presentation,
    /// Notice for the next view.
    notice: Option<String>,
}

impl<R: Rig> Run<'_, '_, R> {
    fn show(&mut self, view: &View) {
        let (done, all) = self.session.trials();
        self.asker.show(view, done, all);
    }

    /// Waits for a key for which `meaning` returns a value, and returns this value. Returns `None`
    /// if the session is left.
    fn wait<T>(&mut self, mut meaning: impl FnMut(Key) -> Option<T>) -> Option<T> {
        loop {
            if self.rig.is_interrupted() {
                return None;
            }
            match self.asker.key() {
                Some(Key::Quit) => return None,
                Some(key) => {
                    if let Some(meant) = meaning(key) {
                        return Some(meant);
                    }
                }
                None => self.clock.pass(LOOK),
            }
        }
    }

    /// Waits for the key that begins a trial or a matching. Returns false if the session is left.
    fn ready(&mut self, phase: Phase, texture: &str) -> bool {
        if self.simulated.is_some() {
            return true;
        }
        let texture = texture.to_owned();
        let notice = self.notice.take();
        self.show(&View::Ready { phase, texture, notice });
        self.wait(|key| (key == Key::Go).then_some(())).is_some()
    }

    fn rate(&mut self, phase: Phase, trial: &Trial, asked: &Attribute) -> Result<bool, R::Error> {
        let stimulus = self.session.stimulus(phase, trial);
        let this = (phase, stimulus.file.clone());
        // A trial with several questions is played only once.
        if self.felt.as_ref() != Some(&this) {
            if !self.play(phase, &stimulus)? {
                return Ok(false);
            }
            self.felt = Some(this);
        }
        let Some((rating, response_ms)) = self.ask(phase, trial, asked)? else {
            return Ok(false);
        };
        let at_ms = self.clock.now_ms();
        let presented = self.presented.clone();
        self.session.rate(rating, response_ms, at_ms, presented)?;
        Ok(true)
    }

    /// Plays a trial to its end, and starts it again if the device ran out of samples. Returns
    /// false if the session is left.
    fn play(&mut self, phase: Phase, stimulus: &Stimulus) -> Result<bool, R::Error> {
        self.presented = Presentation::default();
        let mut left = false;
        let played = loop {
            if !self.ready(phase, &stimulus.texture) {
                return Ok(false);
            }
            let texture = stimulus.texture.clone();
            self.show(&View::Playing { texture });
            let mut ends = |asker: &mut dyn Asker| {
                // The result is stored, because the rig may call this function again after it was
                // told to end.
                left |= asker.key() == Some(Key::Quit);
                left
            };
            if let Some(played) = self.attempt(stimulus, &mut ends)? {
                break played;
            }
        };
        let seconds = stimulus.seconds.unwrap_or(0.0);
        self.clock.played(Duration::from_secs_f64(seconds));
        if left || self.rig.is_interrupted() {
            return self.stopped(left, played);
        }
        self.presented = Presentation {
            drive_v: played.drive_v,
            output: Some(played.output),
            stops: self.session.stops(),
            felt: played.felt,
            repeats: self.presented.repeats,
        };
        self.tell_off_target(stimulus);
        Ok(true)
    }

    /// Records that a stimulus was stopped while it played, because the session is left. Always
    /// returns false, to end the session.
    fn stopped(&mut self, left: bool, played: Playback) -> Result<bool, R::Error> {
        let reason = if left { StopReason::Left } else { StopReason::Interrupted };
        let at_ms = self.clock.now_ms();
        let Playback { drive_v, output, .. } = played;
        self.session.stopped(reason, drive_v, Some(output), at_ms)?;
        Ok(false)
    }

    /// Records that a stimulus ended with an error while it played.
    fn failed(&mut self, error: &R::Error) -> Result<(), R::Error> {
        let reason = if R::ran_dry(error) { StopReason::RanDry } else { StopReason::Failed };
        // If nothing was written to the device, this does not count as a stop.
        if let Some((drive_v, output)) = self.rig.output_before_error() {
            let at_ms = self.clock.now_ms();
            self.session.stopped(reason, drive_v, Some(output), at_ms)?;
        }
        Ok(())
    }

    /// Plays a stimulus once. Returns `None` if the device ran out of samples. The stimulus must
    /// then be played again. [`Presentation::repeats`] counts this.
    fn attempt(
        &mut self,
        stimulus: &Stimulus,
        ends: &mut dyn FnMut(&mut dyn Asker) -> bool,
    ) -> Result<Option<Playback>, R::Error> {
        let asker = &mut *self.asker;
        let error = match self.rig.play(stimulus, &mut || ends(&mut *asker)) {
            Err(error) => error,
            Ok(played) => return Ok(Some(played)),
        };
        self.failed(&error)?;
        if !R::ran_dry(&error) {
            return Err(error);
        }
        if self.presented.repeats == MOST_REPEATS {
            let (times, error) = (MOST_REPEATS + 1, error.to_string());
            return Err(LabError::RanDry { times, error }.into());
        }
        self.presented.repeats += 1;
        self.say(format!("the device ran dry, and {} is played again ({error})", stimulus.file));
        Ok(None)
    }

    /// If the motion of a trial left its target, reports how.
    fn tell_off_target(&mut self, stimulus: &Stimulus) {
        let reasons = self.presented.felt.as_ref().map(|felt| &felt.off_target);
        if let Some(reasons) = reasons.filter(|reasons| !reasons.is_empty()) {
            self.say(format!("{} was off its target: {}", stimulus.file, reasons.join("; ")));
        }
    }

    /// Shows a notice to the experimenter, and in the participant's next view.
    fn say(&mut self, notice: String) {
        self.rig.tell(&notice);
        self.notice = Some(notice);
    }

    /// Asks for a rating. Returns the rating, and the time that the participant took for it,
    /// milliseconds.
    fn ask(
        &mut self,
        phase: Phase,
        trial: &Trial,
        asked: &Attribute,
    ) -> Result<Option<(u8, u64)>, R::Error> {
        let scale = self.session.study().scale.clone();
        let notice = self.notice.take();
        if let Some(simulated) = self.simulated {
            let (texture, model) = (&trial.texture, &trial.model);
            let error_db = self.rig.band_error_db(texture, model).ok_or_else(|| {
                LabError::NoBandError { texture: texture.clone(), model: model.clone() }
            })?;
            let response_ms = simulated.response_ms(phase, trial, &asked.name);
            self.clock.pass(Duration::from_millis(response_ms));
            let rating = simulated.rating(phase, trial, &asked.name, error_db, &scale);
            return Ok(Some((rating, response_ms)));
        }
        let attribute = asked.clone();
        let range = scale.min..=scale.max;
        self.show(&View::Question { attribute, scale, notice });
        let start_ms = self.clock.now_ms();
        let rating = self.wait(|key| match key {
            Key::Digit(digit) if range.contains(&digit) => Some(digit),
            _ => None,
        });
        let took_ms = self.clock.now_ms().saturating_sub(start_ms);
        Ok(rating.map(|rating| (rating, took_ms)))
    }

    /// Plays a texture until the participant presses a key that has a meaning now, and records the
    /// key.
    fn matching(
        &mut self,
        phase: Phase,
        texture: &str,
        model: &str,
        matching: &Match,
    ) -> Result<bool, R::Error> {
        let stimulus = self.session.matching_stimulus(phase, texture, model, matching);
        let this = (phase, stimulus.file.clone());
        if self.felt.as_ref() != Some(&this) {
            if !self.ready(phase, texture) {
                return Ok(false);
            }
            self.felt = Some(this);
        }
        self.presented = Presentation::default();
        let (key, played) = match self.simulated {
            Some(simulated) => {
                let seconds = self.session.study().trial_s;
                let stimulus = Stimulus { seconds: Some(seconds), ..stimulus };
                let played = loop {
                    if let Some(played) = self.attempt(&stimulus, &mut |_| false)? {
                        break played;
                    }
                };
                self.clock.played(Duration::from_secs_f64(seconds));
                let left = self.rig.is_interrupted();
                let key = simulated.gain_key(texture, matching);
                ((!left).then_some(key), played)
            }
            None => self.felt_until_key(&stimulus, matching)?,
        };
        let Some(key) = key else {
            return self.stopped(!self.rig.is_interrupted(), played);
        };
        let at_ms = self.clock.now_ms();
        self.session.press(key, &played, at_ms)?;
        Ok(true)
    }

    fn felt_until_key(
        &mut self,
        stimulus: &Stimulus,
        matching: &Match,
    ) -> Result<(Option<GainKey>, Playback), R::Error> {
        self.show(&View::Matching {
            texture: stimulus.texture.clone(),
            method: matching.method(),
            rising: matching.is_rising(),
            gain_db: matching.gain_db(),
        });
        let (mut pressed, mut left) = (None, false);
        let mut ends = |asker: &mut dyn Asker| {
            if left || pressed.is_some() {
                return true;
            }
            match asker.key() {
                Some(Key::Quit) => left = true,
                Some(Key::Gain(key)) if matching.takes(key) => {
                    pressed.get_or_insert(key);
                }
                _ => {}
            }
            left || pressed.is_some()
        };
        // A trace may end before the participant has decided. In this case it is played again.
        let played = loop {
            let Some(played) = self.attempt(stimulus, &mut ends)? else {
                continue;
            };
            if ends(&mut *self.asker) || self.rig.is_interrupted() {
                break played;
            }
        };
        let left = left || self.rig.is_interrupted();
        Ok((pressed.filter(|_| !left), played))
    }

    fn rest(&mut self, seconds: f64) -> Result<bool, R::Error> {
        let end_ms = self.clock.now_ms() + (1e3 * seconds) as u64;
        if self.simulated.is_some() {
            self.clock.pass(Duration::from_secs_f64(seconds));
        } else if !self.rested(end_ms) {
            return Ok(false);
        }
        // The rest is recorded even after an interruption, so that it is not repeated.
        let at_ms = self.clock.now_ms();
        self.session.rested(at_ms)?;
        Ok(!self.rig.is_interrupted())
    }

    /// Counts down the rest, then waits for the key that continues. Returns false if the session is
    /// left.
    fn rested(&mut self, end_ms: u64) -> bool {
        let mut shown = None;
        loop {
            let left_ms = end_ms.saturating_sub(self.clock.now_ms());
            let seconds = left_ms.div_ceil(1000);
            if shown != Some(seconds) {
                self.show(&View::Rest { seconds });
                shown = Some(seconds);
            }
            if self.rig.is_interrupted() {
                return false;
            }
            match self.asker.key() {
                Some(Key::Quit) => return false,
                Some(Key::Go) if left_ms == 0 => return true,
                Some(_) => {}
                None => self.clock.pass(LOOK),
            }
        }
    }
}
