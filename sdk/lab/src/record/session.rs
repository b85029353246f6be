//! A recording session, which records takes under one name until one of them keeps to its target.

use std::path::Path;

use htex_author::recording::Role;
use htex_base::files::{AtFile, FileError, OwnFolder};
use htex_device::Input;

use crate::error::LabError;
use crate::record::data::TakeHeader;
use crate::record::files::{self, Outcome};
use crate::record::finish::{TakeReport, finish, with_kept};
use crate::record::guide::{Moment, Phase};
use crate::record::part::PartFile;
use crate::record::reader::{Inputs, Next, Phases, Reader, Span};
use crate::record::setup::{Setup, Tare, check};
use crate::record::signals::Signals;
use crate::record::tracker::TrackerRows;

/// Length of the tare, seconds.
const TARE_S: f64 = 1.0;

/// A recording session. The source runs from the first take until the session is dropped.
pub struct Session {
    setup: Setup,
    phases: Phases,
}

impl Session {
    /// Creates a session and its folder. The source does not start yet.
    ///
    /// # Errors
    /// Returns an error if a value of the setup is out of range, or if there is a target for a
    /// speed or a force that no signal measures.
    pub fn new(
        setup: Setup,
        source: Box<dyn Input>,
        signals: Signals,
        tracker: Option<Box<dyn TrackerRows>>,
    ) -> Result<Self, LabError> {
        check(&setup, source.stream().rate_hz)?;
        let moves = |roles: &[(String, String)]| {
            roles.iter().any(|(role, _)| matches!(&role[..], "x" | "y" | "speed"))
        };
        let is_tracked = tracker.as_ref().is_some_and(|tracker| moves(&tracker.signals()));
        if setup.target.speed_mm_s.is_some() && !is_tracked && !moves(&signals.list()) {
            return Err(LabError::NotMeasured {
                what: "speed",
                advice: "give a tracker, or map speed, x or y",
            });
        }
        if setup.target.force_n.is_some() && signals.position(Role::Normal).is_none() {
            return Err(LabError::NotMeasured {
                what: "force",
                advice: "map the channel of the normal force, as in normal=ai2:0.31",
            });
        }
        let own = OwnFolder::private(&setup.folder);
        own.make_folder(Path::new("")).writing(&setup.folder)?;
        let inputs = Inputs { signals, tracker };
        let reader = Reader::new(source, inputs, setup.seconds);
        Ok(Self { setup, phases: Phases::new(reader) })
    }

    /// Records takes until one keeps to its target, and returns this take. Calls `watch` for each
    /// block of samples, and `told` after each completed take.
    ///
    /// # Errors
    /// Returns [`LabError::OffTarget`] if no take kept to its target. Returns [`LabError::Left`] if
    /// `watch` ended the session. Returns the errors of the source; the samples recorded before
    /// such an error are in the folder `incomplete`.
    pub fn record(
        &mut self,
        watch: &mut dyn FnMut(&Moment<'_>) -> Next,
        told: &mut dyn FnMut(&TakeReport),
    ) -> Result<TakeReport, LabError> {
        self.phases.reader.source.start()?;
        let mut reasons = String::new();
        for attempt in 0..self.setup.attempts {
            match (self.setup.tare, attempt) {
                (Tare::Never, _) | (Tare::Once, 1..) => {}
                (Tare::Once | Tare::Each, 0) => self.tare(watch)?,
                (Tare::Each, 1..) => {
                    // The finger must leave the surface before the forces can be measured without
                    // it.
                    let lift = Span::new(Phase::Lift, 0, self.setup.countdown_s);
                    self.phases.run(lift, watch, &mut |_| Ok(()))?;
                    self.tare(watch)?;
                }
            }
            let take = self.record_take(watch)?;
            told(&take);
            if take.outcome == Outcome::Kept {
                self.phases.reader.source.finish()?;
                return Ok(take);
            }
            reasons = take.verdict.reasons.join("; ");
        }
        self.phases.reader.source.finish()?;
        Err(LabError::OffTarget {
            attempts: self.setup.attempts,
            reasons,
            folder: self.setup.folder.join(files::REJECTED),
        })
    }

    /// Measures the forces without a finger on the surface.
    fn tare(&mut self, watch: &mut dyn FnMut(&Moment<'_>) -> Next) -> Result<(), LabError> {
        // The earlier tare is removed first, so that it does not affect the new means.
        self.phases.reader.inputs.signals.tare(&[]);
        let (mut sums, mut count) = (vec![0.0; self.phases.reader.inputs.signals.list().len()], 0);
        self.phases.run(Span::new(Phase::Tare, 0, TARE_S), watch, &mut |block| {
            for (sum, values) in sums.iter_mut().zip(&block.values) {
                *sum += values.iter().sum::<f64>();
            }
            count += block.values.first().map_or(0, Vec::len);
            Ok(())
        })?;
        let means: Vec<f64> = sums.iter().map(|sum| sum / count.max(1) as f64).collect();
        self.phases.reader.inputs.signals.tare(&means);
        Ok(())
    }

    /// Records one take.
    fn record_take(
        &mut self,
        watch: &mut dyn FnMut(&Moment<'_>) -> Next,
    ) -> Result<TakeReport, LabError> {
        let folder = self.setup.folder.clone();
        let number = files::next_number(&folder, &self.setup.name).writing(&folder)?;
        let countdown = Span::new(Phase::Countdown, number, self.setup.countdown_s);
        self.phases.run(countdown, watch, &mut |_| Ok(()))?;
        let header = self.header(number);
        let mut part = PartFile::create(&files::part_file(&folder, &header.name, number), &header)?;
        // Earlier rows of the tracker do not belong to the take.
        let begin_s = self.phases.reader.now_s();
        let span = Span::new(Phase::Take, number, header.seconds);
        let ran = self.phases.run(span, watch, &mut |block| {
            block.check(&header)?;
            part.push_tracker(&block.rows_since(&header, begin_s));
            part.push(&block.interleaved())
        });
        // The file is flushed even after an error, so that the beginning of the take is not lost.
        let flushed = part.flush();
        let path = part.path().to_owned();
        // Releases the lock, because `finish` reads the file.
        drop(part);
        match ran.and(flushed) {
            Ok(()) => finish(&folder, &path)?.ok_or_else(|| {
                let problem = "it is empty after a take; the disk may be damaged";
                FileError::content(path, problem).into()
            }),
            Err(error) => Err(with_kept(error, finish(&folder, &path)?)),
        }
    }

    fn header(&self, number: u32) -> TakeHeader {
        let setup = &self.setup;
        let reader = &self.phases.reader;
        TakeHeader {
            htex_take: 1,
            name: setup.name.clone(),
            number,
            tool: setup.tool.clone(),
            source: setup.source.clone(),
            map: setup.map.clone(),
            calibrations: reader.inputs.signals.calibrations(),
            quantity: setup.quantity,
            rate_hz: reader.source.stream().rate_hz,
            seconds: setup.seconds,
            signals: reader.inputs.signals.list(),
            tare: reader.inputs.signals.offsets().to_vec(),
            tracker: reader.inputs.tracked(),
            target_speed_mm_s: setup.target.speed_mm_s,
            target_force_n: setup.target.force_n,
            tolerance: setup.tolerance,
            required: setup.required,
            format: setup.format,
        }
    }
}
