//! Checks that rendering, retuning and setting a motion do not wait, and do no input or output.

use htex_host::{ModelVoice, Motion};

use crate::harness::{CheckResult, Finding};
use crate::model::case::Case;

const BLOCKS: usize = 2_000;
const FRAMES: [usize; 3] = [64, 1, 256];
/// Number of allowed waits. It is not 0, because a page fault may make the system suspend the
/// thread.
const WAITS: u64 = 8;

/// Counters of this thread: its waits, and its calls that read or write.
#[derive(Clone, Copy)]
struct Counts {
    waits: u64,
    transfers: u64,
}

/// Checks that rendering, retuning and setting a motion do not wait, read or write files.
pub(crate) fn none(case: &Case) -> CheckResult {
    if Counts::now().is_none() {
        return Ok(Finding::skipped("waits of a thread are counted on Linux only"));
    }
    let sets = case.fitted()?;
    let mut voice = case.voice(&sets[0].parameters, case.seed)?;
    let follows = case.model.follows_motion();
    let mut out = [0.0; 256];
    let mut play = |voice: &mut ModelVoice, blocks: usize| -> Result<(), Finding> {
        for i in 0..blocks {
            if i % 4 == 0 {
                voice.retune(&sets[i / 4 % sets.len()].parameters)?;
            }
            if follows {
                voice.set_motion(motion(i))?;
            }
            voice.render(&mut out[..FRAMES[i % FRAMES.len()]])?;
        }
        Ok(())
    };
    play(&mut voice, 64)?;
    // Reading the counters is itself counted as reads. A second reading shows how many reads this
    // adds.
    let (first, second) = (counts()?, counts()?);
    play(&mut voice, BLOCKS)?;
    let last = counts()?;
    let transfers =
        (last.transfers - second.transfers).saturating_sub(second.transfers - first.transfers);
    let waits = last.waits - second.waits;
    let message =
        format!("{BLOCKS} blocks wait {waits} times, and read or write {transfers} times");
    let finding = match (waits, transfers) {
        (..=WAITS, 0) => Finding::passed(message),
        _ => Finding::failed(format!(
            "{message}; a call of a voice neither locks nor waits, and does no input or output"
        )),
    };
    Ok(finding.with("waits", waits as f64).with("transfers", transfers as f64))
}

fn motion(i: usize) -> Motion {
    let angle = 0.01 * i as f64;
    Motion {
        speed_mm_s: 100.0 * angle.cos(),
        force_n: 0.5,
        position_mm: 10.0 * angle.sin(),
        x_mm: 10.0 * angle.sin(),
        y_mm: 0.0,
    }
}

fn counts() -> Result<Counts, Finding> {
    Counts::now().ok_or_else(|| Finding::skipped("waits of a thread cannot be read"))
}

impl Counts {
    /// Returns the current counts, or `None` if the system does not have these files.
    fn now() -> Option<Self> {
        let value = |text: &str, key: &str| -> Option<u64> {
            let line = text.lines().find_map(|line| line.strip_prefix(key))?;
            line.trim().parse().ok()
        };
        let status = std::fs::read_to_string("/proc/thread-self/status").ok()?;
        let io = std::fs::read_to_string("/proc/thread-self/io").ok()?;
        Some(Self {
            waits: value(&status, "voluntary_ctxt_switches:")?,
            transfers: value(&io, "syscr:")? + value(&io, "syscw:")?,
        })
    }
}
