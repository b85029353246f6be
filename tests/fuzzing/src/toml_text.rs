//! TOML texts made by a grammar: the bytes of the input choose lines, keys and values of recipes,
//! studies and calibrations, and errors between them. Random bytes seldom get past the first line
//! of a text; these do.

use std::path::Path;

use htex_build::Recipe;
use htex_files::toml::{MOST_LEVELS, TomlError, from_str};
use htex_finding::{Findings, plain};
use htex_lab::record::Calibration;
use htex_lab::study::read_study;
use serde_json::Value;

use crate::promise::{findings, sentence};
use crate::studies::STUDY;

/// Stack of the thread that reads, bytes.
const STACK: usize = 256 << 10;
/// Most bytes of a text; readers refuse more than 1 MiB before they parse.
const MOST_BYTES: usize = 300_000;
/// Deepest value that the grammar makes by recursion; repeated pieces nest deeper.
const DEEPEST: usize = 80;

const RECIPE: &str = "[library]\nname = 'vinyls'\n[[textures]]\nrecordings = 'rec/*.csv'\n";
const CALIBRATION: &str = "matrix = [[1, 0, 0, 0, 0, 0], [0, 1, 0, 0, 0, 0], [0, 0, 1, 0, 0, 0], [0, 0, 0, 1, 0, 0], [0, 0, 0, 0, 1, 0], [0, 0, 0, 0, 0, 1]]\n";
/// Whole lines of valid texts.
const LINES: [&str; 12] = [
    "defaults.models = ['ar', 'bands']\n",
    "[defaults.gates]\nmin_segments = 3\n",
    "[[overrides]]\ntextures = ['v*']\n",
    "options.ar.order = 6\n",
    "at = { speed_mm_s = '{1}', force_n = 0.4 }\n",
    "gates = { max_band_error_db = { ar = 1.5 } }\n",
    "[[textures]]\nasset = 'felt.htex'\n",
    "[training]\ntrials = 2\n",
    "motion = { constant = { speed_mm_s = 80, force_n = 0.4 } }\n",
    "phases = ['training', 'gain', 'testing']\n",
    "device = { adapter = 'file', settings = { limit_v = 5 } }\n",
    "participants = ['P01', 'P02']\n",
];
const KEYS: [&str; 16] = [
    "a",
    "library",
    "textures",
    "defaults",
    "options",
    "gates",
    "at",
    "name",
    "models",
    "motion",
    "device",
    "phases",
    "matrix",
    "'org.htex.mfcc'",
    "\"\"",
    "0",
];
const SCALARS: [&str; 16] = [
    "1",
    "-0.5",
    "1e308",
    "nan",
    "-inf",
    "true",
    "'ar'",
    "\"a\\u0000\"",
    "'''b\n'''",
    "1979-05-27T07:32:00Z",
    "07:32:00",
    "0x1F",
    "9223372036854775807",
    "'{stem}'",
    "\"\\e\"",
    "é",
];
/// What a writer leaves out, doubles or misplaces.
const PIECES: [&str; 20] = [
    "{",
    "}",
    "[",
    "]",
    "[[",
    "]]",
    "'",
    "\"",
    "\"\"\"",
    "'''",
    ",",
    "=",
    ".",
    "#",
    "\r",
    "\n",
    "{ const']\n",
    "a = {",
    "a = [",
    "{a.b = ",
];

/// A text of the grammar, read as each kind of file on a small stack.
pub fn toml_text(input: &[u8]) -> bool {
    let text = Grammar::new(input).text();
    let reading = std::thread::Builder::new().stack_size(STACK).spawn(move || read(&text));
    reading.expect("a thread").join().expect("no panic")
}

fn read(text: &str) -> bool {
    let value = from_str::<Value>(text);
    match &value {
        Ok(value) => assert!(depth(value) <= MOST_LEVELS + 1, "{text:.500}"),
        Err(error) => check(text, error),
    }
    let recipe = Recipe::parse(text);
    if let Err(error) = &recipe {
        sentence(&plain(&error.to_string()));
    }
    let mut found = Findings::default();
    let study = read_study(text.as_bytes(), &mut found);
    findings(&found.into_list());
    let calibration = Calibration::parse(Path::new("a.toml"), text);
    if let Err(error) = &calibration {
        sentence(&plain(&error.to_string()));
    }
    if recipe.is_ok() || study.is_some() || calibration.is_ok() {
        assert!(value.is_ok(), "another reader takes {text:.500}");
        return true;
    }
    false
}

