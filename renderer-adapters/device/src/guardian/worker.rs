//! The player's thread that talks to the guardian and executes the actions of
//! [`crate::guardian::decision`].
//!
//! This thread never blocks. A pipe, an attempt to set the output to zero, and standard error may
//! all hang, so each of them has its own thread.

use std::io::Write;
use std::process::Child;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::{Builder, sleep};
use std::time::{Duration, Instant};

use crate::DeviceError;

use crate::guardian::attempt::{Attempt, Display};
use crate::guardian::decision::{Action, Event, Player, Why};
use crate::guardian::message::{Answer, put, read_message};

/// The warning about a voltage that may remain at the display.
pub const NOT_ZERO: &str = "the output could not be set to zero: switch the amplifier off";
/// Polling interval for the clock and for the end of the guardian.
const LOOK: Duration = Duration::from_millis(5);

/// Number of outputs that are not confirmed to be at zero.
static UNCONFIRMED: AtomicUsize = AtomicUsize::new(0);

/// Whether the output of a display may have kept a voltage after its guardian failed. While this is
/// true, a thread keeps trying to set the output to zero, and prints every second that the
/// amplifier must be switched off. A program should not exit as long as this is true, because its
/// exit would end the thread.
pub fn is_unconfirmed() -> bool {
    UNCONFIRMED.load(Ordering::SeqCst) > 0
}

/// A message to the worker.
pub(crate) enum Message {
    Ask {
        tag: u8,
        body: Vec<u8>,
        patience: Duration,
        reply: Sender<Reply>,
    },
    Close {
        patience: Duration,
        reply: Sender<()>,
    },
    /// The guardian's answer, or an error of its pipe.
    Heard(std::io::Result<Answer>),
    Attempted(u32, Result<(), String>),
    /// Some time has passed.
    Look,
}

/// The reply to a caller.
pub(crate) enum Reply {
    Answer(Answer),
    Closed,
    Failed(DeviceError),
}

pub(crate) struct Worker {
    display: Arc<Display>,
    guardian: Child,
    player: Player,
    begun: Instant,
    to_self: Sender<Message>,
    messages: Receiver<Message>,
    /// Sends requests to the pipe; `None` when the pipe is closed.
    requests: Option<Sender<(u8, Vec<u8>)>>,
    asker: Option<Sender<Reply>>,
    closer: Option<Sender<()>>,
    answer: Option<Answer>,
    attempts: Vec<(u32, Attempt)>,
    /// Why the last attempt failed.
    failure: Option<String>,
    printer: Option<Sender<String>>,
    is_unconfirmed: bool,
}

impl Worker {
    /// Starts the guardian, and the threads that talk to it.
    pub(crate) fn start(display: Display) -> std::io::Result<Sender<Message>> {
        let (to_self, messages) = channel();
        let (requests, asked) = channel::<(u8, Vec<u8>)>();
        let mut guardian = display.start()?;
        let pipes = guardian.stdin.take().zip(guardian.stdout.take());
        let heard = to_self.clone();
        let converse = move || {
            let Some((mut to, mut from)) = pipes else {
                return;
            };
            for (tag, body) in asked {
                let answer = converse(&mut to, &mut from, tag, &body);
                let goes_on = answer.is_ok();
                if heard.send(Message::Heard(answer)).is_err() || !goes_on {
                    return;
                }
            }
        };
        thread("htex-guardian-pipe", converse)?;
        let worker = Self {
            display: Arc::new(display),
            guardian,
            player: Player::default(),
            begun: Instant::now(),
            to_self: to_self.clone(),
            messages,
            requests: Some(requests),
            asker: None,
            closer: None,
            answer: None,
            attempts: Vec::new(),
            failure: None,
            printer: None,
            is_unconfirmed: false,
        };
        let looks = to_self.clone();
        // Sleeps instead of waiting with a timeout, because the end of a timeout is computed by a
        // clock that may jump.
        let look = move || {
            while looks.send(Message::Look).is_ok() {
                sleep(LOOK);
            }
        };
        thread("htex-guardian-clock", look)?;
        thread("htex-guardian", move || worker.run())?;
        Ok(to_self)
    }

    fn run(mut self) {
        let mut was_closed = false;
        while !(was_closed && self.player.is_over()) {
            let Ok(message) = self.messages.recv() else {
                return;
            };
            was_closed |= matches!(message, Message::Close { .. });
            let event = self.event(message);
            let now = self.begun.elapsed();
            for action in self.player.on(event, now) {
                self.act(action);
            }
        }
    }

    fn has_ended(&mut self) -> bool {
        self.player.waits_for_end() && !matches!(self.guardian.try_wait(), Ok(None))
    }

