//! `cargo xtask prove zero`: tries every single and double failure of the player, its guardian, the
//! helpers and the card, at every step.
//!
//! A world is a state of all processes and the card. [`broken`] states the rules that must hold in
//! every world. Ordinary tests try every single failure. With `HTEX_WHOLE`, they also try the
//! double failures.

mod faults;
mod world;

use std::collections::{BTreeMap, HashSet};
use std::hash::{BuildHasherDefault, Hash, Hasher};
use std::time::Duration;

use faults::Fault;
use htex_device::guardian::decision::{CONFIRM, EVERY};
use world::{App, Driver, Mutant, Output, Process, STEP, WAITS, World};

/// The part of a world's failures that the rules need. Worlds with the same part count as one
/// world.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
struct Failures {
    count: usize,
    /// Whether the player was stopped for a while, so that its own time limits do not apply.
    player_stopped: bool,
    /// Whether a helper, the driver or the kernel may prevent every attempt from writing zero in
    /// time.
    zero_prevented: bool,
}

impl Failures {
    fn with(self, fault: Fault) -> Self {
        Self {
            count: self.count + 1,
            player_stopped: self.player_stopped || fault.is_of_player(),
            zero_prevented: self.zero_prevented || fault.prevents_zero(),
        }
    }
}

/// What led to a world: failures and Ctrl-C, each with its step.
type Trace = [Option<(u32, Cause)>; 3];

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Cause {
    /// The scene's end or Ctrl-C. This is not a failure, and may come in addition to two failures.
    End,
    Failure(Fault),
}

#[derive(Debug, Default)]
struct Explored {
    seen: Seen,
    /// Number of worlds in which neither the player nor the guardian can act and a voltage stays.
    nobody: u64,
    /// Number of worlds in which all processes have ended and the output is at zero.
    at_zero: u64,
    /// Number of worlds in which all processes have ended with the warning, and the output is not
    /// at zero.
    said: u64,
    detected: u64,
    broken: BTreeMap<&'static str, Trace>,
}

fn and(mut trace: Trace, step: u32, cause: Cause) -> Trace {
    if let Some(free) = trace.iter_mut().find(|cause| cause.is_none()) {
        *free = Some((step, cause));
    }
    trace
}

/// A hash of small numbers, several times faster than the standard library's.
#[derive(Default)]
struct Quick(u64);

impl Hasher for Quick {
    fn write(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.write_u64(u64::from(*byte));
        }
    }

    fn write_u32(&mut self, number: u32) {
        self.write_u64(u64::from(number));
    }

    fn write_u64(&mut self, number: u64) {
        self.0 = (self.0.rotate_left(5) ^ number).wrapping_mul(0x517c_c1b7_2722_0a95);
    }

    fn write_usize(&mut self, number: usize) {
        self.write_u64(number as u64);
    }

    fn finish(&self) -> u64 {
        self.0.rotate_left(26)
    }
}

/// Returns the fingerprint of a world, made of two 64-bit hashes.
fn print_of(key: &(World, Failures)) -> u128 {
    let [one, two] = [0, 0x9e37_79b9_7f4a_7c15].map(|seed| {
        let mut hasher = Quick(seed);
        key.hash(&mut hasher);
        hasher.finish()
    });
    u128::from(one) << 64 | u128::from(two)
}

type Seen = HashSet<u128, BuildHasherDefault<Quick>>;
type Layer = Vec<(World, Failures, Trace)>;

fn steps(time: Duration) -> u32 {
    time.as_millis().div_ceil(STEP.as_millis()) as u32
}

/// Returns the rule that a world breaks, if any.
fn broken(world: &World, failures: Failures) -> Option<&'static str> {
    let is_at_zero = world.output == Output::Zero;
    let runs = world.runs();
    // One step of slack, because either the player or the world may take its step first.
    let slack = 1;
    if let Some(known) = world.known_for.filter(|_| runs) {
        if known > steps(CONFIRM) + slack && !is_at_zero && world.said.is_none() {
            return Some("0.5 s after the detection neither zero nor a sentence");
        }
        let quiet = world.said.unwrap_or(0);
        let is_due = known > steps(CONFIRM) + slack && !failures.player_stopped;
        if is_due && !is_at_zero && !failures.zero_prevented {
            return Some("nothing prevents zero, and it is not there 0.5 s after the detection");
        }
        if is_due && !is_at_zero && quiet > steps(EVERY) + slack {
            return Some("a second without a sentence");
        }
        if world.player.is_over() && !is_at_zero && world.known_for > Some(1) {
            return Some("zero is taken for confirmed, and is not there");
        }
    }
    let undetected = world.known_for.is_none() && world.said.is_none();
    if undetected && world.stood_before_player > steps(WAITS.answer()) + 2 {
        return Some("a voltage stands for longer than D, and nothing is detected");
    }
    if undetected && world.stood > 10 && !runs && !nobody(world) {
        return Some("a guardian that could write zero does not");
    }
    let waited = |steps: Option<u32>| steps.unwrap_or(0);
    if runs && !failures.player_stopped {
        let longest = steps(WAITS.answer() + CONFIRM) + slack;
        if waited(world.asked) > longest {
            return Some("a call waits for longer than D and 0.5 s");
        }
        if world.app != App::Gone && waited(world.dropped) > steps(WAITS.answer()) + slack {
            return Some("dropping the device takes longer than D");
        }
    }
    if failures.count == 0 && (world.player.why().is_some() || world.said.is_some()) {
        return Some("an alarm without a failure");
    }
    None
}

