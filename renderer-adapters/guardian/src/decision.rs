//! What the player decides about its guardian: how long it waits, when it kills, how it gets the
//! output to zero, and what it says.
//!
//! This is a state machine without clock, process or pipe. The program runs it in `src/worker.rs`;
//! the model checker (`cargo xtask prove zero`) runs the same code against a model of the guardian,
//! the helpers, the card and the signals.
//!
//! A guardian that does not answer in time gets SIGKILL, which also ends a process that is stopped.
//! Then attempts follow, one at a time, until one confirms zero: a helper process, then a thread of
//! the player itself (the helper program may be gone), then a process again. Processes come first
//! because a call of a driver that does not return takes a process with it, not the player.

use std::time::Duration;

/// Time from the detection to the first sentence, if zero is not confirmed before.
pub const CONFIRM: Duration = Duration::from_millis(500);
/// Time between two sentences.
pub const EVERY: Duration = Duration::from_millis(1_000);
/// What a request itself may take; the write of a longer wait is sent as several requests.
pub const REQUEST: Duration = Duration::from_millis(100);
/// What opening a device may take: a driver may load for seconds.
pub const OPENING: Duration = Duration::from_millis(10_000);
/// What the guardian may take beyond the request, the buffer and the ramp.
pub const GRACE: Duration = Duration::from_millis(500);
/// Longest wait for the end of a guardian that was killed: its tasks hold the output until then.
const GONE: Duration = Duration::from_millis(100);
/// Pause before an attempt is repeated, until the first sentence; after it, [`EVERY`].
const RETRY: Duration = Duration::from_millis(100);
/// Longest attempt: a driver may load for seconds.
const ATTEMPT: Duration = Duration::from_millis(5_000);

/// Longest waits for one device.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Waits {
    /// Longest time from the last sample to zero when all is well: the device's buffer and ramp.
    pub to_zero: Duration,
}

impl Waits {
    /// D: longest wait for the answer to a request.
    pub fn answer(self) -> Duration {
        self.to_zero + REQUEST + GRACE
    }

    /// Longest wait for the answer to the opening.
    pub fn opening(self) -> Duration {
        self.to_zero + OPENING + GRACE
    }

    /// Longest wait for the answer when the device is dropped: with [`CONFIRM`] after it, dropping
    /// takes at most D.
    pub fn abort(self) -> Duration {
        self.answer().saturating_sub(CONFIRM)
    }
}

/// Who makes an attempt to set the output to zero.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum By {
    /// A second helper process.
    Process,
    /// A thread of the player.
    Player,
}

/// What happens to the player.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Event {
    /// A caller sent a request and waits so long for its answer.
    Asked(Duration),
    /// The guardian answered.
    Answered,
    /// The guardian's pipe ended, or carried something that is no answer.
    PipeEnded,
    /// The guardian's process is gone.
    GuardianGone,
    /// The caller lets go of the device and waits so long for the guardian's end.
    Closing(Duration),
    /// An attempt confirmed that the output is at zero.
    Zero,
    /// The attempt of this number has ended without zero.
    Failed(u32),
    /// Time has passed.
    Tick,
}

/// What the player does then.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Action {
    /// The caller gets the guardian's answer.
    GiveAnswer,
    /// The caller gets the error that the device is closed.
    RefuseClosed,
    /// The caller gets the error that the guardian failed and that the output is at zero.
    GiveZero,
    /// The caller gets the error that the guardian failed and that the output may not be at zero.
    GiveNotZero,
    /// The pipe to the guardian is closed, which ends it.
    ClosePipe,
    /// The caller may let go.
    LetGo,
    /// The guardian gets SIGKILL.
    KillGuardian,
    /// An attempt of this number begins.
    Start(u32, By),
    /// The attempt of this number is given up; if it is a process, it gets SIGKILL.
    GiveUp(u32),
    /// The sentence "switch the amplifier off" is printed.
    Say,
    /// After such a sentence: it is printed that the output is at zero.
    SayZero,
}

