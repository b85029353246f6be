//! Runs every command in `docs/ways` as a reader would, with the files of a release, and compares
//! its output with the page ([`follow`]).
//!
//! The commands make the pictures in `docs/figures/ways`.

use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::{Result, ensure};
use clap::Args;
use fs_err as fs;

use super::pages::{follow, link};
use crate::markdown::links;
use crate::places::{files, target, workspace};

/// Longest time that a page may take a reader.
const MOST_SECONDS: f64 = 600.0;

/// The beginning of the links to pictures in these pages.
const PICTURES: &str = "../figures/ways/";

/// Parts of the names of files for other machines. A reader ignores those files.
const OTHERS: [&str; 4] = ["aarch64", "arm64", "win", "macos"];

/// The pages, and whether each uses the sources of htex.
const WAYS: [(&str, bool); 5] = [
    ("recordings", false),
    ("models", true),
    ("apps", false),
    ("lab", false),
    ("libraries", false),
];

#[derive(Debug, Args)]
pub struct Options {
    /// The folder to which `cargo xtask release --out DIR` wrote
    #[arg(long, value_name = "DIR")]
    release: PathBuf,
    /// Run only this page: recordings, models, apps, lab or libraries [default: all]
    #[arg(long, value_name = "NAME")]
    only: Option<String>,
    /// Replace the output in the pages by what the commands print
    #[arg(long)]
    write: bool,
}

/// Runs the pages, or the page given by `--only`.
pub(super) fn prove(options: &Options) -> Result<()> {
    let release = fs::canonicalize(&options.release)?;
    let chosen = |name: &str| options.only.as_deref().is_none_or(|only| only == name);
    let ways: Vec<_> = WAYS.iter().filter(|(name, _)| chosen(name)).collect();
    ensure!(
        !ways.is_empty(),
        "no page of that name; there are {}",
        WAYS.map(|(name, _)| name).join(", ")
    );
    for (name, with_sources) in ways {
        let begin = Instant::now();
        let folder = prepare(name, &release, *with_sources)?;
        follow(&format!("docs/ways/{name}.md"), &folder, &[], options.write)?;
        pictures(name, &folder, options.write)?;
        let seconds = begin.elapsed().as_secs_f64();
        println!("docs/ways/{name}.md: {seconds:.1} s");
        ensure!(seconds < MOST_SECONDS, "docs/ways/{name}.md takes longer than ten minutes");
    }
    Ok(())
}

/// Makes a folder with the files of the release for one page.
fn prepare(name: &str, release: &Path, with_sources: bool) -> Result<PathBuf> {
    let place = std::path::absolute(target().join("ways").join(name))?;
    crate::places::emptied(&place)?;
    let folder = place.join("here");
    fs::create_dir_all(&folder)?;
    for file in files(release)? {
        let name = file.file_name().unwrap_or_default();
        let is_other = OTHERS.iter().any(|other| name.to_string_lossy().contains(other));
        if !is_other {
            link(&file, &folder.join(name))?;
        }
    }
    if with_sources {
        let sources = fs::canonicalize(workspace())?;
        link(&sources, &folder.join("sources"))?;
    }
    Ok(folder)
}

/// Compares a page's pictures with the pictures that its commands made. The pictures in subfolders
/// come from Python. Their bytes depend on the version of matplotlib, so they only have to exist.
fn pictures(name: &str, folder: &Path, write: bool) -> Result<()> {
    let text = fs::read_to_string(workspace().join(format!("docs/ways/{name}.md")))?;
    let shown = links(&text).into_iter().filter_map(|link| text[link].strip_prefix(PICTURES));
    for picture in shown {
        let page = workspace().join("docs/figures/ways").join(picture);
        let made = folder.join(picture);
        let below = folder.join("results/figures").join(picture);
        match (made.exists(), write) {
            (true, true) => drop(fs::copy(made, page)?),
            (true, false) => ensure!(
                fs::read(made)? == fs::read(&page)?,
                "docs/ways/{name}.md: the commands make another {picture}, which `--write` copies"
            ),
            (false, true) => drop(fs::copy(below, page)?),
            (false, false) => {
                ensure!(below.exists(), "docs/ways/{name}.md: no command makes {picture}")
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_page_of_the_ways_is_proved() {
        for file in files(&workspace().join("docs/ways")).unwrap() {
            let name = file.file_stem().unwrap().to_string_lossy().into_owned();
            assert!(WAYS.iter().any(|(way, _)| *way == name), "{name}");
        }
    }
}
