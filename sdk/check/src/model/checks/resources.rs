//! Checks of memory and time.

use std::time::Instant;

use htex_host::Band;

use crate::harness::{CheckResult, Finding, Growth};
use crate::model::case::{Case, RATE_HZ};

const BLOCK: usize = 256;
const BLOCKS: usize = 10_000;
const VOICES: usize = 2_000;
/// Fraction of one processor's time above which there is a warning.
const BUDGET: f64 = 0.1;

/// Checks that memory does not grow while a voice plays, or while voices are created and freed.
pub(crate) fn memory(case: &Case) -> CheckResult {
    crate::harness::memory(|| {
        let sets = case.fitted()?;
        let mut voice = case.voice(&sets[0].parameters, case.seed)?;
        let mut out = [0.0; BLOCK];
        let play = |blocks: usize| {
            for i in 0..blocks {
                if i % 16 == 0 {
                    voice.retune(&sets[i / 16 % sets.len()].parameters)?;
                }
                voice.render(&mut out)?;
            }
            Ok(())
        };
        let blocks = Growth::measure(BLOCKS, "blocks", play)?;
        let make_and_free = |voices: usize| {
            for _ in 0..voices {
                case.voice(&sets[0].parameters, case.seed)?.render(&mut [0.0; 16])?;
            }
            Ok(())
        };
        Ok([blocks, Growth::measure(VOICES, "voices", make_and_free)?])
    })
}

/// Measures the rendering time in nanoseconds per sample.
pub(crate) fn cost(case: &Case) -> CheckResult {
    let parameters = case.parameters()?;
    let rate_hz = case.model.voice_rate_hz(&parameters, Band::TACTILE, RATE_HZ)?;
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
    // The first run is a warm-up.
    let runs = &mut runs[1..];
    runs.sort_by(f64::total_cmp);
    let ns = runs[runs.len() / 2];
    let share = ns * 1e-9 * rate_hz;
    let message =
        format!("{ns:.1} ns per sample at {rate_hz} Hz: {:.3} % of one processor", 100.0 * share);
    let finding = if share < BUDGET { Finding::passed(message) } else { Finding::warning(message) };
    Ok(finding.with("ns_per_sample", ns).with("rate_hz", rate_hz))
}
