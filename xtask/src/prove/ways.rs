//! Runs every command in `docs/ways` as a reader would, with the files of a release, and compares
//! its output with the page.
//!
//! The blocks of a page are processed in order:
//!
//! - All `sh` blocks run in one folder. Variables that a block exports keep their values in later
//!   blocks.
//! - A `text` block is the expected output of the block before it. In it, `…` stands for any lines,
//!   or within a line for any text.
//! - A block in another language begins with a comment that names the file to which the block is
//!   saved.
//! - A `js` block is an example of the npm package, whose tests run it.
//!
//! The commands make the pictures in `docs/figures/ways`.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Instant;

use anyhow::{Context, Result, bail, ensure};
use clap::Args;
use fs_err as fs;

use crate::markdown::{Block, blocks, links};
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
        follow(name, &folder, options.write)?;
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
    fs::write(place.join("exported"), "")?;
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

#[cfg(unix)]
fn link(to: &Path, at: &Path) -> Result<()> {
    Ok(fs::os::unix::fs::symlink(to, at)?)
}

#[cfg(not(unix))]
fn link(_: &Path, at: &Path) -> Result<()> {
    bail!("{}: the commands on the pages need a Unix shell", at.display())
}

/// Processes the blocks of a page in order.
fn follow(name: &str, folder: &Path, write: bool) -> Result<()> {
    let page = workspace().join(format!("docs/ways/{name}.md"));
    let text = fs::read_to_string(&page)?;
    let all = blocks(&text);
    let mut others = Vec::new();
    for (index, block) in all.iter().enumerate() {
        let place = format!("docs/ways/{name}.md:{}", block.line);
        match &*block.language {
            "sh" => {
                let printed = run(block, folder).with_context(|| place.clone())?;
                let expected = all.get(index + 1).filter(|next| next.language == "text");
                let Some(expected) = expected else { continue };
                match difference(&expected.text, &printed) {
                    Some(_) if write => others.push((expected.range.clone(), printed)),
                    Some(line) => {
                        let line = expected.line + line;
                        bail!(
                            "docs/ways/{name}.md:{line}: another output, which `--write` writes into the page:\n{printed}"
                        );
                    }
                    None => {}
                }
            }
            "text" => {}
            language => match saved_as(block) {
                Some(file) => fs::write(folder.join(file), &block.text)?,
                None => ensure!(
                    language == "js" && is_example_of_npm(block)?,
                    "{place}: the first line names no file"
                ),
            },
        }
    }
    if others.is_empty() {
        return Ok(());
    }
    let mut text = text;
    for (range, printed) in others.into_iter().rev() {
        text.replace_range(range, &printed);
    }
    Ok(fs::write(&page, text)?)
}

