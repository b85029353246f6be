//! Prints hashes of all files and texts that the command writes, one per line. The inputs are
//! always the same.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use anyhow::{Context, Result};
use clap::Args;
use fs_err as fs;

use crate::places::{cargo, target, workspace};
use crate::programs::{program, run};

/// The command lines, in order. A word in braces, such as `{COMMAND}`, stands for several words:
/// the line runs with each of them.
const LINES: &str = include_str!("outputs.txt");

/// Folders and files of the workspace that the commands read.
const INPUTS: [&str; 8] = [
    "examples/scenes",
    "spec/conformance",
    "spec/library-conformance",
    "spec/recording-conformance",
    "spec/scene-conformance",
    "tests/golden/study",
    "xtask/src/prove/library.toml",
    "xtask/src/prove/study.toml",
];

/// Endings of JSON keys with measured times, which differ between runs.
const TIMED: [&str; 6] =
    ["_ms\":", "_us\":", "ns_per_sample\":", "seconds\":", "spread\":", "on_time_front\":"];

#[derive(Debug, Args)]
pub struct Options {
    /// The command to run [default: the command of this workspace, which is then built]
    #[arg(long, value_name = "PATH")]
    htex: Option<PathBuf>,
}

pub(super) fn prove(options: &Options) -> Result<()> {
    let htex = match &options.htex {
        Some(path) => std::path::absolute(path)?,
        None => built()?,
    };
    let folder = target().join("outputs");
    prepare(&folder)?;
    let texts = Texts::new(&htex, &folder)?;
    for line in LINES.lines().filter(|line| !line.starts_with('#')) {
        for line in texts.expand(line) {
            print(&htex, &folder, &line)?;
        }
    }
    hash(&folder)
}

/// Builds the command, and returns its path.
fn built() -> Result<PathBuf> {
    let mut build = Command::new(cargo());
    build.args(["build", "--release", "--locked", "--package", "htex-cli"]);
    run(build.current_dir(workspace()))?;
    Ok(std::path::absolute(target().join("release/htex"))?)
}

/// Makes an empty folder that contains the inputs and a folder for printed output.
fn prepare(folder: &Path) -> Result<()> {
    crate::places::emptied(folder)?;
    fs::create_dir_all(folder.join("printed"))?;
    let inputs = INPUTS.map(|input| workspace().join(input));
    run(Command::new("cp").arg("-R").args(inputs).arg(folder))
}

/// Runs the command in the folder, without any of the user's models, devices or settings.
fn htex(htex: &Path, folder: &Path, line: &str) -> Result<Output> {
    let mut command = program(htex, folder);
    command.args(line.split_whitespace()).env_clear();
    let output = command.env("HOME", folder.join("home")).output();
    output.with_context(|| htex.display().to_string())
}

/// Runs a command and stores its output, with its status, in a file named after it.
fn print(command: &Path, folder: &Path, line: &str) -> Result<()> {
    let output = htex(command, folder, line)?;
    let text = [output.stdout, output.stderr].concat();
    let mut text = without_times(&String::from_utf8_lossy(&text));
    text += &format!("{}\n", output.status);
    let file = folder.join("printed").join(line.replace('/', "+"));
    Ok(fs::write(&file, text)?)
}

/// Removes measured times from a text, and the results of a sweep that depend on the times.
fn without_times(text: &str) -> String {
    let decided = text.split("\"knees\"").next().unwrap_or(text);
    let timed = |value: &&str| TIMED.iter().any(|key| value.contains(key));
    let kept = decided.split(',').filter(|value| !timed(value));
    kept.collect::<Vec<_>>().join(",")
}

/// Prints the hash of each file that is not an input, in the order of names.
fn hash(folder: &Path) -> Result<()> {
    let skipped = INPUTS.map(|input| input.rsplit('/').next().unwrap_or(input));
    let mut find = program("find", folder);
    find.args(["-type", "f"]);
    for name in skipped {
        find.args(["-not", "-path", &format!("./{name}*")]);
    }
    // The cache of builds contains file times, and a sweep's page contains its measured times.
    find.args(["-not", "-path", "*/.htex-build/*", "-not", "-path", "./home/*"]);
    find.args(["-not", "-name", "tradeoff.*", "-print"]);
    let found = find.output().context("find")?;
    let found = String::from_utf8_lossy(&found.stdout).into_owned();
    let mut files: Vec<&str> = found.lines().collect();
    // `find` lists files in the order of the file system, which differs between machines.
    files.sort_unstable();
    // The length of a command line is limited.
    for some in files.chunks(500) {
        run(program("sha256sum", folder).args(some))?;
    }
    Ok(())
}

/// The words in braces, and the words for which each stands.
struct Texts(Vec<(&'static str, Vec<String>)>);

impl Texts {
    fn new(command: &Path, folder: &Path) -> Result<Self> {
        let owned = |words: &[&str]| words.iter().map(|word| (*word).to_owned()).collect();
        let mut conformance = Vec::new();
        for place in INPUTS.iter().filter_map(|input| input.strip_prefix("spec/")) {
            for file in crate::places::files(&folder.join(place))? {
                let name = file.file_name().unwrap_or_default().to_string_lossy().into_owned();
                if !name.ends_with(".report.json") {
                    conformance.push(format!("{place}/{name}"));
                }
            }
        }
        Ok(Self(vec![
            ("{MODEL}", firsts(command, folder, "plugin list")?),
            ("{SURFACE}", owned(&SURFACES)),
            ("{RATE}", owned(&["8000", "20000", "48000"])),
            ("{CODE}", firsts(command, folder, "explain")?),
            ("{COMMAND}", firsts(command, folder, "--help")?),
            ("{CONFORMANCE}", conformance),
        ]))
    }

    /// Returns the line once for every combination of words.
    fn expand(&self, line: &str) -> Vec<String> {
        let mut lines = vec![line.to_owned()];
        for (place, words) in &self.0 {
            if line.contains(place) {
                let with = |line: &String| {
                    words.iter().map(|word| line.replace(place, word)).collect::<Vec<_>>()
                };
                lines = lines.iter().flat_map(with).collect();
            }
        }
        lines
    }
}

/// Returns the first word of each line that the command prints. From the command's help, takes only
/// the subcommands, which are indented under the headings of their groups.
fn firsts(command: &Path, folder: &Path, line: &str) -> Result<Vec<String>> {
    let printed = htex(command, folder, line)?.stdout;
    let printed = String::from_utf8_lossy(&printed);
    let help = printed.split_once("\nOptions:\n").map(|(commands, _)| commands);
    let lines = help.unwrap_or(&printed).lines();
    let lines = lines.filter(|line| help.is_none() || line.starts_with("  "));
    let first = |line: &str| line.split_whitespace().next().map(str::to_owned);
    Ok(lines.filter_map(first).collect())
}

const SURFACES: [&str; 5] =
    ["sandpaper", "fine-fabric", "coarse-fabric", "corrugated-paper", "vinyl"];
