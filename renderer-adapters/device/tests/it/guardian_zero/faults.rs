//! The failures that may happen at any moment.

use super::world::{Driver, EVER, Helpers, Process, Thread, World};

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Fault {
    PlayerKilled,
    /// The player is stopped for this many steps, or for ever.
    PlayerStopped(u32),
    GuardianKilled,
    GuardianStopped(u32),
    /// The next answer is late by this many steps.
    GuardianSlow(u32),
    /// A driver call in the main thread does not return for this many steps, or for ever.
    MainHangs(u32),
    WatchdogHangs(u32),
    /// A driver call in the guardian fails, and the session ends.
    CallFails,
    /// The guardian cannot write zero from now on.
    GuardianZeroFails,
    /// The pipe delivers an invalid answer.
    PipeBreaks,
    /// The guardian's process survives SIGKILL for this many steps, because a kernel call cannot be
    /// interrupted.
    KillIsSlow(u32),
    /// From now on, every driver call fails in every process: the card was removed.
    CardGone,
    /// From now on, no driver call returns in any process.
    DriverHangs,
    HelperKilled,
    HelperStopped,
    HelperHangs,
    /// All helper processes from now on behave like this.
    AllHelpers(Helpers),
}

impl Fault {
    pub const ALL: [Self; 29] = [
        Self::PlayerKilled,
        Self::PlayerStopped(3),
        Self::PlayerStopped(15),
        Self::PlayerStopped(EVER),
        Self::GuardianKilled,
        Self::GuardianStopped(3),
        Self::GuardianStopped(15),
        Self::GuardianStopped(25),
        Self::GuardianStopped(EVER),
        Self::GuardianSlow(5),
        Self::GuardianSlow(25),
        Self::MainHangs(8),
        Self::MainHangs(25),
        Self::MainHangs(EVER),
        Self::WatchdogHangs(8),
        Self::WatchdogHangs(EVER),
        Self::CallFails,
        Self::GuardianZeroFails,
        Self::PipeBreaks,
        Self::KillIsSlow(6),
        Self::CardGone,
        Self::DriverHangs,
        Self::HelperKilled,
        Self::HelperStopped,
        Self::HelperHangs,
        Self::AllHelpers(Helpers::CannotStart),
        Self::AllHelpers(Helpers::Fail),
        Self::AllHelpers(Helpers::Hang),
        Self::AllHelpers(Helpers::Slow),
    ];

    /// Whether the fault prevents the player from acting for so long that the output has to wait
    /// for the player.
    pub fn is_of_player(self) -> bool {
        matches!(self, Self::PlayerKilled | Self::PlayerStopped(_))
    }

    /// Whether the fault may prevent every attempt of the player from writing zero within 0.5 s.
    pub fn prevents_zero(self) -> bool {
        matches!(
            self,
            Self::KillIsSlow(_)
                | Self::CardGone
                | Self::DriverHangs
                | Self::HelperStopped
                | Self::HelperHangs
                | Self::AllHelpers(Helpers::Hang | Helpers::Slow)
        )
    }

    /// Returns the world with this fault, or `None` if the fault cannot affect anything in this
    /// world.
    pub fn in_world(self, world: &World) -> Option<World> {
        let mut world = world.clone();
        let guardian_runs = world.guardian == Process::Running;
        let helper_runs = world.helper.last().is_some_and(|helper| {
            helper.by == htex_device::guardian::decision::By::Process
                && helper.process == Process::Running
        });
        let is_possible = match self {
            Self::PlayerKilled | Self::PlayerStopped(_) => world.runs(),
            Self::GuardianKilled => world.guardian != Process::Dead,
            Self::HelperKilled | Self::HelperStopped | Self::HelperHangs => helper_runs,
            Self::KillIsSlow(_) => world.kill_takes == 0,
            Self::CardGone | Self::DriverHangs => world.driver == Driver::Works,
            Self::AllHelpers(_) => world.helpers == Helpers::Work,
            Self::MainHangs(_) => guardian_runs && !matches!(world.main, Thread::Hung(..)),
            Self::WatchdogHangs(_) => guardian_runs && world.watchdog == Thread::Idle,
            _ => guardian_runs,
        };
        is_possible.then(|| {
            self.put_in(&mut world);
            world
        })
    }

    fn put_in(self, world: &mut World) {
        match self {
            Self::PlayerKilled => {
                world.process = Process::Dead;
                world.pipe_is_open = false;
            }
            Self::PlayerStopped(steps) => world.process = Process::Stopped(steps),
            Self::GuardianKilled => world.guardian_dies(),
            Self::GuardianStopped(steps) => world.guardian = Process::Stopped(steps),
            Self::GuardianSlow(steps) => match &mut world.main {
                Thread::Serving(_, left) => *left += steps,
                _ => world.slow = steps,
            },
            Self::MainHangs(steps) => {
                let request = match world.main {
                    Thread::Serving(request, _) => Some(request),
                    _ => world.to_guardian.pop_front(),
                };
                world.main = Thread::Hung(request, steps);
            }
            Self::WatchdogHangs(steps) => world.watchdog = Thread::Hung(None, steps),
            Self::CallFails => world.call_fails(),
            Self::GuardianZeroFails => world.guardian_zero_fails = true,
            Self::PipeBreaks => world.pipe_breaks(),
            Self::KillIsSlow(steps) => world.kill_takes = steps,
            Self::CardGone => world.driver = Driver::Fails,
            Self::DriverHangs => world.driver = Driver::Hangs,
            Self::HelperKilled => world.helper_dies(),
            Self::HelperStopped => {
                for helper in world.helper.iter_mut().rev().take(1) {
                    helper.process = Process::Stopped(EVER);
                }
            }
            Self::HelperHangs => {
                for helper in world.helper.iter_mut().rev().take(1) {
                    helper.left = EVER;
                }
            }
            Self::AllHelpers(helpers) => world.helpers = helpers,
        }
    }
}