/// An error is a sentence with a place in the text.
fn check(text: &str, error: &TomlError) {
    sentence(&plain(&error.to_string()));
    assert!(!error.message.is_empty());
    let line = text.split('\n').nth(error.line - 1);
    let line = line.unwrap_or_else(|| panic!("no line {} in {text:.500}", error.line));
    assert!((1..=line.chars().count() + 1).contains(&error.column));
}

fn depth(value: &Value) -> usize {
    match value {
        Value::Array(items) => 1 + items.iter().map(depth).max().unwrap_or(0),
        Value::Object(object) => 1 + object.values().map(depth).max().unwrap_or(0),
        _ => 0,
    }
}

/// Makes a text; at the end of the bytes, each choice is the first.
struct Grammar<'a> {
    bytes: std::slice::Iter<'a, u8>,
    text: String,
    /// Where the last line begins.
    last: usize,
}

impl<'a> Grammar<'a> {
    fn new(bytes: &'a [u8]) -> Self {
        Self { bytes: bytes.iter(), text: String::new(), last: 0 }
    }

    fn text(mut self) -> String {
        let beginning = [RECIPE, STUDY, CALIBRATION, ""][self.choice(4)];
        self.text.push_str(beginning);
        while self.bytes.len() > 0 && self.text.len() < MOST_BYTES {
            self.line();
        }
        self.text
    }

    fn choice(&mut self, of: usize) -> usize {
        usize::from(*self.bytes.next().unwrap_or(&0)) % of
    }

    fn one_of(&mut self, texts: &[&str]) {
        let chosen = self.choice(texts.len());
        self.text.push_str(texts[chosen]);
    }

    fn line(&mut self) {
        let kind = self.choice(10);
        if kind != 6 {
            self.last = self.text.len();
        }
        match kind {
            0 => self.one_of(&LINES),
            1 => self.around("[", "]\n", Self::key),
            2 => self.around("[[", "]]\n", Self::key),
            3 | 4 => {
                self.pair(0);
                self.text.push('\n');
            }
            5 => self.one_of(&PIECES),
            6 => self.repeat(),
            7 => self.around("# ", "\n", Self::scalar),
            8 => {
                self.key();
                self.text.push_str(" = ");
            }
            _ => {
                let cut = self.choice(8);
                for _ in 0..cut {
                    self.text.pop();
                }
                self.last = self.last.min(self.text.len());
            }
        }
    }

    /// Repeats what came since the last line began, up to some thousand times.
    fn repeat(&mut self) {
        let times = 1 << self.choice(14);
        let line = self.text[self.last..].to_owned();
        let room = (MOST_BYTES - self.text.len().min(MOST_BYTES)) / line.len().max(1);
        self.text.push_str(&line.repeat(room.min(times)));
    }

    fn around(&mut self, before: &str, after: &str, inside: fn(&mut Self)) {
        self.text.push_str(before);
        inside(self);
        self.text.push_str(after);
    }

    fn key(&mut self) {
        // Most keys have no dot, a few have many.
        let parts = match self.choice(32) {
            dots @ 24..=30 => dots - 22,
            31 => 100,
            _ => 1,
        };
        for part in 0..parts {
            let dot = if part == 0 { "" } else { "." };
            self.text.push_str(dot);
            self.one_of(&KEYS);
        }
    }

    fn scalar(&mut self) {
        self.one_of(&SCALARS);
    }

    fn pair(&mut self, depth: usize) {
        self.key();
        self.text.push_str(" = ");
        self.value(depth);
    }

    fn value(&mut self, depth: usize) {
        match self.choice(8) {
            6 if depth < DEEPEST => self.several("[", "]", Self::value, depth),
            7 if depth < DEEPEST => self.several("{ ", " }", Self::pair, depth),
            _ => self.scalar(),
        }
    }

    /// Up to four items between brackets.
    fn several(&mut self, open: &str, close: &str, item: fn(&mut Self, usize), depth: usize) {
        self.text.push_str(open);
        for i in 0..self.choice(5) {
            if i > 0 {
                self.text.push_str(", ");
            }
            item(self, depth + 1);
        }
        self.text.push_str(close);
    }
}
