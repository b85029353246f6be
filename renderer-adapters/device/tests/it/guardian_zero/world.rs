//! A model of everything around the player's decisions: the app, the guardian with its two threads,
//! the helpers, and the card.
//!
//! Time advances in steps of 50 ms. All times of the program are multiples of 50 ms. The player is
//! the program's own code ([`htex_device::guardian::decision`]). The model of the other processes
//! has only what matters for the output: which process may be in a driver call that does not
//! return, which holds the session's lock, and which can still write zero.

use std::collections::VecDeque;
use std::time::Duration;

use htex_device::guardian::decision::{Action, By, Event, Player, Waits};

/// Duration of a step of the model.
pub const STEP: Duration = Duration::from_millis(50);
/// The waits for a buffer of 200 ms and a ramp of 50 ms.
pub const WAITS: Waits = Waits { to_zero: Duration::from_millis(250) };
/// Duration of the samples on the card after a write (the buffer), steps.
const BUFFER: u32 = 4;
/// Duration of a finish (the buffer and the ramp), steps.
const FINISH: u32 = 5;
/// Period of the watchdog, steps.
const WATCH: u32 = 1;
/// Time after which a waiting thread gives up on a held session (`HANG` of `htex-device-builtin`),
/// steps.
const HANG: u32 = 6;
/// Time from the start of a helper until it has opened the device, steps.
const HELPER: u32 = 2;
/// The time at which each step begins. After each step, the player's clock is set back to this
/// time.
const NOW: Duration = Duration::from_secs(60);

/// Number of steps over which the rules look back.
const LONG: u32 = 40;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Process {
    Running,
    /// Stopped (SIGSTOP) for this many steps.
    Stopped(u32),
    Dead,
}

/// Stopped for ever.
pub const EVER: u32 = u32::MAX;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Output {
    Zero,
    /// The card has samples for this many more steps.
    Playing(u32),
    /// The last voltage stays at the output.
    Standing,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Request {
    Write,
    Finish,
    Abort,
    /// The pipe has ended.
    End,
}

/// A thread of the guardian.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Thread {
    Idle,
    Serving(Request, u32),
    /// In a driver call for this many steps, with the session's lock.
    Hung(Option<Request>, u32),
}

/// How all driver calls of every process behave.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Driver {
    Works,
    Fails,
    Hangs,
}

/// How helper processes behave.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Helpers {
    Work,
    CannotStart,
    Fail,
    Hang,
    Slow,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Helper {
    pub attempt: u32,
    pub by: By,
    pub process: Process,
    /// Steps until it has opened the device.
    pub left: u32,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum App {
    Playing,
    Finishing,
    Dropping,
    Gone,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Heard {
    Answer,
    /// The answer of a guardian whose device failed, and whether it says that the output is not at
    /// zero.
    Failed(bool),
    PipeEnded,
    Zero,
    NoZero(u32),
}

/// The actions that a mutant of the player leaves out, to test that the model notices.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct Mutant {
    pub no_kill: bool,
    pub no_attempt: bool,
    pub no_sentence: bool,
    pub one_sentence: bool,
    pub no_deadline: bool,
    pub no_watchdog: bool,
}

#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct World {
    pub mutant: Mutant,
    pub player: Player,
    pub process: Process,
    pub app: App,
    /// The scene has ended, or the user has pressed Ctrl-C.
    pub ends: bool,
    /// Steps since the caller sent its request.
    pub asked: Option<u32>,
    /// Steps since the drop of the device began.
    pub dropped: Option<u32>,
    pub inbox: VecDeque<Heard>,
    pub guardian: Process,
    pub main: Thread,
    pub watchdog: Thread,
    /// Steps for which a thread has waited for the session.
    pub waited: u32,
    /// The emergency has set the output to zero without the session.
    pub emergency: bool,
    /// The session has ended.
    pub closed: bool,
    pub to_guardian: VecDeque<Request>,
    pub pipe_is_open: bool,
    /// Additional steps of the next answer.
    pub slow: u32,
    /// Duration of a kill, steps.
    pub kill_takes: u32,
    pub dies_in: Option<u32>,
    pub guardian_zero_fails: bool,
    pub driver: Driver,
    pub output: Output,
    pub helpers: Helpers,
    pub helper: Vec<Helper>,
    /// Steps since any process last printed a warning.
    pub said: Option<u32>,
    /// For how long the player has known of the failure, counted in its own running steps.
    pub known_for: Option<u32>,
    /// Steps for which a voltage has stayed.
    pub stood: u32,
    /// Number of steps, of those in `stood`, during which the player ran without a pause.
    pub stood_before_player: u32,
}

