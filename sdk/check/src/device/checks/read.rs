//! Checks of starting and reading.

use std::time::{Duration, Instant};

use crate::harness::{CheckResult, Finding};
use htex_device::InputFrames;

use crate::device::case::{Case, check_closed, read_all};

/// How much longer than its timeout a read may take.
const LATE: Duration = Duration::from_millis(500);

/// Checks that nothing can be read before the start, and that a second start changes nothing.
pub(crate) fn starts(case: &Case) -> CheckResult {
    let mut input = case.open_input()?;
    let mut samples = vec![0.0; input.stream().channels.len()];
    let early = input.read(&mut samples, Duration::ZERO);
    check_closed([("a read before the start", early.map(drop))])?;
    drop(input);
    // Opens a new input, because the refused call may have ended the first one.
    let mut input = case.open_input()?;
    input.start()?;
    input.start()?;
    let read = read_all(input.as_mut(), 1)?;
    Ok(Finding::passed(format!("{read} frame after the start")))
}

/// Checks that the input delivers blocks of any size.
pub(crate) fn blocks(case: &Case) -> CheckResult {
    let mut input = case.started()?;
    let sizes = [1, 7, 64, 193];
    let mut read = 0;
    for size in sizes {
        match input.read(&mut [], Duration::ZERO)? {
            InputFrames::Count(0) | InputFrames::End => {}
            InputFrames::Count(more) => {
                let message = format!("it delivers {more} frames into no space");
                return Err(Finding::failed(message));
            }
        }
        read += read_all(input.as_mut(), size)?;
    }
    let all: usize = sizes.iter().sum();
    if read < all {
        let message = format!("it ends after {read} frames; {all} are needed to check it");
        return Err(Finding::skipped(message));
    }
    Ok(Finding::passed(format!("{read} frames are delivered")).with("frames", read as f64))
}

/// Checks that a read with a timeout of zero returns at once, and any other read within its
/// timeout.
pub(crate) fn timeouts(case: &Case) -> CheckResult {
    let mut input = case.started()?;
    let mut samples = vec![0.0; input.stream().channels.len()];
    let mut latest = Duration::ZERO;
    for timeout in [Duration::ZERO, Duration::from_millis(1), Duration::from_millis(200)] {
        let since = Instant::now();
        input.read(&mut samples, timeout)?;
        latest = latest.max(since.elapsed().saturating_sub(timeout));
    }
    let late_s = latest.as_secs_f64();
    let finding = if latest <= LATE {
        Finding::passed("reads return in time")
    } else {
        Finding::failed(format!("a read returns {late_s:.1} s after its timeout"))
    };
    Ok(finding.with("late_s", late_s))
}
