//! Faults at the n-th call of a function.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use crate::{codes, status, with};

/// The fault of a call.
#[derive(Clone, Copy)]
enum FaultKind {
    /// The call does nothing and returns a code.
    Error(i32),
    /// A write takes only half of the samples, and returns a code (0: success).
    Short(i32),
    /// The call takes this number of milliseconds longer.
    Hang(u64),
    /// The card is removed.
    Unplug,
}

struct Plan {
    function: String,
    /// Counted from 1.
    call: u64,
    /// Also the calls after it.
    lasts: bool,
    kind: FaultKind,
}

#[derive(Default)]
struct State {
    plan: Option<Plan>,
    /// The plan acts, and calls are counted, only while this file exists.
    while_there: Option<PathBuf>,
    calls: BTreeMap<&'static str, u64>,
}

static STATE: Mutex<Option<State>> = Mutex::new(None);

fn state<T>(run: impl FnOnce(&mut State) -> T) -> T {
    let mut state = STATE.lock().unwrap_or_else(PoisonError::into_inner);
    run(state.get_or_insert_with(State::default))
}

/// Reads `FUNCTION:CALL:KIND`, such as `DAQmxStartTask:2:error=-200077`; `CALL+` also means the
/// calls after it.
pub fn plan(text: &str) {
    match parse(text) {
        Some(plan) => state(|s| {
            *s = State { plan: Some(plan), while_there: s.while_there.take(), ..State::default() };
        }),
        None => eprintln!(
            "nidaqmx-simulated: `{text}` is no fault: FUNCTION:CALL[+]:error=CODE|short=CODE|hang=MS|unplug"
        ),
    }
}

/// Faults act, and calls are counted, only while this file exists. In this way, processes that
/// share a plan begin and end it together.
pub fn only_while(file: &str) {
    state(|s| s.while_there = Some(file.into()));
}

fn acts() -> bool {
    state(|s| s.while_there.as_ref().is_none_or(|file| file.exists()))
}

fn parse(text: &str) -> Option<Plan> {
    let mut parts = text.split(':');
    let (function, call, kind) = (parts.next()?, parts.next()?, parts.next()?);
    let kind = match kind.split_once('=') {
        Some(("error", code)) => FaultKind::Error(code.parse().ok()?),
        Some(("short", code)) => FaultKind::Short(code.parse().ok()?),
        Some(("hang", ms)) => FaultKind::Hang(ms.parse().ok()?),
        None if kind == "unplug" => FaultKind::Unplug,
        _ => return None,
    };
    Some(Plan {
        function: function.to_owned(),
        call: call.trim_end_matches('+').parse().ok()?,
        lasts: call.ends_with('+'),
        kind,
    })
}

/// Counts a call; returns the code of one that fails.
pub fn injected(function: &'static str) -> Option<i32> {
    match due(function)? {
        FaultKind::Error(code) => {
            status::<()>(Err(code));
            Some(code)
        }
        FaultKind::Hang(ms) => {
            let since = Instant::now();
            while since.elapsed() < Duration::from_millis(ms) && acts() {
                std::thread::sleep(Duration::from_millis(ms.min(5)));
            }
            None
        }
        FaultKind::Unplug => {
            with(|card| card.unplug_after = Some(0));
            Some(status::<()>(Err(codes::NOT_PRESENT)))
        }
        // Handled where samples are written.
        FaultKind::Short(_) => None,
    }
}

/// Returns the code of a short write if the plan makes the current call a short write. The current
/// call is already counted.
pub fn short_write() -> Option<i32> {
    state(|s| {
        let plan = s.plan.as_ref()?;
        let count = *s.calls.get("DAQmxWriteAnalogF64")?;
        let is_due = count == plan.call || (plan.lasts && count > plan.call);
        match plan.kind {
            FaultKind::Short(code) if plan.function == "DAQmxWriteAnalogF64" && is_due => {
                Some(code)
            }
            _ => None,
        }
    })
}

fn due(function: &'static str) -> Option<FaultKind> {
    if !acts() {
        return None;
    }
    state(|s| {
        let count = s.calls.entry(function).or_insert(0);
        *count += 1;
        let plan = s.plan.as_ref().filter(|plan| plan.function == function)?;
        let is_due = *count == plan.call || (plan.lasts && *count > plan.call);
        is_due.then_some(plan.kind)
    })
}

/// Number of calls of a function since the last plan.
#[unsafe(no_mangle)]
pub unsafe extern "system" fn nidaqmx_simulated_calls(function: *const std::ffi::c_char) -> u64 {
    let name = unsafe { crate::text(function) };
    state(|s| s.calls.iter().find(|(known, _)| **known == name).map_or(0, |(_, count)| *count))
}