impl World {
    pub fn new(mutant: Mutant) -> Self {
        Self {
            mutant,
            player: Player::default(),
            process: Process::Running,
            app: App::Playing,
            ends: false,
            asked: None,
            dropped: None,
            inbox: VecDeque::new(),
            guardian: Process::Running,
            main: Thread::Idle,
            watchdog: Thread::Idle,
            waited: 0,
            emergency: false,
            closed: false,
            to_guardian: VecDeque::new(),
            pipe_is_open: true,
            slow: 0,
            kill_takes: 0,
            dies_in: None,
            guardian_zero_fails: false,
            driver: Driver::Works,
            output: Output::Zero,
            helpers: Helpers::Work,
            helper: Vec::new(),
            said: None,
            known_for: None,
            stood: 0,
            stood_before_player: 0,
        }
    }

    pub fn runs(&self) -> bool {
        self.process == Process::Running
    }

    /// Whether nothing more will happen.
    pub fn is_over(&self) -> bool {
        let guardian_ends = self.guardian == Process::Dead;
        let player_ends = self.process == Process::Dead
            || (self.app == App::Gone && self.player.is_over() && self.inbox.is_empty());
        guardian_ends && player_ends && self.output == Output::Zero && self.helper.is_empty()
    }

    /// Advances everything by one step, with the player either before or after the others.
    pub fn advance(&mut self, player_first: bool) {
        for age in [&mut self.asked, &mut self.dropped, &mut self.said] {
            *age = age.map(|steps| (steps + 1).min(LONG));
        }
        self.player.set_back(STEP);
        if player_first {
            self.player_step();
        }
        self.card_step();
        self.guardian_step();
        self.helpers_step();
        if !player_first {
            self.player_step();
        }
        self.stood = match self.output {
            Output::Standing => (self.stood + 1).min(LONG),
            _ => 0,
        };
        self.stood_before_player = if self.runs() && self.stood > 0 {
            (self.stood_before_player + 1).min(LONG)
        } else {
            0
        };
        if self.runs() && self.player.why().is_some() {
            self.known_for = Some(self.known_for.map_or(0, |steps| (steps + 1).min(LONG)));
        }
    }

    fn card_step(&mut self) {
        if self.guardian == Process::Dead && matches!(self.output, Output::Playing(_)) {
            self.output = Output::Standing;
        }
        self.output = match self.output {
            Output::Playing(0) => Output::Standing,
            Output::Playing(left) => Output::Playing(left - 1),
            output => output,
        };
    }

    // The guardian.

    fn guardian_step(&mut self) {
        if let Some(left) = self.dies_in {
            match left {
                0 => self.guardian_dies(),
                _ => self.dies_in = Some(left - 1),
            }
        }
        if !woken(&mut self.guardian) {
            return;
        }
        let held = self.thread_steps();
        if let Some(by_main) = held {
            if !by_main && self.main == Thread::Idle {
                // The thread takes the next request, and then waits for the session.
                self.main_step();
            }
            // The watchdog, which makes no driver call, waits for the session.
            self.waited = (self.waited + 1).min(LONG);
            let is_due = self.waited > HANG + WATCH && !self.mutant.no_watchdog;
            if is_due && !self.emergency {
                self.emergency = true;
                self.guardian_zero();
                if let (false, Thread::Serving(request, _)) = (by_main, self.main) {
                    self.main = Thread::Idle;
                    self.device_failed(request);
                }
            }
            return;
        }
        self.waited = 0;
        self.watch();
    }

