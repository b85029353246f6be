//! The output of `htex --version`. `htex -V` prints only the version.

/// The version, followed by one line each for the commit of the sources, the target and the
/// features of this build.
pub(crate) const LONG: &str = concat!(
    env!("CARGO_PKG_VERSION"),
    "\ncommit: ",
    env!("HTEX_COMMIT"),
    "\ntarget: ",
    env!("HTEX_TARGET"),
    "\nfeatures: ",
    env!("HTEX_FEATURES"),
);
