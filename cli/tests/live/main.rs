//! The command with what runs in real time: devices, hands, pages, participants.
#![allow(unreachable_pub, clippy::unwrap_used, clippy::panic)] // A failed unwrap is a failed test.

#[path = "../common/bench.rs"]
mod bench;
#[path = "../common/browser.rs"]
mod browser;
#[path = "../common/mod.rs"]
mod common;
#[path = "../../../renderer-adapters/builtin/tests/it/daq_simulated/library.rs"]
mod simulated;
#[path = "../common/study.rs"]
mod studies;

#[cfg(unix)]
mod device;
mod drive;
#[cfg(unix)]
mod finger;
#[cfg(target_os = "linux")]
mod hostile;
mod input;
#[cfg(unix)]
mod live;
#[cfg(target_os = "linux")]
mod pads;
#[cfg(feature = "lab")]
mod record;
#[cfg(all(unix, feature = "lab"))]
mod record_page;
#[cfg(unix)]
mod study;
