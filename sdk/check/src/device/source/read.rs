//! Checks of starting, reading, stopping and closing.

use std::time::{Duration, Instant};

use crate::harness::{Finding, Found, Growth};
use htex_device::{Delivered, DeviceError, Source};

use crate::device::source::case::{Case, closed, read_all};

/// Block size in the check of memory, frames.
const BLOCK: usize = 64;
/// Maximum number of blocks, and the longest total duration of their samples, seconds.
const BLOCKS: usize = 10_000;
const TIME_S: f64 = 5.0;
/// Number of sources that are opened and closed.
const OPENED: usize = 100;
/// How much longer than its timeout a read may take.
const LATE: Duration = Duration::from_millis(500);

/// Nothing can be read before the start, and a second start must change nothing.
pub(crate) fn starts(case: &Case) -> Found {
    let mut source = case.open()?;
    let mut samples = vec![0.0; source.channels().len()];
    let early = source.read(&mut samples, Duration::ZERO);
    closed("a read before the start", early)?;
    drop(source);
    // A new source, because the refused call may have ended the first one.
    let mut source = case.open()?;
    source.start()?;
    source.start()?;
    let read = read_all(source.as_mut(), 1)?;
    Ok(Finding::passed(format!("{read} frame after the start")))
}

/// Blocks of any size must be delivered.
pub(crate) fn blocks(case: &Case) -> Found {
    let mut source = case.started()?;
    let sizes = [1, 7, 64, 193];
    let mut read = 0;
    for size in sizes {
        match source.read(&mut [], Duration::ZERO)? {
            Delivered::Frames(0) | Delivered::End => {}
            Delivered::Frames(more) => {
                let message = format!("it delivers {more} frames into no space");
                return Err(Finding::failed(message));
            }
        }
        read += read_all(source.as_mut(), size)?;
    }
    let all: usize = sizes.iter().sum();
    if read < all {
        let message = format!("it ends after {read} frames; {all} are needed to check it");
        return Err(Finding::skipped(message));
    }
    Ok(Finding::passed(format!("{read} frames are delivered")).with("frames", read as f64))
}

/// A read with a timeout of zero must return at once, and any other read within its timeout.
pub(crate) fn timeouts(case: &Case) -> Found {
    let mut source = case.started()?;
    let mut samples = vec![0.0; source.channels().len()];
    let mut latest = Duration::ZERO;
    for timeout in [Duration::ZERO, Duration::from_millis(1), Duration::from_millis(200)] {
        let since = Instant::now();
        source.read(&mut samples, timeout)?;
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

/// After stopping, the source can be neither read nor started.
pub(crate) fn stops(case: &Case) -> Found {
    let mut source = case.started()?;
    read_all(source.as_mut(), 3)?;
    source.stop()?;
    source.stop()?;
    let mut samples = vec![0.0; source.channels().len()];
    closed("a start after the stop", source.start())?;
    let late = source.read(&mut samples, Duration::ZERO);
    closed("a read after the stop", late)?;
    Ok(Finding::passed("nothing is delivered after the stop"))
}

/// A closed handle must be refused, even after another source was opened.
pub(crate) fn handles(case: &Case) -> Found {
    let native = case.native()?;
    let mut old = native.open_native(&case.settings()?)?;
    old.close_and_keep_handle()?;
    let mut samples = vec![0.0; old.channels().len()];
    for another in [false, true] {
        let _open = another.then(|| case.open()).transpose()?;
        closed("`start` of a closed handle", old.start())?;
        let read = old.read(&mut samples, Duration::ZERO);
        closed("`read` of a closed handle", read)?;
        closed("`stream` of a closed handle", old.stream_again())?;
        closed("`stop` of a closed handle", old.stop())?;
        closed("`close` of a closed handle", old.close_and_keep_handle())?;
    }
    Ok(Finding::passed("a closed handle is refused"))
}

/// Two sources must deliver at the same time, or the second must be refused as busy.
pub(crate) fn two(case: &Case) -> Found {
    let mut first = case.started()?;
    let second = case.adapter.open(&case.settings()?);
    let started = second.and_then(|mut second| second.start().map(|()| second));
    let mut second = match started {
        Err(DeviceError::Busy(why)) => {
            return Ok(Finding::passed(format!("one at a time: {why}")));
        }
        other => other?,
    };
    let wanted = read_all(first.as_mut(), 64)?;
    let counts = [second.as_mut(), first.as_mut()].map(|source| read_all(source, wanted));
    for count in counts {
        count?;
    }
    Ok(Finding::passed("two deliver at the same time"))
}

/// The process must not grow with the samples read, or as sources are opened and closed.
pub(crate) fn memory(case: &Case) -> Found {
    crate::harness::memory(|| {
        let mut source = case.started()?;
        let most = (TIME_S * source.rate_hz() / BLOCK as f64) as usize;
        let read =
            |count: usize| (0..count).try_for_each(|_| read_all(source.as_mut(), BLOCK).map(drop));
        let read = Growth::measure(BLOCKS.min(most.max(1)), "blocks", read)?;
        drop(source);
        let open = |count: usize| (0..count).try_for_each(|_| case.started().map(drop));
        Ok([read, Growth::measure(OPENED, "openings", open)?])
    })
}
