//! The checkers of plugins, with one check for each guarantee of an ABI: of models ([`model`]), and
//! of devices ([`device`]). Both are tables of checks that [`harness`] runs, each check
//! in a separate process, so that a crash or an endless loop becomes a finding.

pub mod device;
pub mod harness;
pub mod model;
