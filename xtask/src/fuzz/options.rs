//! Options of `cargo xtask fuzz`.

use clap::Args;
use clap::builder::RangedU64ValueParser;

/// The targets, and how long to run them.
#[derive(Debug, Clone, PartialEq, Eq, Args)]
pub struct Options {
    /// Targets to fuzz: file names in fuzz/fuzz_targets without .rs [default: all]
    pub targets: Vec<String>,
    /// Time limit for each target, seconds [default: 60 without --executions]
    #[arg(long, value_name = "N", value_parser = positive())]
    pub seconds: Option<u64>,
    /// Maximum number of executions of each target
    #[arg(long, value_name = "N", value_parser = positive())]
    pub executions: Option<u64>,
    /// Number of targets that run at the same time
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u8).range(1..=64))]
    pub jobs: u8,
    /// Run under the address sanitizer, which needs a nightly toolchain; see fuzz/README.md
    #[arg(long)]
    pub address: bool,
}

impl Options {
    /// Returns these options. If the options limit neither time nor executions, limits the time to
    /// `seconds`.
    pub(crate) fn bounded(&self, seconds: u64) -> Self {
        let is_bounded = self.seconds.is_some() || self.executions.is_some();
        let seconds = self.seconds.or((!is_bounded).then_some(seconds));
        Self { seconds, ..self.clone() }
    }
}

fn positive() -> RangedU64ValueParser {
    RangedU64ValueParser::new().range(1..)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_target_has_a_bound() {
        let bounds = |seconds, executions| {
            let options =
                Options { targets: Vec::new(), seconds, executions, jobs: 2, address: false };
            let options = options.bounded(60);
            (options.seconds, options.executions)
        };
        assert_eq!(bounds(None, None), (Some(60), None));
        assert_eq!(bounds(None, Some(9)), (None, Some(9)));
        assert_eq!(bounds(Some(5), Some(9)), (Some(5), Some(9)));
    }
}