    /// Advances both threads. If a thread holds the lock in a call that does not return, returns
    /// whether it is the main thread.
    fn thread_steps(&mut self) -> Option<bool> {
        if self.driver == Driver::Hangs {
            if let Thread::Serving(request, _) = self.main {
                self.main = Thread::Hung(Some(request), EVER);
            } else if self.main == Thread::Idle && self.watchdog == Thread::Idle {
                self.watchdog = Thread::Hung(None, EVER);
            }
        }
        for is_main in [true, false] {
            let thread = if is_main { &mut self.main } else { &mut self.watchdog };
            match thread {
                Thread::Hung(_, EVER) => return Some(is_main),
                Thread::Hung(request, 0) => {
                    let request = *request;
                    *thread = Thread::Idle;
                    if let Some(request) = request {
                        self.returned(request);
                    }
                }
                Thread::Hung(_, left) => {
                    *left -= 1;
                    return Some(is_main);
                }
                _ => {}
            }
        }
        self.main_step();
        None
    }

    /// Handles the return of the main thread's call.
    fn returned(&mut self, request: Request) {
        if self.emergency {
            // The session notices the emergency, and ends.
            self.device_failed(request);
        } else {
            self.main = Thread::Serving(request, 0);
        }
    }

    fn main_step(&mut self) {
        if self.main == Thread::Idle {
            let next = self
                .to_guardian
                .pop_front()
                .or_else(|| (!self.pipe_is_open).then_some(Request::End));
            if let Some(request) = next {
                let takes = match request {
                    Request::Write => 1,
                    Request::Finish | Request::End => FINISH,
                    Request::Abort => 0,
                };
                self.main = Thread::Serving(request, takes + std::mem::take(&mut self.slow));
                return;
            }
        }
        match self.main {
            Thread::Serving(request, 0) => {
                self.main = Thread::Idle;
                self.served(request);
            }
            Thread::Serving(request, left) => {
                self.main = Thread::Serving(request, left - 1);
                // While a stream is played to its end, the guardian feeds it with zeros.
                if let (Request::Finish | Request::End, Output::Playing(0)) = (request, self.output)
                {
                    self.output = Output::Zero;
                }
            }
            _ => {}
        }
    }

    fn served(&mut self, request: Request) {
        if self.driver == Driver::Fails || self.closed || self.emergency {
            return self.device_failed(request);
        }
        match request {
            Request::Write => {
                self.output = Output::Playing(BUFFER);
                self.hear(Heard::Answer);
            }
            Request::Finish | Request::Abort | Request::End => {
                self.closed = true;
                let zero = self.guardian_zero();
                match request {
                    Request::End => self.guardian_dies(),
                    // A guardian that is told to abort answers in any case, and prints its own
                    // warning.
                    Request::Abort => self.hear(Heard::Answer),
                    _ if zero => self.hear(Heard::Answer),
                    _ => self.hear(Heard::Failed(true)),
                }
            }
        }
    }

    /// Ends the session with an error, as every error does: at zero, or with the warning.
    fn device_failed(&mut self, request: Request) {
        self.closed = true;
        let not_zero = self.output != Output::Zero && !self.guardian_zero();
        match request {
            Request::End => self.guardian_dies(),
            Request::Abort => self.hear(Heard::Answer),
            _ => self.hear(Heard::Failed(not_zero)),
        }
    }

    /// Writes zero in the guardian, or prints the warning.
    fn guardian_zero(&mut self) -> bool {
        let writes = self.driver == Driver::Works && !self.guardian_zero_fails;
        if writes {
            self.output = Output::Zero;
        } else if self.driver != Driver::Hangs {
            // A call that does not return prints nothing.
            self.said = Some(0);
        }
        writes
    }

