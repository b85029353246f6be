//! The table of source checks.

use crate::harness::Check;
use htex_device::SourceAdapter;

use crate::device::case::CheckedKind;
use crate::device::checks::describe::{endpoints, extensions, loaded};
use crate::device::source::case::Case;
use crate::device::source::{describe, read};

impl CheckedKind for dyn SourceAdapter {
    const CHECKS: &'static [Check<Case>] = CHECKS;
}

crate::harness::checks! { Case;
    "marker" needs [] loaded:
        "The marker names this ABI's major version.";
    "exports" needs ["marker"] loaded:
        "The file loads, and exports every function of the ABI.";
    "descriptor" needs ["exports"] describe::descriptor:
        "The descriptor is JSON of the schema: names, ranges, defaults and profiles make sense, and the target is a setting.";
    "extensions" needs ["exports"] extensions:
        "Unknown extensions are absent.";
    "endpoints" needs ["descriptor"] endpoints:
        "Endpoints can be listed; a missing driver is reported.";
    "open" needs ["descriptor"] describe::opens:
        "It opens; rate and channels are valid, and the same each time.";
    "bad-settings" needs ["open"] describe::bad_settings:
        "Unknown settings, values out of range, lines that are not settings and second lines of a setting are refused by name.";
    "start" needs ["open"] read::starts:
        "Nothing can be read before the start; a second start changes nothing.";
    "read" needs ["start"] read::blocks:
        "Blocks of any size, including empty ones, are delivered: finite samples, no more than there is space for.";
    "timeout" needs ["start"] read::timeouts:
        "A read returns when its timeout has passed, at most half a second later.";
    "stop" needs ["start"] read::stops:
        "Nothing can be read or started after the stop; a second stop changes nothing.";
    "handles" needs ["start"] read::handles:
        "A handle that was closed is refused, also when another source was opened.";
    "arrays" needs ["start"] describe::arrays:
        "Null and misaligned arrays are refused, and nothing is written beyond an array.";
    "two" needs ["read"] read::two:
        "Two are open at the same time, or the second is refused as busy.";
    "memory" needs ["read"] read::memory:
        "Memory does not grow over 5 s of reads (10,000 at most), nor over 100 sources opened and closed: at most 2 MiB. On Linux.";
}
