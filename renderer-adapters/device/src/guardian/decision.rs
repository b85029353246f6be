//! The decisions of the player (the app's process) about its guardian (the process that holds the
//! device). The player decides how long to wait for the guardian, when to kill it, how to set the
//! output to zero, and what to print.
//!
//! This module is a state machine without a clock, process or pipe. The program runs the state
//! machine in `worker.rs`. The model checker (`cargo xtask prove zero`) runs the same code against
//! a model of the guardian, the helpers, the card and the signals.
//!
//! If a guardian does not answer in time, the player sends it SIGKILL, because SIGKILL ends even a
//! stopped process. The player then attempts to set the output to zero, again and again until an
//! attempt succeeds. A helper process makes the first attempt, because a driver call that does not
//! return then blocks only the helper process, not the player. A thread of the player makes the
//! second attempt, because the helper program may be missing. After that, helper process and thread
//! alternate.

use std::time::Duration;

/// Time from detecting the guardian's failure to the first printed warning. If the output is
/// confirmed to be at zero within this time, no warning is printed.
pub const CONFIRM: Duration = Duration::from_millis(500);
/// Time between two printed warnings.
pub const EVERY: Duration = Duration::from_millis(1_000);
/// Longest time for a single request. This time does not include the wait for the buffer and the
/// ramp. A write with a longer timeout is sent as several requests.
pub const REQUEST: Duration = Duration::from_millis(100);
/// Longest time for opening a device; it is longer than the time for a request, because a driver
/// may take seconds to load.
pub const OPENING: Duration = Duration::from_millis(10_000);
/// Time that the player waits for an answer in addition to the times of the request, the buffer and
/// the ramp.
pub const GRACE: Duration = Duration::from_millis(500);
/// Longest wait for a killed guardian to end. Its tasks hold the output until then.
const GONE: Duration = Duration::from_millis(100);
/// Pause before the next attempt, until the first warning is printed. After the warning, the pause
/// is [`EVERY`].
const RETRY: Duration = Duration::from_millis(100);
/// Longest duration of an attempt, because a driver may take seconds to load.
const ATTEMPT: Duration = Duration::from_millis(5_000);

/// The longest times for which the player waits, for one device.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Waits {
    /// Longest time from writing the last sample until the output is at zero, if nothing fails.
    /// This time is the duration of the device's buffer and ramp.
    pub to_zero: Duration,
}

impl Waits {
    /// Returns the longest wait for the answer to a request. The documentation calls this time D.
    pub fn answer(self) -> Duration {
        self.to_zero + REQUEST + GRACE
    }

    /// Returns the longest wait for the answer to the opening request.
    pub fn opening(self) -> Duration {
        self.to_zero + OPENING + GRACE
    }

    /// Returns the longest wait for the answer when the device is dropped. After this wait, the
    /// player may wait for [`CONFIRM`]. Both waits together are at most as long as
    /// [`Self::answer`].
    pub fn abort(self) -> Duration {
        self.answer().saturating_sub(CONFIRM)
    }
}

/// Who makes an attempt to set the output to zero: a process or a thread.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum By {
    /// A second helper process.
    Process,
    /// A thread of the player.
    Player,
}

/// An event that the player reacts to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Event {
    /// A caller sent a request. The player waits at most this time for the answer.
    Asked(Duration),
    /// The guardian answered.
    Answered,
    /// The guardian's pipe ended, or carried an invalid answer.
    PipeEnded,
    /// The guardian's process is gone.
    GuardianGone,
    /// The caller drops the device. The player waits at most this time for the guardian to end.
    Closing(Duration),
    /// An attempt confirmed that the output is at zero.
    Zero,
    /// The attempt with this number has ended without reaching zero.
    Failed(u32),
    /// Time has passed.
    Tick,
}

