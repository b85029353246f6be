//! Integration tests, in one program.
#![allow(
    unreachable_pub,
    clippy::disallowed_methods,
    clippy::expect_used,
    clippy::unwrap_used,
    reason = "a failed test may panic"
)]

mod live;
mod record;
mod record_parts;
mod record_signals;
mod recording;
mod response;
mod rig;
mod study_plan;
mod study_rules;
mod study_run;
mod study_session;