/// Whether the README of the npm package contains the same block.
fn is_example_of_npm(block: &Block) -> Result<bool> {
    let readme = fs::read_to_string(workspace().join("sdk/bindings/web/README.md"))?;
    Ok(blocks(&readme).iter().any(|example| example.language == "js" && example.text == block.text))
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

/// Returns the file that a block's first line names: `/* play.c */`, `// play.c` or `# play.py`.
fn saved_as(block: &Block) -> Option<&str> {
    let line = block.text.lines().next()?;
    let name = line.trim_start_matches(['/', '*', '#', ' ']).trim_end_matches(['/', '*', ' ']);
    let is_file = name.contains('.') && !name.contains([' ', '/', '"', '(']);
    (is_file && name.len() < line.len()).then_some(name)
}

/// Runs the commands of a block in a shell, and returns what they print. The shell stops at the
/// first failure.
fn run(block: &Block, folder: &Path) -> Result<String> {
    let exported = folder.with_file_name("exported");
    let exported = exported.display();
    let script = format!("set -eu\n. '{exported}'\n{}\nexport -p >'{exported}'\n", block.text);
    let printed = folder.with_file_name("printed");
    let out = fs::File::create(&printed)?.into_parts().0;
    let mut shell = Command::new("sh");
    shell.args(["-c", &script]).current_dir(folder).stdin(Stdio::null());
    shell.stdout(out.try_clone()?).stderr(out);
    let home = folder.with_file_name("home");
    fs::create_dir_all(&home)?;
    // The commands must not find models, devices or settings of the user. The folders of cargo and
    // pip stay the same.
    shell.env("HTEX_CONFIG_DIR", &home).env("XDG_DATA_HOME", &home);
    shell.env("LC_ALL", "C.UTF-8").env("MPLCONFIGDIR", &home);
    for name in ["HTEX_PLUGIN_PATH", "HTEX_DEVICE_PATH", "CARGO_TARGET_DIR"] {
        shell.env_remove(name);
    }
    let status = shell.status().context("sh")?;
    let printed = fs::read_to_string(printed)?;
    let printed: String = printed.lines().map(|line| format!("{}\n", line.trim_end())).collect();
    ensure!(status.success(), "{status} of\n{}\nwhich printed\n{printed}", block.text);
    Ok(printed)
}

/// Returns the first expected line that is missing in the output; `None` if both agree.
fn difference(expected: &str, printed: &str) -> Option<usize> {
    let expected: Vec<&str> = expected.lines().collect();
    let printed: Vec<&str> = printed.lines().collect();
    let mut furthest = 0;
    let is_same = agree(&expected, &printed, 0, &mut furthest);
    (!is_same).then_some(furthest)
}

/// Whether the printed lines are the expected ones. An expected line `…` stands for any lines. `at`
/// is the number of expected lines that agree so far, and `furthest` the largest such number.
fn agree(expected: &[&str], printed: &[&str], at: usize, furthest: &mut usize) -> bool {
    *furthest = at.max(*furthest);
    match (expected.split_first(), printed.split_first()) {
        (None, None) => true,
        (Some((&"…", rest)), _) => {
            (0..=printed.len()).any(|skipped| agree(rest, &printed[skipped..], at + 1, furthest))
        }
        (Some((line, rest)), Some((first, others))) => {
            is_line(line, first) && agree(rest, others, at + 1, furthest)
        }
        _ => false,
    }
}

/// Whether a line is the expected one. In the expected line, `…` stands for any text.
fn is_line(expected: &str, printed: &str) -> bool {
    let Some((before, after)) = expected.trim_end().split_once('…') else {
        return expected.trim_end() == printed;
    };
    let Some(rest) = printed.strip_prefix(before) else {
        return false;
    };
    let starts = rest.char_indices().map(|(at, _)| at).chain([rest.len()]);
    starts.into_iter().any(|at| is_line(after, &rest[at..]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dots_stand_for_lines_and_for_text() {
        assert_eq!(difference("a\n…\nd\n", "a\nb\nc\nd\n"), None);
        assert_eq!(difference("a\n…\n", "a\n"), None);
        assert_eq!(difference("took … s, 2 files\n", "took 0.31 s, 2 files\n"), None);
        assert_eq!(difference("a\nb\n", "a\nc\n"), Some(1));
        assert_eq!(difference("a\n", "a\nb\n"), Some(1));
        assert_eq!(difference("a\n…\nd\n", "a\nb\n"), Some(2));
    }

    #[test]
    fn the_first_line_names_the_file() {
        let block =
            |language: &str, text: &str| blocks(&format!("```{language}\n{text}\n```\n")).remove(0);
        assert_eq!(saved_as(&block("c", "/* play.c */\nint x;")), Some("play.c"));
        assert_eq!(saved_as(&block("toml", "# library.toml\na = 1")), Some("library.toml"));
        assert_eq!(saved_as(&block("js", "import { open } from \"htex\";")), None);
        assert_eq!(saved_as(&block("python", "import htex.study")), None);
    }

    #[test]
    fn each_page_of_the_ways_is_proved() {
        for file in files(&workspace().join("docs/ways")).unwrap() {
            let name = file.file_stem().unwrap().to_string_lossy().into_owned();
            assert!(WAYS.iter().any(|(way, _)| *way == name), "{name}");
        }
    }
}
