//! Running `htex` as a user does.
#![allow(dead_code)] // Each suite uses a part of it.

#[cfg(target_os = "linux")]
pub mod measured;
#[cfg(unix)]
pub mod native;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use serde_json::{Value, json};
use tempfile::TempDir;

/// Files by their paths in a folder.
pub type Files = BTreeMap<PathBuf, Vec<u8>>;

/// A folder to work in.
pub struct Place(TempDir);

pub struct Run(Output);

impl Place {
    pub fn new() -> Self {
        Self(TempDir::new().unwrap())
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub fn write(&self, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
        std::fs::write(self.path(name), bytes).unwrap();
        self.path(name)
    }

    /// The command, in this folder.
    pub fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_htex"));
        command.args(arguments).current_dir(self.0.path());
        command
    }

    pub fn run(&self, arguments: &[&str]) -> Run {
        Run(self.command(arguments).output().unwrap())
    }

    /// Runs, expects success, reads standard output as JSON.
    pub fn json(&self, arguments: &[&str]) -> Value {
        let run = self.run(arguments);
        assert_eq!(run.code(), 0, "{arguments:?}: {}", run.error());
        serde_json::from_slice(&run.0.stdout).unwrap()
    }

    /// A scene of an asset, with `more` over it.
    pub fn scene(&self, name: &str, asset: &str, more: &Value) -> PathBuf {
        let mut scene = json!({
            "htex_scene": "1.0",
            "surfaces": [{ "asset": asset }],
            "motion": { "constant": { "speed_mm_s": 80, "force_n": 0.4 } },
        });
        for (key, value) in more.as_object().unwrap() {
            scene[key] = value.clone();
        }
        self.write(name, scene.to_string())
    }

    /// A simulated recording of 4 s.
    pub fn recording(&self, surface: &str) -> String {
        let name = format!("{surface}.csv");
        self.simulated(&name, &["--surface", surface, "--seconds", "4"]);
        name
    }

    /// A recording that `htex simulate` makes by these arguments, once per test program.
    pub fn simulated(&self, name: &str, arguments: &[&str]) {
        static MADE: Mutex<BTreeMap<String, Vec<u8>>> = Mutex::new(BTreeMap::new());
        let mut made = MADE.lock().unwrap_or_else(PoisonError::into_inner);
        let recording = made.entry(arguments.join(" ")).or_insert_with(|| {
            let place = Self::new();
            let run = place.run(&[&["simulate"], arguments, &["-o", "rec.csv"]].concat());
            assert_eq!(run.code(), 0, "{}", run.error());
            std::fs::read(place.path("rec.csv")).unwrap()
        });
        self.write(name, recording);
    }

    /// The samples of a WAV file.
    pub fn samples(&self, name: &str) -> Vec<f32> {
        let wav = hound::WavReader::open(self.path(name)).unwrap();
        wav.into_samples().map(Result::unwrap).collect()
    }

    /// A folder with copies of files that were made once per test program.
    pub fn with(files: &Files) -> Self {
        let place = Self::new();
        for (name, bytes) in files {
            std::fs::create_dir_all(place.0.path().join(name).parent().unwrap()).unwrap();
            std::fs::write(place.0.path().join(name), bytes).unwrap();
        }
        place
    }

    /// The files of this folder and of the folders in it.
    pub fn files(&self) -> Files {
        let (mut files, mut folders) = (Files::new(), vec![self.0.path().to_owned()]);
        while let Some(folder) = folders.pop() {
            for entry in std::fs::read_dir(folder).unwrap() {
                let path = entry.unwrap().path();
                if path.is_dir() {
                    folders.push(path);
                } else {
                    let name = path.strip_prefix(self.0.path()).unwrap().to_owned();
                    files.insert(name, std::fs::read(path).unwrap());
                }
            }
        }
        files
    }
}

impl Run {
    pub fn of(output: Output) -> Self {
        Self(output)
    }

    pub fn code(&self) -> i32 {
        self.0.status.code().unwrap()
    }

    pub fn error(&self) -> String {
        String::from_utf8(self.0.stderr.clone()).unwrap()
    }

    pub fn text(&self) -> String {
        String::from_utf8(self.0.stdout.clone()).unwrap()
    }

    /// Exit status, and one sentence with these words.
    pub fn failed(&self, code: i32, words: &[&str]) {
        let error = self.error();
        assert_eq!(self.code(), code, "{error}");
        for word in words {
            assert!(error.contains(word), "{word}: {error}");
        }
    }
}

pub fn rms(samples: &[f32]) -> f64 {
    let power: f64 = samples.iter().map(|x| f64::from(*x).powi(2)).sum();
    (power / samples.len() as f64).sqrt()
}

/// Waits until something is so, for a minute at most.
pub fn until(what: &str, mut is_so: impl FnMut() -> bool) {
    let start = Instant::now();
    while !is_so() {
        assert!(start.elapsed() < Duration::from_secs(60), "not in a minute: {what}");
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// Sends a program a signal, e.g. `-INT`.
pub fn signal(child: &Child, name: &str) {
    let id = child.id().to_string();
    let sent = Command::new("kill").args([name, &id]).status();
    assert!(sent.unwrap().success());
}

/// Numbers by SplitMix64 (Steele, Lea and Flood 2014): the same on every machine.
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    pub fn below(&mut self, bound: usize) -> usize {
        (self.next() % bound as u64) as usize
    }

    /// Whether one of `n` times.
    pub fn one_in(&mut self, n: usize) -> bool {
        self.below(n) == 0
    }

    pub fn of<T: Clone>(&mut self, all: &[T]) -> T {
        all[self.below(all.len())].clone()
    }
}

/// The words of a line, e.g. of a command.
pub fn words(line: &str) -> Vec<&str> {
    line.split_whitespace().collect()
}

/// What the manifest in a summary states of a representation at its first condition.
pub fn stated(summary: &Value, index: usize) -> &Value {
    &summary["manifest"]["representations"][index]["at"][0]
}

/// What a summary computes of a representation at its first condition.
pub fn computed(summary: &Value, index: usize) -> &Value {
    &summary["representations"][index]["at"][0]
}

/// The numbers of a JSON array.
pub fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
}

/// The only other entries of a folder than those expected (leftovers of an interrupted write).
pub fn entries(dir: &Path) -> Vec<String> {
    let names = std::fs::read_dir(dir).unwrap();
    let mut names: Vec<String> =
        names.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}
