//! Measures the run times of all contenders of a sweep on one core, with the runs of the contenders
//! interleaved.

use std::hint::black_box;
use std::time::Instant;

use serde::{Deserialize, Serialize};

use crate::AuthorError;
use crate::tradeoff::Subject;
use crate::tradeoff::contender::{Contender, StoredData};
use crate::tradeoff::sound::Sound;

/// Numbers of samples: in a run, and in the warm-up that fills the caches before the run.
const SAMPLES: usize = 16_384;
const WARM_UP: usize = 1_024;

/// Number of runs of each contender.
#[derive(Debug, Clone, Copy)]
struct Rounds {
    fit: usize,
    start: usize,
    render: usize,
}

const FULL: Rounds = Rounds { fit: 7, start: 9, render: 41 };
const QUICK: Rounds = Rounds { fit: 3, start: 3, render: 9 };

/// A median, and the spread: half the interquartile range divided by the median.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct Median {
    pub(crate) median: f64,
    pub(crate) spread: f64,
}

/// The times of a contender.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct Times {
    pub(crate) fit_ms: Median,
    pub(crate) first_sample_us: Median,
    pub(crate) ns_per_sample: Median,
}

/// Times contenders in interleaved runs, so that other load on the machine affects all of them
/// alike.
///
/// # Errors
/// When a contender cannot be fitted or played. This cannot happen for contenders that were
/// measured.
pub(crate) fn time(
    subject: &Subject,
    contenders: &[&Contender],
    quick: bool,
) -> Result<Vec<Times>, AuthorError> {
    let rounds = if quick { QUICK } else { FULL };
    let fit_ms = turns(contenders, rounds.fit, |one| {
        let begun = Instant::now();
        black_box(one.fit(&subject.spectrum)?);
        Ok(1e3 * begun.elapsed().as_secs_f64())
    })?;
    let mut playing = Vec::new();
    for one in contenders {
        let spectrum = &subject.spectrum;
        let stored = one.store(subject, spectrum, &one.fit(spectrum)?)?;
        let sound = one.sound(subject, &stored, 1)?;
        playing.push(Playing { one, stored, sound });
    }
    let first_sample_us = turns(&mut playing, rounds.start, |playing| {
        let begun = Instant::now();
        let mut sound = playing.one.sound(subject, &playing.stored, 1)?;
        (sound.render)(&mut [0.0])?;
        Ok(1e6 * begun.elapsed().as_secs_f64())
    })?;
    let ns_per_sample = turns(&mut playing, rounds.render, |playing| playing.turn())?;
    let all = fit_ms.into_iter().zip(first_sample_us).zip(ns_per_sample);
    let timed = |((fit_ms, first_sample_us), ns_per_sample)| Times {
        fit_ms,
        first_sample_us,
        ns_per_sample,
    };
    Ok(all.map(timed).collect())
}

struct Playing<'a> {
    one: &'a Contender,
    stored: StoredData,
    sound: Sound,
}

impl Playing<'_> {
    fn turn(&mut self) -> Result<f64, AuthorError> {
        let block = self.one.setting.block_samples;
        let mut out = vec![0.0; block];
        let mut render = |samples: usize| {
            let mut calls = 0..samples.div_ceil(block);
            calls.try_for_each(|_| (self.sound.render)(black_box(&mut out)))
        };
        // Another contender ran just before and has filled the caches with its own data.
        render(WARM_UP)?;
        let begun = Instant::now();
        render(SAMPLES)?;
        let ns = 1e9 * begun.elapsed().as_secs_f64();
        // Only whole blocks are rendered, so the time is divided by the number of rendered samples,
        // not by the number of requested samples.
        Ok(ns / (SAMPLES.div_ceil(block) * block) as f64)
    }
}

/// Runs all items in several rounds, of which the first is a warm-up.
fn turns<T>(
    items: impl IntoIterator<Item = T>,
    rounds: usize,
    mut turn: impl FnMut(&mut T) -> Result<f64, AuthorError>,
) -> Result<Vec<Median>, AuthorError> {
    let mut items: Vec<(T, Vec<f64>)> = items.into_iter().map(|item| (item, Vec::new())).collect();
    for round in 0..=rounds {
        for (item, times) in &mut items {
            let time = turn(item)?;
            if round > 0 {
                times.push(time);
            }
        }
    }
    Ok(items.into_iter().map(|(_, times)| median(times)).collect())
}

fn median(mut times: Vec<f64>) -> Median {
    times.sort_by(f64::total_cmp);
    let at = |share: f64| times[(share * (times.len() - 1) as f64).round() as usize];
    // If the clock is too coarse, the median may be 0. The spread must be a number even then.
    Median { median: at(0.5), spread: 0.5 * (at(0.75) - at(0.25)) / at(0.5).max(f64::MIN_POSITIVE) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_median_and_its_quartiles() {
        let found = median(vec![9.0, 1.0, 2.0, 3.0, 4.0]);
        assert_eq!(found, Median { median: 3.0, spread: 1.0 / 3.0 });
    }
}