/// Whether neither the player nor the guardian is able to act.
fn nobody(world: &World) -> bool {
    let guardian_acts = world.guardian == Process::Running && world.driver != Driver::Hangs;
    !world.runs() && !guardian_acts
}

/// Returns the world itself, and the world with each failure or scene end that may come now.
fn causes(
    (world, failures, trace): (World, Failures, Trace),
    most: usize,
    step: u32,
) -> Vec<(World, Failures, Trace)> {
    let mut worlds = Vec::new();
    let may_fail = |_: &Fault| failures.count < most;
    for fault in Fault::ALL.into_iter().filter(may_fail) {
        if let Some(failed) = fault.in_world(&world) {
            let trace = and(trace, step, Cause::Failure(fault));
            worlds.push((failed, failures.with(fault), trace));
        }
    }
    if !world.ends && world.app == App::Playing {
        let mut ended = world.clone();
        ended.ends = true;
        worlds.push((ended, failures, and(trace, step, Cause::End)));
    }
    worlds.push((world, failures, trace));
    worlds
}

impl Explored {
    /// Advances a world by one step, once with the player first and once with the player last.
    /// Keeps both results.
    fn go_on(&mut self, (world, failures, trace): &(World, Failures, Trace), next: &mut Layer) {
        let (failures, trace) = (*failures, *trace);
        let [first, last] = [true, false].map(|player_first| {
            let mut world = world.clone();
            world.advance(player_first);
            world
        });
        let differ = (first != last).then_some(last);
        for world in [Some(first), differ].into_iter().flatten() {
            if let Some(what) = broken(&world, failures) {
                self.broken.entry(what).or_insert(trace);
                continue;
            }
            if world.is_over() {
                self.at_zero += 1;
                continue;
            }
            if nobody(&world) && world.stood > 0 {
                assert!(failures.count > 1, "{trace:?}");
                self.nobody += 1;
            }
            self.detected += u64::from(world.known_for == Some(0));
            self.said += u64::from(world.said.is_some() && world.output != Output::Zero);
            let key = (world, failures);
            if self.seen.insert(print_of(&key)) {
                next.push((key.0, failures, trace));
            }
        }
    }
}

/// Explores all worlds with at most `most` failures.
fn explore(most: usize, mutant: Mutant) -> Explored {
    let mut explored = Explored::default();
    let mut layer = vec![(World::new(mutant), Failures::default(), [None; 3])];
    let mut step = 0;
    while !layer.is_empty() {
        let mut next = Layer::default();
        for world in layer {
            for world in causes(world, most, step) {
                explored.go_on(&world, &mut next);
            }
        }
        layer = next;
        step += 1;
    }
    explored
}

fn most() -> usize {
    match std::env::var_os("HTEX_WHOLE") {
        Some(_) => 2,
        None => 1,
    }
}

#[test]
fn the_output_is_at_zero_or_the_sentence_is_printed_whatever_fails() {
    let begun = std::time::Instant::now();
    let explored = explore(most(), Mutant::default());
    println!(
        "{} worlds with at most {} failures in {:.0} s: {} detections, {} ends at zero, {} with the sentence, \
         {} in which player and guardian have both failed",
        explored.seen.len(),
        most(),
        begun.elapsed().as_secs_f64(),
        explored.detected,
        explored.at_zero,
        explored.said,
        explored.nobody,
    );
    assert!(explored.broken.is_empty(), "{:#?}", explored.broken);
    assert!(explored.detected > 100 && explored.at_zero > 100);
}

/// Tests the model itself: a player that leaves out one of its actions must break a rule.
#[test]
fn a_player_that_leaves_something_out_is_found() {
    type Edit = fn(&mut Mutant);
    let left_out = |edit: Edit| {
        let mut mutant = Mutant::default();
        edit(&mut mutant);
        let explored = explore(1, mutant);
        explored.broken.keys().copied().collect::<Vec<_>>()
    };
    let mutants: [(&str, Edit); 6] = [
        ("no kill", |m| m.no_kill = true),
        ("no attempt", |m| m.no_attempt = true),
        ("no sentence", |m| m.no_sentence = true),
        ("one sentence", |m| m.one_sentence = true),
        ("no deadline", |m| m.no_deadline = true),
        ("no watchdog", |m| m.no_watchdog = true),
    ];
    for (what, edit) in mutants {
        let found = left_out(edit);
        println!("{what}: {found:?}");
        assert!(!found.is_empty(), "{what}");
    }
}