/// Why the guardian was given up.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Why {
    /// Its pipe ended.
    Ended,
    /// It did not answer within this time.
    Silent(Duration),
}

/// The player's decisions.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Player {
    state: State,
    /// Number of the last attempt.
    attempt: u32,
    /// The attempt that a thread of the player still makes, which nothing can end.
    own: Option<u32>,
    last: By,
    why: Option<Why>,
}

#[derive(Debug, Clone, PartialEq, Eq, Hash)]
enum State {
    Idle,
    Waiting { since: Duration, until: Duration },
    Leaving { until: Duration },
    Rescuing(Rescue),
    Closed,
}

#[derive(Debug, Clone, PartialEq, Eq, Hash)]
struct Rescue {
    step: Step,
    /// When the next sentence is due.
    say_at: Duration,
    has_said: bool,
}

#[derive(Debug, Clone, PartialEq, Eq, Hash)]
enum Step {
    /// Waits for the end of the guardian.
    Killing {
        until: Duration,
    },
    Trying {
        attempt: u32,
        by: By,
        until: Duration,
    },
    Pausing {
        until: Duration,
    },
}

impl Default for Player {
    fn default() -> Self {
        Self { state: State::Idle, attempt: 0, own: None, last: By::Player, why: None }
    }
}

impl Player {
    /// What to do about an event; `now` is the time since any fixed moment.
    pub fn on(&mut self, event: Event, now: Duration) -> Vec<Action> {
        let mut actions = match event {
            Event::Asked(patience) => self.asked(patience, now),
            Event::Answered => self.answered(),
            Event::PipeEnded => self.pipe_ended(now),
            Event::GuardianGone => self.guardian_gone(now),
            Event::Closing(patience) => self.closing(patience, now),
            Event::Zero => self.zero(),
            Event::Failed(attempt) => self.failed(attempt, now),
            Event::Tick => Vec::new(),
        };
        actions.extend(self.due(now));
        actions
    }

    /// When [`Event::Tick`] is due, if nothing happens before.
    pub fn wakes_at(&self) -> Option<Duration> {
        match &self.state {
            State::Idle | State::Closed => None,
            State::Waiting { until, .. } | State::Leaving { until } => Some(*until),
            State::Rescuing(Rescue { step, say_at, .. }) => Some(step.until().min(*say_at)),
        }
    }

    /// Whether the end of the guardian's process matters now.
    pub fn waits_for_end(&self) -> bool {
        let is_killing = |rescue: &Rescue| matches!(rescue.step, Step::Killing { .. });
        match &self.state {
            State::Leaving { .. } => true,
            State::Rescuing(rescue) => is_killing(rescue),
            _ => false,
        }
    }

    /// Whether nothing more will be done.
    pub fn is_over(&self) -> bool {
        self.state == State::Closed
    }

    /// Why the guardian was given up, if it was.
    pub fn why(&self) -> Option<Why> {
        self.why
    }

    /// The same player by a clock that is set back. The model checker keeps its clock at one time,
    /// so that worlds that differ only in their time are one.
    pub fn set_back(&mut self, by: Duration) {
        let set_back = |time: &mut Duration| *time = time.saturating_sub(by);
        match &mut self.state {
            State::Idle | State::Closed => {}
            State::Waiting { since, until } => {
                set_back(since);
                set_back(until);
            }
            State::Leaving { until } => set_back(until),
            State::Rescuing(Rescue { step, say_at, .. }) => {
                set_back(say_at);
                let (Step::Killing { until }
                | Step::Trying { until, .. }
                | Step::Pausing { until }) = step;
                set_back(until);
            }
        }
    }

    fn asked(&mut self, patience: Duration, now: Duration) -> Vec<Action> {
        match self.state {
            State::Idle => {
                let until = now + patience;
                self.state = State::Waiting { since: now, until };
                vec![]
            }
            _ => vec![Action::RefuseClosed],
        }
    }

    fn answered(&mut self) -> Vec<Action> {
        match self.state {
            State::Waiting { .. } => {
                self.state = State::Idle;
                vec![Action::GiveAnswer]
            }
            _ => vec![],
        }
    }

