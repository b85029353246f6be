//! Memory and time.

use std::time::Instant;

use htex_host::Band;

use crate::case::{Case, RATE_HZ};
use crate::finding::{Finding, Found};

const BLOCK: usize = 256;
const BLOCKS: usize = 10_000;
const VOICES: usize = 2_000;
/// Growth of the resident memory that is allowed, bytes.
const GROWTH: f64 = 2.0 * 1024.0 * 1024.0;
/// Cost from which on there is a warning: a tenth of one processor.
const BUDGET: f64 = 0.1;

/// The process does not grow while a voice plays, or while voices come and go.
pub(crate) fn memory(case: &Case) -> Found {
    if resident_bytes().is_none() {
        return Ok(Finding::skipped("resident memory is read on Linux only"));
    }
    let sets = case.fitted()?;
    let mut voice = case.voice(&sets[0].parameters, case.seed)?;
    let mut out = [0.0; BLOCK];
    let mut play = |blocks: usize| -> Result<(), Finding> {
        for i in 0..blocks {
            if i % 16 == 0 {
                voice.retune(&sets[i / 16 % sets.len()].parameters)?;
            }
            voice.render(&mut out)?;
        }
        Ok(())
    };
    play(BLOCKS / 10)?;
    let blocks = growth(|| play(BLOCKS))?;
    let come_and_go = |voices: usize| -> Result<(), Finding> {
        for _ in 0..voices {
            case.voice(&sets[0].parameters, case.seed)?
                .render(&mut [0.0; 16])?;
        }
        Ok(())
    };
    come_and_go(VOICES / 10)?;
    let voices = growth(|| come_and_go(VOICES))?;
    let (kib, bad) = (
        |bytes: f64| (bytes / 1024.0).round(),
        blocks.max(voices) > GROWTH,
    );
    let message = format!(
        "{BLOCKS} blocks grow the process by {} KiB, {VOICES} voices by {} KiB",
        kib(blocks),
        kib(voices)
    );
    let finding = if bad {
        Finding::failed(message)
    } else {
        Finding::passed(message)
    };
    Ok(finding
        .with("blocks_bytes", blocks)
        .with("voices_bytes", voices))
}

fn growth(run: impl FnOnce() -> Result<(), Finding>) -> Result<f64, Finding> {
    let before = resident_bytes().unwrap_or_default();
    run()?;
    Ok(resident_bytes().unwrap_or_default() - before)
}

/// Resident memory of this process (`/proc/self/status`, `VmRSS`), bytes; `None` where there is no
/// such file.
pub fn resident_bytes() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status
        .lines()
        .find_map(|line| line.strip_prefix("VmRSS:"))?;
    let kib: f64 = line.trim().trim_end_matches("kB").trim().parse().ok()?;
    Some(1024.0 * kib)
}

/// Nanoseconds a sample.
pub(crate) fn cost(case: &Case) -> Found {
    let parameters = case.parameters()?;
    let rate_hz = case
        .model
        .voice_rate_hz(&parameters, Band::TACTILE, RATE_HZ)?;
    let mut voice = case.voice(&parameters, case.seed)?;
    let mut out = [0.0; BLOCK];
    let mut runs = Vec::new();
    for _ in 0..22 {
        let start = Instant::now();
        for _ in 0..16 {
            voice.render(&mut out)?;
        }
        runs.push(start.elapsed().as_secs_f64() * 1e9 / (16 * BLOCK) as f64);
    }
    // The first run warms up.
    let runs = &mut runs[1..];
    runs.sort_by(f64::total_cmp);
    let ns = runs[runs.len() / 2];
    let share = ns * 1e-9 * rate_hz;
    let message = format!(
        "{ns:.1} ns a sample at {rate_hz} Hz: {:.3} % of one processor",
        100.0 * share
    );
    let finding = if share < BUDGET {
        Finding::passed(message)
    } else {
        Finding::warning(message)
    };
    Ok(finding.with("ns_per_sample", ns).with("rate_hz", rate_hz))
}
