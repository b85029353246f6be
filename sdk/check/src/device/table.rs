//! The table of device checks.

use crate::harness::Check;
use htex_device::Adapter;

use crate::device::adapter::Case;
use crate::device::case::CheckedKind;
use crate::device::checks::{describe, end, limit, open, write};

impl CheckedKind for dyn Adapter {
    const CHECKS: &'static [Check<Case>] = CHECKS;
}

crate::harness::checks! { Case;
    "marker" needs [] describe::loaded:
        "The marker names this ABI's major version.";
    "exports" needs ["marker"] describe::loaded:
        "The file loads, and exports every function of the ABI.";
    "descriptor" needs ["exports"] describe::descriptor:
        "The descriptor is JSON of the schema: names, ranges, defaults and profiles make sense.";
    "extensions" needs ["exports"] describe::extensions:
        "Unknown extensions are absent.";
    "endpoints" needs ["descriptor"] describe::endpoints:
        "Endpoints can be listed; a missing driver is reported.";
    "capabilities" needs ["descriptor"] describe::capabilities:
        "Capabilities are finite and agree, for each profile; a voltage has a limit.";
    "bad-settings" needs ["capabilities"] describe::bad_settings:
        "Unknown settings, values out of range, lines that are not settings and second lines of a setting are refused by name.";
    "open" needs ["capabilities"] open::opens:
        "It opens at each rate of a list, at both ends of a range, and at the default rate.";
    "bad-rate" needs ["open"] open::bad_rate:
        "Rates that it does not have are refused.";
    "bad-block" needs ["open"] open::bad_block:
        "Blocks of 0 frames and of more than 1,048,576 are refused.";
    "write" needs ["open"] write::blocks:
        "Blocks of any size, including empty ones, are taken in the end.";
    "status" needs ["write"] write::status:
        "It counts the frames it took and their peak.";
    "over-limit" needs ["status"] limit::over:
        "A sample over the limit is refused, and the device is closed from then on.";
    "no-number" needs ["status"] limit::no_number:
        "NaN and infinities are refused, and the device is closed from then on.";
    "finish" needs ["status"] end::finishes:
        "All that was written comes out, and nothing can be written afterwards.";
    "abort" needs ["write"] end::aborts:
        "Closed without its end, it leaves nothing behind.";
    "handles" needs ["write"] end::handles:
        "A handle that was closed is refused, also when another device was opened.";
    "arrays" needs ["write"] describe::arrays:
        "Null and misaligned arrays are refused, and nothing is written beyond an array.";
    "two" needs ["status"] open::two:
        "Two are open at the same time, or the second is refused as busy.";
    "memory" needs ["write"] write::memory:
        "Memory does not grow over 10,000 blocks of 256 frames (10 s of a device with a clock), nor \
         over 100 devices opened and closed: at most 2 MiB. On Linux.";
}
