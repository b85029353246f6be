//! Checks of opening.

use htex_device::abi::{Code, MAX_BLOCK_FRAMES};
use htex_device::{DeviceError, Direction, InputStream};

use crate::device::case::{Case, rates, read_all, write_all};
use crate::harness::{CheckResult, Finding};

const INVALID_ARGUMENT: i64 = Code::InvalidArgument as i64;

/// Checks that the device opens.
pub(crate) fn opens(case: &Case) -> CheckResult {
    match case.direction() {
        Direction::Output => opens_output(case),
        Direction::Input => opens_input(case),
    }
}

/// Checks that sample rate and channels are valid, and the same each time the input is opened. For
/// a library, they must also be the same at each call.
fn opens_input(case: &Case) -> CheckResult {
    let stream = || Ok::<InputStream, Finding>(case.open_input()?.stream().clone());
    let first = stream()?;
    first.check()?;
    let mut others = vec![stream()?];
    if let Ok(native) = case.native() {
        let input = native.open_native_input(&case.settings()?)?;
        others.push(input.stream_again()?);
        others.push(input.stream_again()?);
    }
    if let Some(other) = others.iter().find(|other| **other != first) {
        let message = format!("rate and channels change: {first:?}, then {other:?}");
        return Err(Finding::failed(message));
    }
    let (count, rate_hz) = (first.channels.len(), first.rate_hz);
    Ok(Finding::passed(format!("{count} channels at {rate_hz} Hz")).with("rate_hz", rate_hz))
}

/// Checks that the output opens at each of its sample rates, and accepts silence.
fn opens_output(case: &Case) -> CheckResult {
    let rates = rates(&case.capabilities()?);
    for rate_hz in &rates {
        let opened = case.open_at(&case.settings()?, *rate_hz);
        let mut device = opened.map_err(|e| Finding::failed(format!("at {rate_hz} Hz: {e}")))?;
        write_all(device.as_mut(), &[0.0; 16])?;
    }
    let count = rates.len();
    Ok(Finding::passed(format!("it opens at {count} rates")).with("rates", count as f64))
}

/// Checks that sample rates that the device does not support are refused.
pub(crate) fn bad_rate(case: &Case) -> CheckResult {
    let can = case.capabilities()?;
    let (lowest, highest) = match rates(&can)[..] {
        [first, .., last] => (first, last),
        [only] => (only, only),
        [] => return Err(Finding::failed("it has no rates")),
    };
    let mut wrong = vec![f64::NAN, 0.0, -1.0, f64::INFINITY, 1e12, 0.5 * lowest, 2.0 * highest];
    // A rate between two rates of a list.
    wrong.push(lowest + 0.123);
    // If the device supports a range, it may contain some of these rates.
    wrong.retain(|rate_hz| !can.rates.has(*rate_hz));
    for rate_hz in &wrong {
        match case.open_at(&case.settings()?, *rate_hz) {
            Err(DeviceError::Rate { .. }) => {}
            Err(error) => return Err(Finding::failed(format!("{rate_hz} Hz: {error}"))),
            Ok(_) => return Err(Finding::failed(format!("it opens at {rate_hz} Hz"))),
        }
    }
    let count = wrong.len();
    Ok(Finding::passed(format!("{count} wrong rates are refused")).with("rates", count as f64))
}

/// Checks that block sizes outside the range of the ABI are refused.
pub(crate) fn bad_block(case: &Case) -> CheckResult {
    let native = case.native()?;
    let rate_hz = case.capabilities()?.default_rate_hz;
    let wrong = [0, MAX_BLOCK_FRAMES + 1, u32::MAX];
    for block in wrong {
        let lines = case.settings()?.to_lines(case.adapter.descriptor());
        match native.refusal_of_open(&lines, rate_hz, block) {
            None => {
                let message = format!("it opens for blocks of {block} frames");
                return Err(Finding::failed(message));
            }
            Some((INVALID_ARGUMENT, _)) => {}
            Some((status, text)) => {
                let message = format!(
                    "blocks of {block} frames are refused with {status}, not {INVALID_ARGUMENT}: {text}"
                );
                return Err(Finding::failed(message));
            }
        }
    }
    let count = wrong.len();
    Ok(Finding::passed(format!("{count} wrong block sizes are refused")))
}

/// Checks that two devices work at the same time, or that the second is refused as busy.
pub(crate) fn two(case: &Case) -> CheckResult {
    match case.direction() {
        Direction::Output => two_outputs(case),
        Direction::Input => two_inputs(case),
    }
}

fn two_outputs(case: &Case) -> CheckResult {
    let (mut first, settings) = case.open_output()?;
    let rate_hz = case.adapter.capabilities(&settings)?.default_rate_hz;
    let tone = case.tone(64)?;
    let mut second = match case.open_at(&case.settings()?, rate_hz) {
        Ok(second) => second,
        Err(error) => return one_at_a_time(error),
    };
    write_all(first.as_mut(), &tone)?;
    write_all(second.as_mut(), &tone[..10])?;
    let counts = [first, second].map(|device| device.status().frames_written);
    if counts == [64, 10] {
        return Ok(Finding::passed("two are open, each with its own count"));
    }
    let message = format!("64 and 10 frames were written, and it counts {counts:?}");
    Err(Finding::failed(message))
}

fn two_inputs(case: &Case) -> CheckResult {
    let mut first = case.started()?;
    let second = case.adapter.open_input(&case.settings()?);
    let mut second = match second.and_then(|mut second| second.start().map(|()| second)) {
        Ok(second) => second,
        Err(error) => return one_at_a_time(error),
    };
    let wanted = read_all(first.as_mut(), 64)?;
    for input in [second.as_mut(), first.as_mut()] {
        read_all(input, wanted)?;
    }
    Ok(Finding::passed("two deliver at the same time"))
}

/// Checks that the second device was refused as busy, and not with another error.
fn one_at_a_time(error: DeviceError) -> CheckResult {
    match error {
        DeviceError::Busy(why) => Ok(Finding::passed(format!("one at a time: {why}"))),
        error => Err(error.into()),
    }
}
