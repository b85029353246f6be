//! Options of `cargo xtask fuzz`.

use anyhow::{Context, Result, bail};

/// Default time of a target, seconds.
const SECONDS: u64 = 60;

/// Targets and time.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Options {
    /// Targets; all when empty.
    pub targets: Vec<String>,
    /// Longest time of a target, seconds.
    pub seconds: Option<u64>,
    /// Most executions of a target.
    pub executions: Option<u64>,
    /// Targets that run at the same time.
    pub jobs: usize,
    /// With the address sanitizer.
    pub address: bool,
}

impl Options {
    /// Reads arguments.
    ///
    /// # Errors
    /// The invalid argument.
    pub fn parse(arguments: &[&str]) -> Result<Self> {
        let mut options =
            Self { targets: Vec::new(), seconds: None, executions: None, jobs: 2, address: false };
        let mut arguments = arguments.iter();
        while let Some(&argument) = arguments.next() {
            let mut number = || number(argument, arguments.next());
            match argument {
                "--seconds" => options.seconds = Some(number()?),
                "--executions" => options.executions = Some(number()?),
                "--jobs" => options.jobs = number()?.min(64) as usize,
                "--address" => options.address = true,
                _ if argument.starts_with('-') => bail!("{argument} is unknown"),
                _ => options.targets.push(argument.to_owned()),
            }
        }
        if options.seconds.is_none() && options.executions.is_none() {
            options.seconds = Some(SECONDS);
        }
        Ok(options)
    }
}

fn number(name: &str, value: Option<&&str>) -> Result<u64> {
    let number = value.and_then(|text| text.parse().ok());
    number
        .filter(|number| *number > 0)
        .with_context(|| format!("{name} takes a whole number from 1"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arguments_are_told_apart() {
        let all = ["csv", "--seconds", "5", "wav", "--executions", "9", "--jobs", "1", "--address"];
        let options = Options::parse(&all);
        let expected = Options {
            targets: vec!["csv".to_owned(), "wav".to_owned()],
            seconds: Some(5),
            executions: Some(9),
            jobs: 1,
            address: true,
        };
        assert_eq!(options.ok(), Some(expected));
        let seconds = |options: &[&str]| Options::parse(options).ok().map(|o| o.seconds);
        assert_eq!(seconds(&[]), Some(Some(SECONDS)));
        assert_eq!(seconds(&["--executions", "9"]), Some(None));
        for wrong in [&["--seconds"][..], &["--seconds", "0"], &["--jobs", "x"], &["--fast"]] {
            assert!(Options::parse(wrong).is_err(), "{wrong:?}");
        }
    }
}