    fn event(&mut self, message: Message) -> Event {
        match message {
            Message::Ask { tag, body, patience, reply } => {
                self.asker = Some(reply);
                let requests = self.requests.as_ref();
                let sent = requests.is_some_and(|requests| requests.send((tag, body)).is_ok());
                if !sent {
                    // The next message says that the pipe has ended.
                    let ended = std::io::ErrorKind::BrokenPipe.into();
                    let _ = self.to_self.send(Message::Heard(Err(ended)));
                }
                Event::Asked(patience)
            }
            Message::Close { patience, reply } => {
                self.closer = Some(reply);
                Event::Closing(patience)
            }
            Message::Heard(Ok(answer)) => {
                self.answer = Some(answer);
                Event::Answered
            }
            Message::Heard(Err(_)) => Event::PipeEnded,
            Message::Look if self.has_ended() => Event::GuardianGone,
            Message::Look => Event::Tick,
            Message::Attempted(_, Ok(())) => Event::Zero,
            Message::Attempted(attempt, Err(failure)) => {
                self.failure = Some(failure);
                Event::Failed(attempt)
            }
        }
    }

    fn act(&mut self, action: Action) {
        match action {
            Action::GiveAnswer => {
                let answer = self.answer.take().map_or(Reply::Closed, Reply::Answer);
                self.reply(answer);
            }
            Action::RefuseClosed => self.reply(Reply::Closed),
            Action::GiveZero => self.reply_failed("; the output was set to zero"),
            Action::GiveNotZero => self.reply_failed(&format!(", and {NOT_ZERO}")),
            Action::ClosePipe => self.requests = None,
            Action::LetGo => drop(self.closer.take().map(|closer| closer.send(()))),
            Action::KillGuardian => {
                self.requests = None;
                let _ = self.guardian.kill();
            }
            Action::Start(attempt, by) => {
                let to = self.to_self.clone();
                let tell = move |result| drop(to.send(Message::Attempted(attempt, result)));
                let running = Attempt::start(&self.display, by, tell);
                self.attempts.retain(|(number, _)| *number != attempt);
                self.attempts.push((attempt, running));
            }
            Action::GiveUp(attempt) => {
                let given_up = self.attempts.iter().find(|(number, _)| *number == attempt);
                if let Some((_, attempt)) = given_up {
                    attempt.kill();
                }
            }
            Action::Say => {
                self.set_unconfirmed(true);
                self.say(NOT_ZERO);
            }
            Action::SayZero => {
                self.say("the output was set to zero");
                self.set_unconfirmed(false);
            }
        }
    }

    fn reply(&mut self, reply: Reply) {
        if let Some(asker) = self.asker.take() {
            let _ = asker.send(reply);
        }
    }

    fn reply_failed(&mut self, end: &str) {
        let why = match self.player.why() {
            Some(Why::Silent(waited)) => format!(
                "the process that held the output did not answer within {:.2} s and was ended",
                waited.as_secs_f64()
            ),
            _ => "the process that held the output has ended".to_owned(),
        };
        let failure = self.failure.as_ref().filter(|_| !self.player.is_over());
        let failure = failure.map_or(String::new(), |failure| format!(" ({failure})"));
        let error = DeviceError::Message(format!("{why}{end}{failure}"));
        self.reply(Reply::Failed(error));
    }

    fn set_unconfirmed(&mut self, is_unconfirmed: bool) {
        match (self.is_unconfirmed, is_unconfirmed) {
            (false, true) => drop(UNCONFIRMED.fetch_add(1, Ordering::SeqCst)),
            (true, false) => drop(UNCONFIRMED.fetch_sub(1, Ordering::SeqCst)),
            _ => {}
        }
        self.is_unconfirmed = is_unconfirmed;
    }

    /// Prints on standard error, which may be closed, or be a pipe that nobody reads.
    fn say(&mut self, sentence: &str) {
        let printer = self.printer.get_or_insert_with(|| {
            let (to, sentences) = channel::<String>();
            let print = move || sentences.iter().for_each(|line| print(&line));
            let _ = thread("htex-guardian-says", print);
            to
        });
        if printer.send(sentence.to_owned()).is_err() {
            print(sentence);
        }
    }
}

fn print(sentence: &str) {
    let _ = writeln!(std::io::stderr(), "htex: {sentence}");
}

/// Starts a thread that nothing waits for.
pub(crate) fn thread(name: &str, run: impl FnOnce() + Send + 'static) -> std::io::Result<()> {
    Builder::new().name(name.to_owned()).spawn(run).map(drop)
}

/// Sends a request and waits for the answer, however long that takes.
pub(crate) fn converse(
    to: &mut impl Write,
    from: &mut impl std::io::Read,
    tag: u8,
    body: &[u8],
) -> std::io::Result<Answer> {
    put(to, tag, body)?;
    let (_, body) = read_message(from)?;
    Ok(serde_json::from_slice(&body)?)
}
