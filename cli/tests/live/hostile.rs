//! Hostile models, through the command: each gives one sentence on standard error that names the
//! model and the call, and exit status 1, within bounded time and memory.

#[path = "../../../sdk/core/host/tests/it/common/mod.rs"]
mod model;

use std::time::Duration;

use crate::common::Place;
use crate::common::measured::run;
use model::{ID, text};

/// Longest time of a call, given to the command.
const DEADLINE: Duration = Duration::from_millis(500);
/// Further processor time that is allowed: compiling, and the command's own work.
const BESIDES: Duration = Duration::from_secs(1);
const MOST_MEMORY_KIB: i64 = 300 << 10;

/// A folder with a recording, in which commands are given hostile models.
struct Bench(Place);

impl Bench {
    fn new() -> Self {
        let place = Place::new();
        place.recording("sandpaper");
        Self(place)
    }

    /// Runs the command with the module; the error names the model and each of `words`.
    fn refuses(&self, arguments: &[&str], wat: &str, words: &[&str]) {
        let what = format!("{arguments:?}: {words:?}");
        self.0.write("harm.wasm", wat::parse_str(wat).unwrap());
        let deadline = DEADLINE.as_millis();
        let (call, render) = (format!("call-ms={deadline}"), format!("render-ms={deadline}"));
        let limits = ["--wasm-limit", &call, "--wasm-limit", &render];
        let mut command = self.0.command(&[arguments, &limits[..]].concat());
        command.env("HTEX_CACHE_DIR", self.0.path("cache"));
        let end = run(&mut command, &self.0.path("errors"));
        println!("{what}: {:?} of processor time, {} KiB", end.cpu, end.memory_kib);
        assert_eq!(end.code, 1, "{what}: {}", end.error);
        let error = end.error.lines().last().unwrap_or_default();
        let named = error.contains("harm.wasm") || error.contains(ID);
        assert!(named && words.iter().all(|word| error.contains(word)), "{what}: {error}");
        assert!(
            end.error.lines().filter(|l| l.contains("error")).count() <= 1,
            "{what}: {}",
            end.error
        );
        assert!(end.cpu < DEADLINE + BESIDES, "{what}: {:?}", end.cpu);
        assert!(end.memory_kib < MOST_MEMORY_KIB, "{what}: {} KiB", end.memory_kib);
    }

    fn fit_refuses(&self, changed: &[(&str, &str)], words: &[&str]) {
        let fit = ["fit", "sandpaper.csv", "--plugin", "harm.wasm", "--model", ID, "-o", "x.htex"];
        self.refuses(&fit, &text("1.0.0", changed, ""), words);
        assert!(!self.0.path("x.htex").exists(), "nothing is left of a fit that failed");
    }

    fn info_refuses(&self, wat: &str, words: &[&str]) {
        self.refuses(&["plugin", "info", "harm.wasm"], wat, words);
    }
}

/// Bodies that do not return normally, and the error's text.
const HARM: [(&str, &str); 5] = [
    ("(loop $l (br $l)) unreachable", "ran longer than 500 ms"),
    ("unreachable", "panicked"),
    ("(drop (i32.load (i32.const -4))) unreachable", "out of bounds memory access"),
    ("(loop $l (drop (memory.grow (i32.const 16))) (br $l)) unreachable", "67108864 bytes"),
    ("(drop (call $deep (i32.const -1))) unreachable", "bytes of stack"),
];

/// A magnitude that is the same everywhere: the bytes 3f3f3f3f3f3f3f3f.
const FLAT: &str =
    "(memory.fill (local.get 5) (i32.const 0x3f) (i32.shl (local.get 6) (i32.const 3)))
                    (i64.const 0)";

#[test]
fn harm_in_a_call_of_the_pipeline() {
    let bench = Bench::new();
    let others = ["magnitude", "voice_rate", "voice_new", "voice_render"];
    for (call, (body, reason)) in
        HARM.map(|harm| ("fit", harm)).into_iter().chain(others.into_iter().zip(HARM))
    {
        // A magnitude of zero everywhere ends a fit before there is a voice.
        let mut changed = vec![(call, body)];
        if call != "magnitude" {
            changed.push(("magnitude", FLAT));
        }
        bench.fit_refuses(&changed, &[call, reason]);
    }
}

#[test]
fn harm_before_the_first_call() {
    let bench = Bench::new();
    for (body, reason) in HARM {
        bench.info_refuses(&text("1.0.0", &[("abi_version", body)], ""), &["abi_version", reason]);
    }
    let (body, reason) = HARM[0];
    bench.info_refuses(&text("1.0.0", &[("descriptor", body)], ""), &["descriptor", reason]);
    let start = format!("(func $start {body}) (start $start)");
    bench.info_refuses(&text("1.0.0", &[], &start), &["start", reason]);
}

#[test]
fn a_giant_descriptor_is_refused() {
    let giant = [("descriptor", "(i64.const 1000000000)")];
    Bench::new().info_refuses(&text("1.0.0", &giant, ""), &["1000000000 bytes"]);
}

#[test]
fn limits_are_named_when_they_cannot_be_set() {
    let place = Place::new();
    for (limit, word) in
        [("time=1", "memory-mib"), ("call-ms=0", "from 1"), ("fuel", "whole number")]
    {
        let run = place.run(&["plugin", "list", "--wasm-limit", limit]);
        assert_eq!(run.code(), 2, "{limit}");
        assert!(run.error().contains(word), "{limit}: {}", run.error());
    }
}