    /// The watchdog notices a buffer that ran dry.
    fn watch(&mut self) {
        let idle = self.watchdog == Thread::Idle && self.guardian == Process::Running;
        if idle && self.output == Output::Standing && !self.closed && !self.mutant.no_watchdog {
            self.closed = true;
            self.guardian_zero();
        }
    }

    pub fn guardian_dies(&mut self) {
        self.dies_in = None;
        if self.guardian != Process::Dead {
            self.guardian = Process::Dead;
            self.hear(Heard::PipeEnded);
        }
    }

    /// A driver call fails: the session ends, at zero if possible.
    pub fn call_fails(&mut self) {
        if !self.closed {
            self.closed = true;
            self.guardian_zero();
        }
    }

    /// The pipe delivers an invalid answer.
    pub fn pipe_breaks(&mut self) {
        self.hear(Heard::PipeEnded);
    }

    /// The newest helper process is killed.
    pub fn helper_dies(&mut self) {
        if let Some(helper) = self.helper.pop() {
            self.hear(Heard::NoZero(helper.attempt));
        }
    }

    fn hear(&mut self, heard: Heard) {
        self.inbox.push_back(heard);
    }

    // Helpers.

    fn helpers_step(&mut self) {
        let mut there = std::mem::take(&mut self.helper);
        for helper in &mut there {
            if !woken(&mut helper.process) {
                continue;
            }
            if helper.by == By::Player && !self.runs() {
                continue;
            }
            if helper.left > 0 && helper.left != EVER {
                helper.left -= 1;
            }
            if helper.left == 0 {
                helper.process = Process::Dead;
                self.opened(helper);
            }
        }
        there.retain(|helper| helper.process != Process::Dead);
        self.helper = there;
    }

    /// A helper has reached the driver.
    fn opened(&mut self, helper: &mut Helper) {
        let is_reserved =
            self.guardian != Process::Dead && matches!(self.output, Output::Playing(_));
        let fails = helper.by == By::Process
            && matches!(self.helpers, Helpers::Fail | Helpers::CannotStart);
        match self.driver {
            Driver::Hangs => (helper.process, helper.left) = (Process::Running, EVER),
            _ if helper.by == By::Process && self.helpers == Helpers::Hang => {
                (helper.process, helper.left) = (Process::Running, EVER);
            }
            Driver::Works if !is_reserved && !fails => {
                self.output = Output::Zero;
                self.hear(Heard::Zero);
            }
            _ => self.hear(Heard::NoZero(helper.attempt)),
        }
    }

    // The player.

    fn player_step(&mut self) {
        if !woken(&mut self.process) {
            return;
        }
        while let Some(heard) = self.inbox.pop_front() {
            match heard {
                Heard::Answer => self.tell(Event::Answered),
                Heard::Failed(not_zero) => {
                    let waits = self.asked.is_some() && self.player.why().is_none();
                    self.tell(Event::Answered);
                    if waits {
                        self.call_failed(not_zero);
                    }
                }
                Heard::PipeEnded => {
                    // The answer is read only during a request. The end of the process is noticed
                    // where the player waits for it.
                    if self.asked.is_some() {
                        self.tell(Event::PipeEnded);
                    }
                }
                Heard::Zero => self.tell(Event::Zero),
                Heard::NoZero(attempt) => self.tell(Event::Failed(attempt)),
            }
        }
        if self.player.waits_for_end() && self.guardian == Process::Dead {
            self.tell(Event::GuardianGone);
        }
        let due = self.player.wakes_at().is_some_and(|at| at <= NOW);
        if due && !(self.mutant.no_deadline && self.player.why().is_none()) {
            self.tell(Event::Tick);
        }
        self.call();
    }

