//! Live motions on the simulated card: their latency, and that the output is zero however playback
//! ends.

use std::io::Write;
use std::process::{Child, Output, Stdio};
use std::time::{Duration, Instant};

use crate::bench::{Bench, GAIN, check_failed};
use crate::common::signal;
use serde_json::json;

/// The promised latency from a motion to the display, milliseconds.
const PROMISED_MS: f64 = 30.0;
/// The longest block of a live motion, milliseconds: a motion that comes while it is made waits for
/// its end.
const BLOCK_MS: f64 = 5.0;

/// Starts playback in real time; the motion follows.
fn begin(bench: &Bench, more: &[&str]) -> Child {
    let mut command = bench.command(&[&["play", "--motion", "-"], more].concat());
    command.env("NIDAQMX_SIM_CLOCK", "wall").stdin(Stdio::piped()).spawn().unwrap()
}

/// False when playback has ended.
fn move_finger(child: &mut Child) -> bool {
    let lines = child.stdin.as_mut().unwrap();
    lines.write_all(b"80 0.4\n").is_ok()
}

/// Plays half a second.
fn played(bench: &Bench, more: &[&str]) -> Output {
    let mut child = begin(bench, more);
    assert!(move_finger(&mut child));
    std::thread::sleep(Duration::from_millis(500));
    child.wait_with_output().unwrap()
}

/// The latency that is printed at the end, milliseconds.
fn latency_ms(done: &Output) -> f64 {
    let text = String::from_utf8_lossy(&done.stdout);
    let rest = text.split("latency ").nth(1).unwrap();
    rest.split(' ').next().unwrap().parse().unwrap()
}

/// On a busy machine so short a buffer may run dry: then the output is zero, and the error names
/// the setting. The test tries again.
#[test]
fn a_live_motion_waits_no_longer_than_is_promised() {
    for _ in 0..20 {
        let bench = Bench::new(json!({ "motion": "live" }));
        let done = played(&bench, &[]);
        if done.status.success() {
            let latency_ms = latency_ms(&done);
            assert!(latency_ms > 0.0, "{latency_ms} ms");
            assert!(latency_ms + 2.0 * BLOCK_MS <= PROMISED_MS, "{latency_ms} ms");
            bench.is_at_zero();
            return;
        }
        check_failed(&done, &["ran dry", "buffer_ms=", "(see --set)"]);
        assert!(bench.card_v().last().is_none_or(|v| *v == 0.0));
    }
    unreachable!("the buffer ran dry in every play");
}

#[test]
fn a_longer_buffer_is_a_persons_to_ask_for() {
    let bench = Bench::new(json!({ "motion": "live" }));
    let done = played(&bench, &["--set", "buffer_ms=300"]);
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    assert!(latency_ms(&done) > 100.0, "{}", latency_ms(&done));
}

/// The guardian takes the output to zero, as it does with a long buffer.
#[test]
fn a_live_player_that_is_killed_or_stopped_leaves_zero() {
    for name in ["-KILL", "-STOP"] {
        let (bench, mut child) = felt();
        signal(&child, name);
        bench.comes_to_zero();
        let _ = child.kill();
        let _ = child.wait();
    }
}

/// A live playback with output; on a busy machine not necessarily the first try.
fn felt() -> (Bench, Child) {
    let begun = Instant::now();
    while begun.elapsed() < Duration::from_secs(60) {
        let bench = Bench::new(json!({ "motion": "live" }));
        let mut child = begin(&bench, &[]);
        while move_finger(&mut child) {
            if bench.card_v().iter().any(|v| v.abs() * GAIN >= 1.0) {
                return (bench, child);
            }
            std::thread::sleep(Duration::from_millis(5));
        }
        let _ = child.wait();
    }
    unreachable!("nothing comes out")
}
