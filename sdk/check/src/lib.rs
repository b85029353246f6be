//! The checkers of plugins: for models ([`model`]) and for devices ([`device`]). There is one check
//! for each guarantee of the plugin's ABI. [`harness`] runs each check in a separate process, so
//! that a crash or an endless loop becomes a finding. [`conformance`] runs third-party readers on
//! the conformance files. [`templates`] are the projects that `htex plugin new` and `htex device
//! new` write.

pub mod conformance;
pub mod device;
pub mod harness;
pub mod model;
pub mod templates;