    /// The app makes its next call, unless it is already in one.
    fn call(&mut self) {
        if self.asked.is_some() {
            return;
        }
        match self.app {
            App::Playing => {
                let request = if self.ends { Request::Finish } else { Request::Write };
                if self.ends {
                    self.app = App::Finishing;
                }
                self.ask(request, WAITS.answer());
            }
            App::Finishing => self.close(),
            App::Dropping | App::Gone => {}
        }
    }

    fn ask(&mut self, request: Request, patience: Duration) {
        self.asked = Some(0);
        if self.guardian == Process::Dead {
            self.tell(Event::Asked(patience));
            return self.tell(Event::PipeEnded);
        }
        if self.player.why().is_none() {
            self.to_guardian.push_back(request);
        }
        self.tell(Event::Asked(patience));
    }

    /// The app drops the device.
    fn drop_device(&mut self) {
        self.dropped = Some(0);
        self.app = App::Dropping;
        self.ask(Request::Abort, WAITS.abort());
    }

    fn close(&mut self) {
        let spent = STEP * *self.dropped.get_or_insert(0);
        self.app = App::Dropping;
        self.tell(Event::Closing(WAITS.answer().saturating_sub(spent)));
    }

    /// A call of the app has returned an error. If the error contains the warning, the program
    /// prints it.
    fn call_failed(&mut self, not_zero: bool) {
        self.asked = None;
        if not_zero {
            self.said = Some(0);
        }
        match self.app {
            App::Playing => self.drop_device(),
            App::Finishing | App::Dropping => self.close(),
            App::Gone => {}
        }
    }

    fn tell(&mut self, event: Event) {
        let actions = self.player.on(event, NOW);
        for action in actions {
            self.act(action);
        }
    }

    fn act(&mut self, action: Action) {
        match action {
            Action::GiveAnswer => match self.app {
                App::Dropping => {
                    self.asked = None;
                    self.close();
                }
                _ => self.asked = None,
            },
            Action::RefuseClosed => match self.app {
                App::Dropping => {
                    self.asked = None;
                    self.close();
                }
                _ => self.call_failed(false),
            },
            Action::GiveZero | Action::GiveNotZero if self.asked.is_some() => {
                self.call_failed(false);
            }
            Action::GiveZero | Action::GiveNotZero | Action::SayZero => {}
            Action::ClosePipe => self.pipe_is_open = false,
            Action::LetGo => self.app = App::Gone,
            Action::KillGuardian => {
                self.pipe_is_open = false;
                if !self.mutant.no_kill && self.guardian != Process::Dead {
                    self.dies_in = Some(self.kill_takes);
                    if self.kill_takes == 0 {
                        self.guardian_dies();
                    }
                }
            }
            Action::Start(attempt, by) if !self.mutant.no_attempt => self.start(attempt, by),
            Action::Start(..) => {}
            Action::GiveUp(attempt) => {
                let is_kept = |h: &Helper| h.attempt != attempt || h.by == By::Player;
                self.helper.retain(is_kept);
            }
            Action::Say if self.mutant.no_sentence => {}
            Action::Say if self.mutant.one_sentence && self.said.is_some() => {}
            Action::Say => self.said = Some(0),
        }
    }

    fn start(&mut self, attempt: u32, by: By) {
        let left = match (by, self.helpers) {
            (By::Process, Helpers::CannotStart) => 0,
            (By::Process, Helpers::Slow) => 6 * HELPER,
            _ => HELPER,
        };
        self.helper.push(Helper { attempt, by, process: Process::Running, left });
    }
}

/// Whether a process runs in this step. A process that was stopped for a while resumes.
fn woken(process: &mut Process) -> bool {
    match process {
        Process::Running => true,
        Process::Stopped(0) => {
            *process = Process::Running;
            true
        }
        Process::Stopped(EVER) | Process::Dead => false,
        Process::Stopped(left) => {
            *left -= 1;
            false
        }
    }
}
