//! The commit that is released.

use std::process::Command;

use anyhow::{Context, Result, ensure};

use crate::places::workspace;

/// The commit that is released.
#[derive(Debug, Clone)]
pub(crate) struct Commit {
    /// The first twelve digits of its hash, followed by `-modified` if the sources have uncommitted
    /// changes.
    pub(crate) id: String,
    /// Time of the commit, seconds since 1970.
    pub(crate) seconds: String,
}

impl Commit {
    /// Returns a placeholder, for sources that are not a clone.
    pub(crate) fn unknown() -> Self {
        Self { id: "unknown".to_owned(), seconds: "0".to_owned() }
    }

    pub(crate) fn of_clone() -> Result<Self> {
        let modified = if git(&["status", "--porcelain"])?.is_empty() { "" } else { "-modified" };
        Ok(Self {
            id: git(&["rev-parse", "--short=12", "HEAD"])? + modified,
            seconds: git(&["log", "-1", "--format=%ct"])?,
        })
    }

    /// Passes the commit and its time to a command.
    pub(crate) fn told_to<'a>(&self, command: &'a mut Command) -> &'a mut Command {
        command.env("HTEX_COMMIT", &self.id).env("SOURCE_DATE_EPOCH", &self.seconds)
    }
}

/// Returns git's output without the final line break.
fn git(words: &[&str]) -> Result<String> {
    let output = Command::new("git")
        .args(words)
        .current_dir(workspace())
        .output()
        .context("git, which says what commit is released")?;
    ensure!(output.status.success(), "git {}: {}", words.join(" "), output.status);
    Ok(String::from_utf8(output.stdout)?.trim_end().to_owned())
}
