//! Checks that models and devices have in common.

use crate::harness::{CheckResult, Finding};

/// Allowed growth of the resident memory, bytes.
const ALLOWED: f64 = 2.0 * 1024.0 * 1024.0;

/// Growth of the process's resident memory over a number of repetitions.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Growth {
    count: usize,
    of: &'static str,
    bytes: f64,
}

impl Growth {
    /// Runs a tenth of `count` repetitions as a warm-up. Then runs `count` repetitions and measures
    /// the growth during these. `of` is the plural name of the repeated object.
    ///
    /// # Errors
    /// The errors of `repeat`.
    pub(crate) fn measure(
        count: usize,
        of: &'static str,
        mut repeat: impl FnMut(usize) -> Result<(), Finding>,
    ) -> Result<Self, Finding> {
        // The first repetitions fill caches and pools. This growth is not a leak.
        repeat(count.div_ceil(10))?;
        let before = resident_bytes().unwrap_or_default();
        repeat(count)?;
        let bytes = resident_bytes().unwrap_or_default() - before;
        Ok(Self { count, of, bytes })
    }
}

/// Checks that memory does not grow while something plays and while it is opened and closed.
///
/// # Errors
/// A finding with the outcome `Failed` if memory grows by more than 2 MiB in either case. A finding
/// with the outcome `Skipped` if resident memory cannot be read. Also the errors of `measure`.
pub(crate) fn memory(measure: impl FnOnce() -> Result<[Growth; 2], Finding>) -> CheckResult {
    if resident_bytes().is_none() {
        return Err(Finding::skipped("resident memory is read on Linux only"));
    }
    let [first, second] = measure()?;
    let kib = |growth: Growth| (growth.bytes / 1024.0).round();
    let message = format!(
        "{} {} grow the process by {} KiB, {} {} by {} KiB",
        first.count,
        first.of,
        kib(first),
        second.count,
        second.of,
        kib(second)
    );
    let finding = if first.bytes.max(second.bytes) > ALLOWED {
        Finding::failed(message)
    } else {
        Finding::passed(message)
    };
    Ok([first, second].iter().fold(finding, |finding, growth| {
        finding.with(&format!("{}_bytes", growth.of), growth.bytes)
    }))
}

/// Returns the resident memory of this process, bytes (`VmRSS` in `/proc/self/status`), or `None`
/// if the file does not exist.
fn resident_bytes() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"))?;
    let kib: f64 = line.trim().trim_end_matches("kB").trim().parse().ok()?;
    Some(1024.0 * kib)
}

/// Checks that made-up extensions are absent. `has` queries one extension.
///
/// # Errors
/// A finding with the outcome `Failed` that names an extension which `has` reports. Also the errors
/// of `has`.
pub(crate) fn made_up_extensions<E: Into<Finding>>(
    has: impl Fn(&str) -> Result<bool, E>,
) -> CheckResult {
    let long = "x".repeat(100_000);
    let ids = ["htex.no-such-thing/1", "com.example.unheard-of/7", "", "\u{1f}é", &long];
    for id in ids {
        if has(id).map_err(Into::into)? {
            let id: String = id.chars().take(40).collect();
            let message = format!("it claims to have the made-up extension `{id}`");
            return Err(Finding::failed(message));
        }
    }
    let message = format!("{} made-up extensions are absent", ids.len());
    Ok(Finding::passed(message).with("asked", ids.len() as f64))
}