/// An action of the player.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Action {
    /// Give the guardian's answer to the caller.
    GiveAnswer,
    /// Give the caller the error that the device is closed.
    RefuseClosed,
    /// Give the caller the error that the guardian failed and that the output is at zero.
    GiveZero,
    /// Give the caller the error that the guardian failed and that the output may not be at zero.
    GiveNotZero,
    /// Close the pipe to the guardian, so that the guardian ends.
    ClosePipe,
    /// Let the caller drop the device.
    LetGo,
    /// Send SIGKILL to the guardian.
    KillGuardian,
    /// Start the attempt with this number.
    Start(u32, By),
    /// Give up the attempt with this number. If a process makes the attempt, send SIGKILL to this
    /// process.
    GiveUp(u32),
    /// Print the warning "switch the amplifier off".
    Say,
    /// Print that the output is at zero. This message follows a warning "switch the amplifier off".
    SayZero,
}

/// The reason why the player gave up on the guardian.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Why {
    /// The guardian's pipe ended.
    Ended,
    /// The guardian did not answer within this time.
    Silent(Duration),
}

/// The player's decisions as a state machine.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Player {
    state: State,
    /// Number of the last attempt.
    attempt: u32,
    /// Number of the attempt that a thread of the player is still making. Nothing can end this
    /// thread.
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
    /// When the next warning is due.
    say_at: Duration,
    has_said: bool,
}

#[derive(Debug, Clone, PartialEq, Eq, Hash)]
enum Step {
    /// Waits for the guardian's process to end.
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
        // `last` is `Player` so that a process makes the first attempt.
        Self { state: State::Idle, attempt: 0, own: None, last: By::Player, why: None }
    }
}

impl Player {
    /// Returns the actions for an event. `now` is the current time since some fixed moment, which
    /// must be the same in all calls.
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
        // Every event brings the time, so a deadline does not depend only on ticks.
        actions.extend(self.due(now));
        actions
    }

    /// Returns the time at which [`Event::Tick`] is due if no other event comes earlier.
    pub fn wakes_at(&self) -> Option<Duration> {
        match &self.state {
            State::Idle | State::Closed => None,
            State::Waiting { until, .. } | State::Leaving { until } => Some(*until),
            State::Rescuing(Rescue { step, say_at, .. }) => Some(step.until().min(*say_at)),
        }
    }

    /// Whether the player currently waits for the guardian's process to end.
    pub fn waits_for_end(&self) -> bool {
        let is_killing = |rescue: &Rescue| matches!(rescue.step, Step::Killing { .. });
        match &self.state {
            State::Leaving { .. } => true,
            State::Rescuing(rescue) => is_killing(rescue),
            _ => false,
        }
    }

    /// Whether the player has finished and will return no more actions.
    pub fn is_over(&self) -> bool {
        self.state == State::Closed
    }

    /// Returns the reason why the player gave up on the guardian, or `None` if it did not give up.
    pub fn why(&self) -> Option<Why> {
        self.why
    }

    /// Subtracts `by` from all times of the player. At each step, the model checker calls this
    /// function instead of advancing the clock. States that differ only in their time then compare
    /// equal.
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
                    // The guardian no longer holds the output, so the first attempt may begin at
                    // once.
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
            // The worker's thread continues a rescue without the caller.
            _ => vec![Action::LetGo],
        }
    }

    fn zero(&mut self) -> Vec<Action> {
        let State::Rescuing(rescue) = &self.state else {
            return vec![];
        };
        // After a warning, the caller already has its error. So the news that the output is at zero
        // is printed.
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

    /// Returns the actions that are due at this time.
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
            // Nothing can end a thread, so its number stays in use until it reports.
            if by == By::Player {
                self.own = Some(number);
            }
            actions.push(Action::Start(number, by));
            rescue.step = Step::Trying { attempt: number, by, until: now + ATTEMPT };
        }
        if now >= rescue.say_at {
            actions.push(Action::Say);
            // The caller waits for one answer. Later warnings are only printed.
            if !std::mem::replace(&mut rescue.has_said, true) {
                actions.push(Action::GiveNotZero);
            }
            rescue.say_at = now + EVERY;
        }
        actions
    }

    /// Returns a number for the next attempt, different from the number of any attempt that may
    /// still report a result. Only three numbers are used in turn, so that the model stays finite.
    fn next_number(&self) -> u32 {
        let is_free = |number: &u32| *number != self.attempt && Some(*number) != self.own;
        (1..=3).find(is_free).unwrap_or(1)
    }

    fn next_by(&self) -> By {
        match self.last {
            // No second thread starts while the first one may still hang.
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