    fn pipe_ended(&mut self, now: Duration) -> Vec<Action> {
        match self.state {
            State::Idle | State::Waiting { .. } => self.detected(Why::Ended, now),
            _ => vec![],
        }
    }

    fn detected(&mut self, why: Why, now: Duration) -> Vec<Action> {
        self.why = Some(why);
        self.state = State::Rescuing(Rescue {
            step: Step::Killing { until: now + GONE },
            say_at: now + CONFIRM,
            has_said: false,
        });
        vec![Action::KillGuardian]
    }

    fn guardian_gone(&mut self, now: Duration) -> Vec<Action> {
        match &mut self.state {
            State::Leaving { .. } => {
                self.state = State::Closed;
                vec![Action::LetGo]
            }
            State::Rescuing(rescue) => {
                if let Step::Killing { until } = &mut rescue.step {
                    *until = now;
                }
                vec![]
            }
            _ => vec![],
        }
    }

    fn closing(&mut self, patience: Duration, now: Duration) -> Vec<Action> {
        match self.state {
            State::Idle => {
                let until = now + patience;
                self.state = State::Leaving { until };
                vec![Action::ClosePipe]
            }
            _ => vec![Action::LetGo],
        }
    }

    fn zero(&mut self) -> Vec<Action> {
        let State::Rescuing(rescue) = &self.state else {
            return vec![];
        };
        let action = if rescue.has_said { Action::SayZero } else { Action::GiveZero };
        self.state = State::Closed;
        vec![action]
    }

    fn failed(&mut self, failed: u32, now: Duration) -> Vec<Action> {
        self.own = self.own.filter(|own| *own != failed);
        let State::Rescuing(rescue) = &mut self.state else {
            return vec![];
        };
        if let Step::Trying { attempt, .. } = rescue.step
            && attempt == failed
        {
            let pause = if rescue.has_said { EVERY } else { RETRY };
            rescue.step = Step::Pausing { until: now + pause };
        }
        vec![]
    }

    /// What is due by the time.
    fn due(&mut self, now: Duration) -> Vec<Action> {
        match &mut self.state {
            State::Waiting { since, until } if now >= *until => {
                let why = Why::Silent(*until - *since);
                self.detected(why, now)
            }
            State::Leaving { until } if now >= *until => {
                self.state = State::Closed;
                vec![Action::KillGuardian, Action::LetGo]
            }
            State::Rescuing(_) => self.rescue_due(now),
            _ => vec![],
        }
    }

    fn rescue_due(&mut self, now: Duration) -> Vec<Action> {
        let (by, number) = (self.next_by(), self.next_number());
        let State::Rescuing(rescue) = &mut self.state else {
            return vec![];
        };
        let mut actions = vec![];
        if now >= rescue.step.until() {
            if let Step::Trying { attempt, .. } = rescue.step {
                actions.push(Action::GiveUp(attempt));
            }
            self.attempt = number;
            self.last = by;
            if by == By::Player {
                self.own = Some(number);
            }
            actions.push(Action::Start(number, by));
            rescue.step = Step::Trying { attempt: number, by, until: now + ATTEMPT };
        }
        if now >= rescue.say_at {
            actions.push(Action::Say);
            if !std::mem::replace(&mut rescue.has_said, true) {
                actions.push(Action::GiveNotZero);
            }
            rescue.say_at = now + EVERY;
        }
        actions
    }

    /// A number that no attempt has which may still be heard of; they are few, so that the model is
    /// finite.
    fn next_number(&self) -> u32 {
        let is_free = |number: &u32| *number != self.attempt && Some(*number) != self.own;
        (1..=3).find(is_free).unwrap_or(1)
    }

    fn next_by(&self) -> By {
        match self.last {
            By::Process if self.own.is_none() => By::Player,
            _ => By::Process,
        }
    }
}

impl Step {
    fn until(&self) -> Duration {
        match self {
            Self::Killing { until } | Self::Trying { until, .. } | Self::Pausing { until } => {
                *until
            }
        }
    }
}
