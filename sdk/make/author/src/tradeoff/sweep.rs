//! The sweep of all settings over all recordings.

use std::collections::BTreeMap;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::AuthorError;
use serde::Serialize;

use crate::tradeoff::contender::Contender;
use crate::tradeoff::journal::{Entry, Journal, Outcome};
use crate::tradeoff::lineup::{key, lineup};
use crate::tradeoff::request::Request;
use crate::tradeoff::timing::{Times, time};
use crate::tradeoff::{ErrorAxis, Point, Subject};

/// A setting that could not be measured.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LeftOut {
    pub recording: String,
    /// The model and the setting.
    pub setting: String,
    pub reason: String,
}

#[derive(Debug, Clone, Default)]
pub struct SweepResult {
    /// The error by which the points are judged.
    pub error: ErrorAxis,
    /// The measured points, grouped by recording. The recordings are in the order of the report's
    /// table.
    pub points: Vec<Point>,
    /// Settings that could not be measured.
    pub left_out: Vec<LeftOut>,
}

/// Progress callback: finished steps, total steps, and the current step.
pub type Progress<'a> = &'a (dyn Fn(u64, u64, &str) + Sync);

/// Measures the accuracy of every setting on every recording, using all cores. Then measures the
/// times of the settings on one core.
///
/// # Errors
/// Returns an error when the journal cannot be written, or when no model can be fitted to a
/// recording. Also returns an error when the held-out error is requested but a recording is too
/// short to hold out a part of it.
pub fn sweep(
    subjects: &[Subject],
    request: &Request,
    journal: &mut Journal,
    progress: Progress<'_>,
) -> Result<SweepResult, AuthorError> {
    let error = request.error_of(subjects)?;
    let contenders = lineup(request)?;
    journal.open(&key(subjects, &contenders, request))?;
    // Timing a contender takes about as long as measuring it, so it counts as the same number of
    // steps.
    let all = subjects.len() * 2 * contenders.len();
    let done = AtomicUsize::new(0);
    let step = |steps: usize, what: &str| {
        let before = done.fetch_add(steps, Ordering::Relaxed);
        progress((before + steps) as u64, all as u64, what);
    };
    let mut swept = SweepResult { error, ..SweepResult::default() };
    for (recording, subject) in subjects.iter().enumerate() {
        let measured =
            measure_all(recording, subject, &contenders, request.quick, journal, &|| {
                step(1, &format!("{}: measuring", subject.name));
            })?;
        step(0, &format!("{}: timing", subject.name));
        // Times are measured only now, when all threads have ended and nothing else takes computing
        // time from the contenders.
        let timed = time_all(recording, subject, &contenders, &measured, request.quick, journal)?;
        step(contenders.len(), &subject.name);
        for one in &contenders {
            match measured.get(&one.id()) {
                Some(Outcome::Measured(measured)) => {
                    let timed = timed.get(&one.id());
                    let point = timed.map(|timed| Point::new(subject, one, measured, timed));
                    swept.points.extend(point);
                }
                Some(Outcome::Failed { reason }) => swept.left_out.push(LeftOut {
                    recording: subject.name.clone(),
                    setting: one.id(),
                    reason: reason.clone(),
                }),
                None => {}
            }
        }
        if !swept.points.iter().any(|p| p.recording == subject.name && !p.is_baseline()) {
            return Err(nothing_fitted(subject, &swept));
        }
    }
    Ok(swept)
}

fn nothing_fitted(subject: &Subject, swept: &SweepResult) -> AuthorError {
    let own = swept.left_out.iter().filter(|l| l.recording == subject.name);
    let mut reasons: Vec<&str> = own.map(|l| &l.reason[..]).collect();
    reasons.sort_unstable();
    reasons.dedup();
    AuthorError::NothingFitted { reasons: format!("{}: {}", subject.name, reasons.join("; ")) }
}

/// Outcomes by the contender's id.
type Outcomes = BTreeMap<String, Outcome>;

/// Measures everything that is not yet in the journal, using all cores.
fn measure_all(
    recording: usize,
    subject: &Subject,
    contenders: &[Contender],
    quick: bool,
    journal: &Journal,
    step: &(dyn Fn() + Sync),
) -> Result<Outcomes, AuthorError> {
    let mut known = Outcomes::new();
    for entry in &journal.entries {
        if let Entry::Measured { recording: of, contender, outcome } = entry
            && *of == recording
        {
            known.insert(contender.clone(), outcome.clone());
        }
    }
    let open: Vec<&Contender> =
        contenders.iter().filter(|c| !known.contains_key(&c.id())).collect();
    // Entries that the journal already contains count as done, so that the progress reaches its
    // end.
    (open.len()..contenders.len()).for_each(|_| step());
    let (next, found) = (AtomicUsize::new(0), Mutex::new(known));
    let work = || {
        while let Some(one) = open.get(next.fetch_add(1, Ordering::Relaxed)) {
            let outcome = match one.measure(subject, quick) {
                Ok(Some(measured)) => Outcome::Measured(Box::new(measured)),
                Ok(None) => Outcome::Failed {
                    reason: "it has too few blocks to be compared with itself".to_owned(),
                },
                Err(error) => Outcome::Failed { reason: error.to_string() },
            };
            // The result is written before the step counts as finished. If the sweep is interrupted
            // here, the next sweep measures the contender again.
            let contender = one.id();
            journal.keep(&Entry::Measured {
                recording,
                contender: contender.clone(),
                outcome: outcome.clone(),
            })?;
            if let Ok(mut found) = found.lock() {
                found.insert(contender, outcome);
            }
            step();
        }
        Ok::<(), AuthorError>(())
    };
    let cores = std::thread::available_parallelism().map_or(1, usize::from).min(open.len().max(1));
    std::thread::scope(|scope| {
        // One thread fewer than cores, because this thread works as well.
        let threads: Vec<_> = (1..cores).map(|_| scope.spawn(work)).collect();
        // All threads are joined even after an error, so that a panic of a thread is not lost.
        let own = work();
        threads.into_iter().fold(own, |all, thread| {
            all.and(thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
        })
    })?;
    Ok(found.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner))
}

/// Times the contenders that could be measured, unless the journal already has the times of all of
/// them.
fn time_all(
    recording: usize,
    subject: &Subject,
    contenders: &[Contender],
    measured: &Outcomes,
    quick: bool,
    journal: &Journal,
) -> Result<BTreeMap<String, Times>, AuthorError> {
    for entry in &journal.entries {
        if let Entry::Timed { recording: of, times } = entry
            && *of == recording
        {
            return Ok(times.iter().cloned().collect());
        }
    }
    let is_measured =
        |one: &&Contender| matches!(measured.get(&one.id()), Some(Outcome::Measured(_)));
    let timed: Vec<&Contender> = contenders.iter().filter(is_measured).collect();
    let times = time(subject, &timed, quick)?;
    let times: Vec<(String, Times)> = timed.iter().map(|one| one.id()).zip(times).collect();
    journal.keep(&Entry::Timed { recording, times: times.clone() })?;
    Ok(times.into_iter().collect())
}
