//! Follows a Markdown page: runs its commands, and compares their output with the page.
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
//! - A `rust` block is part of a program, and is ignored.

use std::ffi::OsStr;
use std::path::Path;
use std::process::{Command, Stdio};

use anyhow::{Context, Result, bail, ensure};
use fs_err as fs;

use crate::markdown::{Block, blocks};
use crate::places::workspace;
use crate::programs::forget_package;

/// Processes the blocks of a page in order. `name` is the path of the page in the workspace. The
/// commands run in `folder`, with additional environment variables. The folder above `folder` gets
/// some files. With `write`, writes the output of the commands into the page.
pub(super) fn follow(
    name: &str,
    folder: &Path,
    variables: &[(&str, &OsStr)],
    write: bool,
) -> Result<()> {
    let page = workspace().join(name);
    let text = fs::read_to_string(&page)?;
    fs::write(folder.with_file_name("exported"), "")?;
    let all = blocks(&text);
    let mut others = Vec::new();
    for (index, block) in all.iter().enumerate() {
        let place = format!("{name}:{}", block.line);
        match &*block.language {
            "sh" => {
                let printed = run(block, folder, variables).with_context(|| place.clone())?;
                let expected = all.get(index + 1).filter(|next| next.language == "text");
                let Some(expected) = expected else { continue };
                match difference(&expected.text, &printed) {
                    Some(_) if write => others.push((expected.range.clone(), printed)),
                    Some(line) => {
                        let line = expected.line + line;
                        bail!(
                            "{name}:{line}: another output, which `--write` writes into the page:\n{printed}"
                        );
                    }
                    None => {}
                }
            }
            "text" | "rust" => {}
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

/// Returns the file that a block's first line names: `/* play.c */`, `// play.c` or `# play.py`.
fn saved_as(block: &Block) -> Option<&str> {
    let line = block.text.lines().next()?;
    let name = line.trim_start_matches(['/', '*', '#', ' ']).trim_end_matches(['/', '*', ' ']);
    let is_file = name.contains('.') && !name.contains([' ', '/', '"', '(']);
    (is_file && name.len() < line.len()).then_some(name)
}

/// Runs the commands of a block in a shell, and returns what they print. The shell stops at the
/// first failure.
fn run(block: &Block, folder: &Path, variables: &[(&str, &OsStr)]) -> Result<String> {
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
    shell.envs(variables.iter().copied());
    let status = forget_package(&mut shell).status().context("sh")?;
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

/// Makes a symbolic link.
#[cfg(unix)]
pub(super) fn link(to: &Path, at: &Path) -> Result<()> {
    Ok(fs::os::unix::fs::symlink(to, at)?)
}

#[cfg(not(unix))]
pub(super) fn link(_: &Path, at: &Path) -> Result<()> {
    bail!("{}: the commands on the pages need a Unix shell", at.display())
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
}
