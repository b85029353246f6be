//! Checks that rendering and retuning a voice do not allocate memory.

use htex_host::ModelVoice;

use crate::harness::{CheckResult, Finding};
use crate::model::case::{Case, Fitted};

/// Number of warm-up blocks, in which a voice may allocate.
const WARM_UP: usize = 64;
const BLOCKS: usize = 1_000;
const FRAMES: [usize; 4] = [1, 64, 256, 1_000];
/// Number of blocks between two changes of the parameters (retunes).
const BETWEEN: usize = 4;

/// Checks that rendering and retuning do not allocate.
pub(crate) fn none(case: &Case) -> CheckResult {
    let sets = case.fitted()?;
    let mut voice = case.voice(&sets[0].parameters, case.seed)?;
    let mut out = vec![0.0; FRAMES[FRAMES.len() - 1]];
    play(&mut voice, &sets, &mut out, WARM_UP)?;
    match voice.memory_bytes() {
        Some(before) => {
            play(&mut voice, &sets, &mut out, BLOCKS)?;
            Ok(grown(voice.memory_bytes().unwrap_or(before) - before))
        }
        None => native(case, &sets, &mut voice, &mut out),
    }
}

fn play(
    voice: &mut ModelVoice,
    sets: &[Fitted],
    out: &mut [f32],
    blocks: usize,
) -> Result<(), Finding> {
    for i in 0..blocks {
        if i % BETWEEN == 0 {
            voice.retune(&sets[i / BETWEEN % sets.len()].parameters)?;
        }
        voice.render(&mut out[..FRAMES[i % FRAMES.len()]])?;
    }
    Ok(())
}

fn grown(bytes: usize) -> Finding {
    let finding = match bytes {
        0 => Finding::passed(format!(
            "the size of the module's memory is constant over {BLOCKS} blocks"
        )),
        _ => Finding::failed(format!(
            "the module's memory grows by {} KiB in {BLOCKS} blocks; allocate all buffers with the voice",
            bytes / 1024
        )),
    };
    finding.with("memory_bytes", bytes as f64)
}

/// Fails if a voice allocates after its warm-up while `play` runs, as far as that can be detected.
pub(crate) fn none_while(
    voice: &mut ModelVoice,
    play: impl FnOnce(&mut ModelVoice) -> Result<(), Finding>,
) -> Result<(), Finding> {
    let before = voice.memory_bytes();
    let (played, calls) = counted(|| play(voice));
    played?;
    let grown = voice.memory_bytes().zip(before);
    if calls == 0 && grown.is_none_or(|(now, before)| now == before) {
        return Ok(());
    }
    let what = match grown {
        Some((now, before)) => {
            format!("the module's memory grows by {} KiB", (now - before) / 1024)
        }
        None => format!("the allocator is called {calls} times"),
    };
    Err(Finding::failed(format!(
        "{what} while motions are set; allocate all buffers with the voice"
    )))
}

#[cfg(all(target_os = "linux", target_pointer_width = "64"))]
fn counted<T>(run: impl FnOnce() -> T) -> (T, u64) {
    crate::model::allocator::AllocatorCalls::watch().during(run)
}

#[cfg(not(all(target_os = "linux", target_pointer_width = "64")))]
fn counted<T>(run: impl FnOnce() -> T) -> (T, u64) {
    (run(), 0)
}

#[cfg(all(target_os = "linux", target_pointer_width = "64"))]
fn native(case: &Case, sets: &[Fitted], voice: &mut ModelVoice, out: &mut [f32]) -> CheckResult {
    let allocator = crate::model::allocator::AllocatorCalls::watch();
    if allocator.places() == 0 {
        return Ok(Finding::skipped(
            "no library of this process calls the C library's allocator by name",
        ));
    }
    // Usually a new voice allocates. So this number shows whether calls are counted at all.
    let (made, of_a_voice) = allocator.during(|| case.voice(&sets[0].parameters, case.seed));
    drop(made?);
    let (played, calls) = allocator.during(|| play(voice, sets, out, BLOCKS));
    played?;
    let finding = match calls {
        0 => Finding::passed(format!(
            "{BLOCKS} blocks do not call the allocator; making a voice calls it {of_a_voice} times"
        )),
        _ => Finding::failed(format!(
            "{BLOCKS} blocks with {} retunes call the allocator {calls} times; allocate all buffers with the voice",
            BLOCKS / BETWEEN
        )),
    };
    Ok(finding.with("calls", calls as f64).with("calls_of_a_new_voice", of_a_voice as f64))
}

#[cfg(not(all(target_os = "linux", target_pointer_width = "64")))]
fn native(_: &Case, _: &[Fitted], _: &mut ModelVoice, _: &mut [f32]) -> CheckResult {
    Ok(Finding::skipped("calls of the allocator are counted on 64-bit Linux only"))
}
