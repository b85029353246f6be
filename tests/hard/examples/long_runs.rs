//! Runs every model for a day:
//! `cargo run --release -p htex-hard-cases --no-default-features --example long_runs`.
//! `--hours N` sets another length, `--json` prints JSON for scripts. The exit status is 1 if a
//! bound is broken.

use std::process::ExitCode;

use htex_hard_cases::long::{Blocks, Run, drift_db, phase_error_cycles, run};
use htex_hard_cases::seen::models;
use serde_json::{Value, json};

/// Largest difference between hours, decibels.
const DRIFT_DB: f64 = 0.05;
/// Largest ratio of the time per sample in the last minute to the first minute, which is rendered
/// again in turns.
const SLOWDOWN: f64 = 1.1;
const PHASE_CYCLES: f64 = 1e-6;
/// Duration, for each seed, in which blocks are compared, seconds.
const COMPARED_S: f64 = 3_600.0;
const SEEDS: [u64; 4] = [0, 1, 2, u64::MAX];

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let json = arguments.iter().any(|a| a == "--json");
    let after = |name: &str| arguments.iter().skip_while(|a| *a != name).nth(1).cloned();
    let known =
        |a: &String| ["--json", "--hours"].contains(&a.as_str()) || a.parse::<f64>().is_ok();
    let hours = after("--hours").map_or(Ok(24.0), |text| text.parse::<f64>());
    let (Ok(hours), true) = (hours, arguments.iter().all(known)) else {
        eprintln!("usage: long_runs [--hours N] [--json]; N is 2 or more");
        return ExitCode::from(2);
    };
    if !(2.0..=1e4).contains(&hours) {
        eprintln!("--hours {hours}: 2 to 10000 are allowed");
        return ExitCode::from(2);
    }
    let rows = voices(hours, json);
    let phases = phases(hours, json);
    let holds = rows.iter().chain(&phases).all(|row| row["holds"] == true);
    if json {
        println!("{}", json!({ "hours": hours, "voices": rows, "phases": phases }));
    }
    ExitCode::from(u8::from(!holds))
}

fn voices(hours: f64, quiet: bool) -> Vec<Value> {
    if !quiet {
        println!(
            "model     rate/Hz  Msamples  drift/dB  level/dB  broken  ns first  ns last  ratio  blocks  repeated"
        );
    }
    let rows = models().into_iter().map(|model| {
        let day = run(&model, 1, 3_600.0 * hours, 3_600.0, None);
        let (blocks, repeated) = compare(&model);
        let row = row(model.short_name(), &day, blocks, repeated);
        if !quiet {
            println!(
                "{:8} {:8} {:9.1} {:9.4} {:+9.4} {:7} {:9.2} {:8.2} {:6.3} {:7} {:9}{}",
                model.short_name(),
                day.rate_hz,
                day.samples as f64 / 1e6,
                drift_db(&day.power),
                row["level_db"].as_f64().unwrap_or(f64::NAN),
                day.broken,
                day.ns_per_sample.0,
                day.ns_per_sample.1,
                day.ns_per_sample.1 / day.ns_per_sample.0,
                blocks,
                repeated,
                if row["holds"] == true { "" } else { "  <- beyond its bound" }
            );
        }
        row
    });
    rows.collect()
}

/// Compares an hour of blocks for each seed. Returns the number of blocks, and of repeated blocks.
fn compare(model: &htex_host::LoadedModel) -> (usize, u64) {
    let mut blocks = Blocks::new();
    let repeated =
        SEEDS.map(|seed| run(model, seed, COMPARED_S, COMPARED_S, Some(&mut blocks)).repeated);
    (blocks.len(), repeated.iter().sum())
}

fn row(model: &str, day: &Run, blocks: usize, repeated: u64) -> Value {
    let drift = drift_db(&day.power);
    let ratio = day.ns_per_sample.1 / day.ns_per_sample.0;
    let mean = day.power.iter().sum::<f64>() / day.power.len() as f64;
    // A sum of sinusoids has a period.
    let fresh = repeated == 0 || model == "speak";
    json!({
        "model": model,
        "rate_hz": day.rate_hz,
        "samples": day.samples,
        "drift_db": drift,
        "level_db": 10.0 * mean.log10(),
        "broken": day.broken,
        "ns_first_minute": day.ns_per_sample.0,
        "ns_last_minute": day.ns_per_sample.1,
        "blocks": blocks,
        "repeated": repeated,
        "holds": drift < DRIFT_DB && day.broken == 0 && ratio < SLOWDOWN && fresh,
    })
}

fn phases(hours: f64, quiet: bool) -> Vec<Value> {
    if !quiet {
        println!("\nfrequency/Hz  rate/Hz  phase error/cycles");
    }
    let pairs = [(317.3, 2_000.0), (20.1, 20_000.0), (999.9, 44_100.0)];
    let rows = pairs.into_iter().map(|(frequency_hz, rate_hz)| {
        let off = phase_error_cycles(frequency_hz, rate_hz, (3_600.0 * hours * rate_hz) as u64);
        if !quiet {
            println!("{frequency_hz:12} {rate_hz:8} {off:12.2e}");
        }
        json!({
            "frequency_hz": frequency_hz,
            "rate_hz": rate_hz,
            "error_cycles": off,
            "holds": off < PHASE_CYCLES,
        })
    });
    rows.collect()
}
