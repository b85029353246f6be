//! Time limits, retries, and the environment variables that contain credentials.
//!
//! The retries continue for about as long as a server takes to restart. The 20 pauses of at most 2
//! s add up to 33 s on average, and to at most 37 s. In 999 of 1,000 cases the sum is at least 22 s
//! (measured with 100,000 random sequences).

use std::fmt;
use std::time::Duration;

use crate::storage::{StorageError, StorageProblem};

/// Name of the variable for [`Settings::total`], in seconds.
const TIMEOUT: &str = "HTEX_STORAGE_TIMEOUT_S";

/// Time limits and retries of one operation.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Settings {
    /// Longest time for an operation with all its retries: 600 s, or the value of the variable
    /// `HTEX_STORAGE_TIMEOUT_S`.
    pub total: Duration,
    /// Longest time without receiving a byte: 30 s. Opening the connection may take at most 10 s of
    /// this time. If either time is exceeded, the program sends the request again.
    pub stall: Duration,
    /// Largest number of retries of a request: 20.
    pub retries: usize,
    /// Pause before the first retry: 0.2 s. Each later pause is random, and up to six times as long
    /// as the previous pause.
    pub first_pause: Duration,
    /// Longest pause: 2 s.
    pub longest_pause: Duration,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            total: Duration::from_secs(600),
            stall: Duration::from_secs(30),
            retries: 20,
            first_pause: Duration::from_millis(200),
            longest_pause: Duration::from_secs(2),
        }
    }
}

impl Settings {
    /// Returns the default settings, except that an environment variable can set the total time.
    ///
    /// # Errors
    /// Returns an error if `HTEX_STORAGE_TIMEOUT_S` is not a number of seconds from 0.1 to 86,400.
    pub fn from_variables(variables: &Variables) -> Result<Self, StorageError> {
        let mut settings = Self::default();
        if let Some(text) = variables.get(TIMEOUT) {
            let seconds = text.trim().parse::<f64>().unwrap_or(f64::NAN);
            if !(0.1..=86_400.0).contains(&seconds) {
                let problem = "not a number of seconds from 0.1 to 86400".to_owned();
                return Err(StorageProblem::Settings { problem }.at_place(TIMEOUT));
            }
            settings.total = Duration::from_secs_f64(seconds);
        }
        Ok(settings)
    }
}

/// Names and values of environment variables. The values contain credentials and endpoints, so they
/// are never displayed.
#[derive(Clone, Default)]
pub struct Variables(Vec<(String, String)>);

impl Variables {
    /// Reads the variables of the process. Names and values that are not Unicode are left out.
    pub fn of_process() -> Self {
        let text = |(name, value): (std::ffi::OsString, std::ffi::OsString)| {
            Some((name.into_string().ok()?, value.into_string().ok()?))
        };
        Self(std::env::vars_os().filter_map(text).collect())
    }

    fn get(&self, name: &str) -> Option<&str> {
        let mut all = self.0.iter();
        all.find_map(|(of, value)| (of == name).then_some(&value[..]))
    }

    /// Refuses control characters in the values of variables whose names start with `prefix`. No
    /// valid header, host or key contains a control character.
    ///
    /// # Errors
    /// If a value contains a control character. The sentence contains the variable's name.
    #[cfg(feature = "cloud")]
    pub(crate) fn check(&self, prefix: &str) -> Result<(), String> {
        // A key in JSON form has line breaks, so it is not checked.
        let is_text = |value: &str| !value.trim_start().starts_with('{');
        let wrong =
            |(_, value): &(&str, &str)| is_text(value) && value.chars().any(char::is_control);
        match self.with_prefix(prefix).find(wrong) {
            None => Ok(()),
            Some((name, _)) => {
                Err(format!("{name} has a line break or another control character; correct it"))
            }
        }
    }

    /// Returns the variables that are set and whose names start with `prefix`.
    #[cfg(feature = "cloud")]
    pub(crate) fn with_prefix<'a>(
        &'a self,
        prefix: &'a str,
    ) -> impl Iterator<Item = (&'a str, &'a str)> {
        let both = self.0.iter().map(|(name, value)| (&name[..], &value[..]));
        both.filter(move |(name, value)| name.starts_with(prefix) && !value.is_empty())
    }
}

impl<N: Into<String>, V: Into<String>> FromIterator<(N, V)> for Variables {
    fn from_iter<I: IntoIterator<Item = (N, V)>>(pairs: I) -> Self {
        let text = |(name, value): (N, V)| (name.into(), value.into());
        Self(pairs.into_iter().map(text).collect())
    }
}

impl fmt::Debug for Variables {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self.0.iter().map(|(name, _)| name)).finish()
    }
}
