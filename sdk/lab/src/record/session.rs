//! A session: takes of one name, recorded until one keeps to its target.

use htex_author::read::Role;
use htex_device::Source;

use crate::record::data::TakeHeader;
use crate::record::error::RecordError;
use crate::record::finish::{Recorded, finish, with_kept};
use crate::record::guide::{Moment, Phase};
use crate::record::names;
use crate::record::part::Part;
use crate::record::reader::{Next, Reader, Span};
use crate::record::setup::{Setup, Tare, check};
use crate::record::signals::Signals;
use crate::record::tracker::TrackerRows;
use crate::record::write::Outcome;

/// Length of the tare, seconds.
const TARE_S: f64 = 1.0;

/// A session. The source runs from its first take until it is dropped.
pub struct Session {
    setup: Setup,
    reader: Reader,
}

impl Session {
    /// Makes a session and creates its folder. The source does not run yet.
    ///
    /// # Errors
    /// When the setup is out of range, or a target is given for what is not measured.
    pub fn new(
        setup: Setup,
        source: Box<dyn Source>,
        signals: Signals,
        tracker: Option<Box<dyn TrackerRows>>,
    ) -> Result<Self, RecordError> {
        check(&setup, source.rate_hz())?;
        let moves = |roles: &[(String, String)]| {
            roles
                .iter()
                .any(|(role, _)| matches!(&role[..], "x" | "y" | "speed"))
        };
        let is_tracked = tracker
            .as_ref()
            .is_some_and(|tracker| moves(&tracker.signals()));
        if setup.target.speed_mm_s.is_some() && !is_tracked && !moves(&signals.list()) {
            return Err(RecordError::NotMeasured {
                what: "speed",
                advice: "give a tracker, or map speed, x or y",
            });
        }
        if setup.target.force_n.is_some() && signals.position(Role::Normal).is_none() {
            return Err(RecordError::NotMeasured {
                what: "force",
                advice: "map the channel of the normal force, as in normal=ai2:0.31",
            });
        }
        std::fs::create_dir_all(&setup.folder)
            .map_err(|error| RecordError::write(&setup.folder, error))?;
        let reader = Reader::new(source, signals, tracker, setup.seconds);
        Ok(Self { setup, reader })
    }

