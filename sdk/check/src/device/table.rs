//! The table of checks.

use htex_device::Direction;

use crate::device::case::Case;
use crate::device::checks::{describe, end, limit, open, read, write};
use crate::harness::Check;

/// Returns the checks for devices of a direction (output or input). Without a direction, returns
/// the checks that apply to both directions.
pub fn checks_of(direction: Option<Direction>) -> impl Iterator<Item = &'static Check<Case>> {
    CHECKS.iter().filter(move |check| {
        check.only.is_empty() || direction.is_some_and(|direction| check.only.contains(&direction))
    })
}

crate::harness::checks! { Case;
    "marker" needs [] describe::loaded:
        "The library has a table, whose marker names this ABI's major version.";
    "exports" needs ["marker"] describe::loaded:
        "The file loads, and its table has every function of its direction.";
    "descriptor" needs ["exports"] describe::descriptor:
        "The descriptor is JSON of the schema: names, ranges, defaults and profiles make sense, and the target of an input is a setting.";
    "extensions" needs ["exports"] describe::extensions:
        "Unknown extensions are absent.";
    "endpoints" needs ["descriptor"] describe::endpoints:
        "Endpoints can be listed; a missing driver is reported.";
    "capabilities" for Output needs ["descriptor"] describe::capabilities:
        "Capabilities are finite and agree, for each profile; a voltage has a limit.";
    "open" needs ["descriptor", "capabilities"] open::opens:
        "An output opens at each rate of a list, at both ends of a range, and at the default rate. An input opens with a valid rate and valid channels, the same each time.";
    "bad-settings" needs ["open"] describe::bad_settings:
        "Unknown settings, values out of range, lines that are not settings and second lines of a setting are refused by name.";
    "bad-rate" for Output needs ["open"] open::bad_rate:
        "Rates that it does not have are refused.";
    "bad-block" for Output needs ["open"] open::bad_block:
        "Blocks of 0 frames and of more than 1,048,576 are refused.";
    "write" for Output needs ["open"] write::blocks:
        "Blocks of any size, including empty ones, are taken in the end.";
    "status" for Output needs ["write"] write::status:
        "It counts the frames it took and their peak.";
    "over-limit" for Output needs ["status"] limit::over:
        "A sample over the limit is refused, and the device is closed from then on.";
    "no-number" for Output needs ["status"] limit::no_number:
        "NaN and infinities are refused, and the device is closed from then on.";
    "start" for Input needs ["open"] read::starts:
        "Nothing can be read before the start; a second start changes nothing.";
    "read" for Input needs ["start"] read::blocks:
        "Blocks of any size, including empty ones, are delivered: finite samples, no more than there is space for.";
    "timeout" for Input needs ["start"] read::timeouts:
        "A read returns when its timeout has passed, at most half a second later.";
    "finish" needs ["status", "start"] end::finishes:
        "All that was written comes out. Nothing can be written, read or started afterwards.";
    "abort" for Output needs ["write"] end::aborts:
        "Closed without its end, it leaves nothing behind.";
    "handles" needs ["write", "start"] end::handles:
        "A handle that was closed is refused, also when another device was opened.";
    "arrays" needs ["write", "start"] describe::arrays:
        "Null and misaligned arrays are refused, and nothing is written beyond an array.";
    "two" needs ["status", "read"] open::two:
        "Two are open at the same time, or the second is refused as busy.";
    "memory" needs ["write", "read"] end::memory:
        "Memory does not grow over 10,000 blocks (10 s of an output with a clock, 5 s of an input), nor over 100 devices opened and closed: at most 2 MiB. On Linux.";
}
