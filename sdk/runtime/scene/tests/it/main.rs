//! Integration tests, in one program.
#![allow(unreachable_pub, clippy::panic, clippy::unwrap_used, reason = "a failed test may panic")]

mod budget;
mod common;
mod compensation;
mod conformance;
mod drive;
mod equivalence;
mod exploration;
mod fluctuation;
mod hostile;
mod kept_gains;
mod parsimony;
mod without_device;