    /// Records takes until one keeps to its target, and returns that. `watch` is called for each block of samples, `told` for
    /// each take that is complete.
    ///
    /// # Errors
    /// [`RecordError::OffTarget`] when no take did; errors of the source, after which what was recorded is in the folder
    /// `incomplete`; [`RecordError::Left`] when `watch` ends the session.
    pub fn record(
        &mut self,
        watch: &mut dyn FnMut(&Moment<'_>) -> Next,
        told: &mut dyn FnMut(&Recorded),
    ) -> Result<Recorded, RecordError> {
        self.reader.source.start()?;
        let mut reasons = String::new();
        for attempt in 0..self.setup.attempts {
            match (self.setup.tare, attempt) {
                (Tare::Never, _) | (Tare::Once, 1..) => {}
                (Tare::Once | Tare::Each, 0) => self.tare(watch)?,
                (Tare::Each, 1..) => {
                    let lift = Span::new(Phase::Lift, 0, self.setup.countdown_s);
                    self.reader.run(lift, watch, &mut |_, _, _| Ok(()))?;
                    self.tare(watch)?;
                }
            }
            let take = self.take(watch)?;
            told(&take);
            if take.outcome == Outcome::Kept {
                self.reader.source.stop()?;
                return Ok(take);
            }
            reasons = take.verdict.reasons.join("; ");
        }
        self.reader.source.stop()?;
        Err(RecordError::OffTarget {
            attempts: self.setup.attempts,
            reasons,
            folder: self.setup.folder.join(names::REJECTED),
        })
    }

    /// Measures the forces without a finger.
    fn tare(&mut self, watch: &mut dyn FnMut(&Moment<'_>) -> Next) -> Result<(), RecordError> {
        self.reader.signals.tare(&[]);
        let (mut sums, mut count) = (vec![0.0; self.reader.signals.list().len()], 0);
        self.reader.run(
            Span::new(Phase::Tare, 0, TARE_S),
            watch,
            &mut |_, values, _| {
                for (sum, values) in sums.iter_mut().zip(values) {
                    *sum += values.iter().sum::<f64>();
                }
                count += values.first().map_or(0, Vec::len);
                Ok(())
            },
        )?;
        let means: Vec<f64> = sums.iter().map(|sum| sum / count.max(1) as f64).collect();
        self.reader.signals.tare(&means);
        Ok(())
    }

    /// Records one take.
    fn take(
        &mut self,
        watch: &mut dyn FnMut(&Moment<'_>) -> Next,
    ) -> Result<Recorded, RecordError> {
        let folder = self.setup.folder.clone();
        let number = names::next_number(&folder, &self.setup.name);
        let number = number.map_err(|error| RecordError::write(&folder, error))?;
        let countdown = Span::new(Phase::Countdown, number, self.setup.countdown_s);
        self.reader.run(countdown, watch, &mut |_, _, _| Ok(()))?;
        let header = self.header(number);
        let mut part = Part::create(&names::part(&folder, &header.name, number), &header)?;
        let begin_s = self.reader.now_s();
        let span = Span::new(Phase::Take, number, header.seconds);
        let ran = self.reader.run(span, watch, &mut |read_s, values, rows| {
            let frames = interleaved(values);
            finite(&header, values, read_s)?;
            part.push_tracker(&since(rows, header.tracker.len() + 1, begin_s));
            part.push(&frames)
        });
        let flushed = part.flush();
        let path = part.path().to_owned();
        drop(part);
        match ran.and(flushed) {
            Ok(()) => finish(&folder, &path)?.ok_or(RecordError::Part {
                file: path,
                problem: "it is empty after a take; the disk may be damaged".to_owned(),
            }),
            Err(error) => Err(with_kept(error, finish(&folder, &path)?)),
        }
    }

    fn header(&self, number: u32) -> TakeHeader {
        let setup = &self.setup;
        let tracker = self.reader.tracker.as_ref();
        TakeHeader {
            htex_take: 1,
            name: setup.name.clone(),
            number,
            tool: setup.tool.clone(),
            source: setup.source.clone(),
            map: setup.map.clone(),
            calibrations: self.reader.signals.calibrations(),
            quantity: setup.quantity,
            rate_hz: self.reader.source.rate_hz(),
            seconds: setup.seconds,
            signals: self.reader.signals.list(),
            tare: self.reader.signals.offsets().to_vec(),
            tracker: tracker.map(|tracker| tracker.signals()).unwrap_or_default(),
            target_speed_mm_s: setup.target.speed_mm_s,
            target_force_n: setup.target.force_n,
            tolerance: setup.tolerance,
            format: setup.format,
        }
    }
}

fn finite(header: &TakeHeader, values: &[Vec<f64>], begin_s: f64) -> Result<(), RecordError> {
    for ((role, _), values) in header.signals.iter().zip(values) {
        if let Some(at) = values.iter().position(|value| !value.is_finite()) {
            return Err(RecordError::NotFinite {
                role: role.clone(),
                value: values[at],
                at_s: begin_s + at as f64 / header.rate_hz,
            });
        }
    }
    Ok(())
}

/// Rows of a tracker with times since `begin_s`; those before are left out.
fn since(rows: &[f64], width: usize, begin_s: f64) -> Vec<f64> {
    let mut kept = Vec::new();
    for row in rows.chunks_exact(width).filter(|row| row[0] >= begin_s) {
        kept.push(row[0] - begin_s);
        kept.extend(&row[1..]);
    }
    kept
}

fn interleaved(values: &[Vec<f64>]) -> Vec<f64> {
    let rows = values.first().map_or(0, Vec::len);
    (0..rows)
        .flat_map(|row| values.iter().map(move |values| values[row]))
        .collect()
}
