//! Checks voices with random but valid calls.
//!
//! From a seed, the check derives parameters, a band, a sample rate and a sequence of steps. A step
//! renders a block, retunes the voice to new parameters or to a mix of two parameter sets, or sets
//! a motion. The check plays the sequence twice, and divides it into different blocks each time.
//! The samples must be finite, and the same both times. The finding of a failure contains the seed,
//! so that the failure can be reproduced.

use std::time::Instant;

use htex_host::{Band, ModelVoice, Motion};

use crate::harness::{CheckResult, Finding, Outcome};
use crate::model::case::{Case, RATE_HZ};
use crate::model::random::Random;
use crate::model::sets::describes_nothing;
use crate::model::signal::first_difference;

/// Number of sequences if no time is given.
const SEQUENCES: u64 = 16;
/// Number of steps in a sequence.
const STEPS: usize = 24;
const FRAMES: [usize; 8] = [0, 1, 2, 7, 64, 250, 1_000, 4_096];
const BANDS: [(f64, f64); 5] =
    [(20.0, 1_000.0), (150.0, 700.0), (20.0, 200.0), (5.0, 2_000.0), (60.0, 65.0)];
/// Rates that a host may request, hertz.
const RATES: [f64; 6] = [RATE_HZ, 48_000.0, 44_100.0, 8_000.0, 2_400.0, 1_000.0];
/// Largest allowed sample in a sound of unit RMS.
const LOUDEST: f32 = 1e4;

/// One step in a host's use of a voice.
enum Step {
    Render(usize),
    Retune(Vec<f64>),
    /// Retune to a mix of two parameter sets. The list contains one set after the other, and the
    /// number is the weight of the second set.
    Mix(Vec<f64>, f64),
    Move(Motion),
}

/// Plays the sequences of consecutive seeds.
pub(crate) fn plays(case: &Case) -> CheckResult {
    let begun = Instant::now();
    let fitted: Vec<Vec<f64>> = case.fitted()?.into_iter().map(|f| f.parameters).collect();
    let (mut played, mut seed) = (0u64, case.seed);
    let goes_on = |done: u64| match case.fuzz {
        Some(time) => done == 0 || begun.elapsed() < time,
        None => done < SEQUENCES,
    };
    let mut done = 0;
    while goes_on(done) {
        announce(seed);
        let sequence = sequence(case, &fitted, seed);
        played += u64::from(sequence.map_err(|finding| by_seed(finding, seed))?);
        seed = seed.wrapping_add(1);
        done += 1;
    }
    let message = format!("{done} seeds from {} on: {played} sequences play", case.seed);
    Ok(Finding::passed(message).with("seeds", done as f64).with("played", played as f64))
}

fn by_seed(finding: Finding, seed: u64) -> Finding {
    let message = format!("{} (`--reproduce fuzz --seed {seed}`)", finding.message);
    Finding { message, ..finding }.with("seed", seed as f64)
}

/// Prints the finding that applies if the process crashes now. The runner uses the last finding
/// that it reads.
fn announce(seed: u64) {
    let finding = Finding::new(Outcome::Crashed, "it ends the process, or does not return");
    if let Ok(line) = serde_json::to_string(&by_seed(finding, seed)) {
        println!("{line}");
    }
}

/// Plays the sequence of a seed. Returns whether the model accepts its parameters.
fn sequence(case: &Case, fitted: &[Vec<f64>], seed: u64) -> Result<bool, Finding> {
    let mut random = Random::new(seed);
    let (low_hz, high_hz) = *random.choose(&BANDS);
    let band = Band { low_hz, high_hz };
    let first = draw(case, fitted, &mut random)?;
    if !case.takes(&first, band)? {
        return Ok(false);
    }
    let wanted_hz = *random.choose(&RATES);
    let rate_hz = case.model.voice_rate_hz(&first, band, wanted_hz)?;
    let voice_seed = random.bits();
    let steps = steps(case, fitted, &mut random)?;
    let play = |cut: &mut Random| -> Result<Vec<f32>, Finding> {
        let mut voice = case.model.voice(&first, band, rate_hz, voice_seed)?;
        play(case, &mut voice, &steps, cut)
    };
    let what = || format!("{first:?} in {low_hz} to {high_hz} Hz at {rate_hz} Hz");
    let wrong = |f: Finding| Finding::failed(format!("{}: {}", what(), f.message));
    let whole = play(&mut Random::new(0)).map_err(wrong)?;
    // The seed itself is not used, because its random numbers already determined the steps.
    let cut = play(&mut Random::new(seed ^ 0x5bd1_e995)).map_err(wrong)?;
    match first_difference(&whole, &cut) {
        None => Ok(true),
        Some(at) => Err(wrong(Finding::failed(format!(
            "sample {at} of the sequence depends on how it is cut into blocks"
        )))),
    }
}

