//! Shows progress on a terminal, and nothing elsewhere.

use indicatif::{ProgressBar, ProgressStyle};

/// Returns a progress bar over `steps` named steps on standard error. It is hidden unless that is a
/// terminal.
pub(crate) fn bar(steps: u64) -> ProgressBar {
    let bar = ProgressBar::new(steps);
    if let Ok(style) = ProgressStyle::with_template("{bar:24} {pos}/{len} {msg}") {
        bar.set_style(style);
    }
    bar
}

/// Returns a progress bar over bytes on standard error, with the rate and the time left. It is
/// hidden unless that is a terminal.
#[cfg(feature = "build")]
pub(crate) fn bytes(bytes: u64) -> ProgressBar {
    let bar = ProgressBar::new(bytes);
    let template = "{bar:24} {msg}, {bytes} of {total_bytes}, {bytes_per_sec}, {eta} left";
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
    bar
}