fn draw(case: &Case, fitted: &[Vec<f64>], random: &mut Random) -> Result<Vec<f64>, Finding> {
    let near = random.choose(fitted);
    match random.below(3) {
        0 => Ok(near.clone()),
        _ => case.drawn(near, random),
    }
}

fn steps(case: &Case, fitted: &[Vec<f64>], random: &mut Random) -> Result<Vec<Step>, Finding> {
    let kinds = if case.model.follows_motion() { 6 } else { 5 };
    let mut steps = Vec::new();
    for _ in 0..STEPS {
        steps.push(match random.below(kinds) {
            0 | 1 => Step::Render(*random.choose(&FRAMES)),
            2 => Step::Render(random.below(2_000)),
            3 => Step::Retune(draw(case, fitted, random)?),
            4 => {
                let sets = [random.choose(fitted).clone(), draw(case, fitted, random)?];
                Step::Mix(sets.concat(), random.unit())
            }
            _ => Step::Move(motion(random)),
        });
    }
    steps.push(Step::Render(500));
    Ok(steps)
}

/// Returns a random valid motion. Usually it is a typical motion of a finger, sometimes one at an
/// end of the valid range.
fn motion(random: &mut Random) -> Motion {
    let mut number = |usual: f64, most: f64| match random.below(8) {
        0 => most,
        1 => 0.0,
        _ => random.within(-usual, usual),
    };
    Motion {
        speed_mm_s: number(300.0, 1e6),
        force_n: number(5.0, 1e6).abs(),
        position_mm: number(100.0, 1e12),
        x_mm: number(100.0, -1e12),
        y_mm: number(100.0, 1e12),
    }
}

/// Plays steps. Unless `cut` is the generator with seed 0, it divides the blocks into random parts.
fn play(
    case: &Case,
    voice: &mut ModelVoice,
    steps: &[Step],
    cut: &mut Random,
) -> Result<Vec<f32>, Finding> {
    let mut buffer = vec![0.0; case.model.most_parameters()];
    let mut all: Vec<f32> = Vec::new();
    // The seed of a generator cannot be read, so the next random number is compared.
    let is_cut = cut.clone().bits() != Random::new(0).bits();
    for step in steps {
        let changed = match step {
            Step::Retune(set) => voice.retune(set),
            Step::Mix(sets, weight) => {
                voice.retune_mix(sets, &[1.0 - weight, *weight], &mut buffer)
            }
            Step::Move(motion) => voice.set_motion(*motion),
            Step::Render(frames) => {
                let begin = all.len();
                all.resize(begin + frames, 0.0);
                let mut rest = &mut all[begin..];
                while !rest.is_empty() {
                    let len = if is_cut { 1 + cut.below(rest.len()) } else { rest.len() };
                    let (part, after) = rest.split_at_mut(len);
                    voice.render(part)?;
                    if is_cut {
                        voice.render(&mut [])?;
                    }
                    rest = after;
                }
                Ok(())
            }
        };
        // Parameters may describe no spectrum in this band. The voice then continues unchanged.
        match changed {
            Err(error) if describes_nothing(&error) && !matches!(step, Step::Move(_)) => {}
            other => other?,
        }
    }
    let follows = case.model.follows_motion();
    match all.iter().position(|x| !follows && x.abs() > LOUDEST) {
        None => Ok(all),
        Some(i) => Err(Finding::failed(format!("sample {i} is {}", all[i]))),
    }
}
