//! The finger's motion from a tracker. The motion is in a second file with its own sample rate.

use htex_base::finding::Notice;

use crate::columns::assemble::{Signals, TimedRecording};
use crate::columns::map::Role;
use crate::columns::select::select_motion;
use crate::error::{Fault, ReadError, ReadProblem};
use crate::formats;
use crate::input::{InputFile, file_name};
use crate::options::ReadOptions;
use crate::recording::Recording;
use crate::sheet::Sheet;
use crate::tracker::Tracker;
use crate::velocity::velocity;

/// Shortest time between two rows, seconds.
// The speed is a difference divided by this time, which must not become infinite.
const SHORTEST_S: f64 = 1e-9;
/// Longest time between two rows without a warning, seconds. The position is interpolated between
/// the rows.
const GAP_S: f64 = 0.2;

/// Adds the tracked speed to a recording, and cuts the recording to the time that the tracker also
/// covers.
pub(crate) fn follow(
    tracker: &Tracker,
    assembled: TimedRecording,
    options: &ReadOptions,
) -> Result<Recording, ReadError> {
    let (mut recording, time_s) = (assembled.recording, assembled.time_s);
    let (samples, rate_hz) = (recording.samples(), recording.rate_hz);
    // A given rate replaces the times, so they need not ascend.
    let second = |sample: usize| match (&time_s, options.rate_hz) {
        (Some(time_s), None) => time_s[sample],
        (Some(time_s), Some(_)) => time_s[0] + sample as f64 / rate_hz,
        (None, _) => sample as f64 / rate_hz,
    };
    let file = file_name(&tracker.path);
    let tracked = read(&file, tracker, options).and_then(|motion| {
        let range = motion.covered(samples, second)?;
        Ok((motion, range))
    });
    let (motion, (from, to)) = tracked.map_err(|fault| fault.in_file(&file))?;
    let speed = motion.speed_mm_s((from..to).map(second));
    if (from, to) != (0, samples) {
        recording.warnings.push(format!(
            "The tracker covers {:.3} to {:.3} s of its clock, the recording {:.3} to {:.3} s; only the common part is read.",
            motion.first_s(),
            motion.last_s(),
            second(0),
            second(samples - 1)
        ).into());
    }
    if recording.speed_mm_s.is_some() {
        let warning = "The speed comes from the tracker instead of the recording.";
        recording.warnings.push(warning.into());
    }
    recording.warnings.extend(motion.warnings);
    recording.keep(from, to);
    let file = recording.source.clone();
    let with_speed = recording.with_speed(speed);
    with_speed.map_err(|error| ReadProblem::Recording(error).in_file(&file))
}

fn read(file: &str, tracker: &Tracker, options: &ReadOptions) -> Result<Motion, Fault> {
    let own = ReadOptions::default().with_most_values(options.most_values);
    let opened = match &tracker.bytes {
        Some(bytes) => InputFile::bytes(&tracker.path, bytes)?,
        None => InputFile::file(&tracker.path)?,
    };
    let mut sheet = formats::open(opened, &own)?;
    let selection = select_motion(sheet.columns(), tracker.map.as_ref())?;
    let mut signals = Signals::read(&mut *sheet, &selection)?;
    let path = match signals.take_signal(Role::Speed) {
        Some(speed) => Path::Speed(speed.into_iter().map(f64::abs).collect()),
        None => Path::Position(signals.take_all(&[Role::X, Role::Y])),
    };
    let time_s = match signals.take_signal(Role::Time) {
        Some(time_s) => time_s,
        None => {
            let rate_hz = sheet.rate_hz(signals.wanted())?;
            let problem = "the tracker has no time; map its column, as in time=COLUMN";
            let rate_hz = rate_hz.ok_or_else(|| sheet.columns().refuse(problem.to_owned()))?;
            (0..path.rows()).map(|row| row as f64 / rate_hz).collect()
        }
    };
    check_time(&*sheet, &time_s)?;
    let mut warnings = selection.warnings;
    warnings.append(&mut signals.warnings());
    warnings.extend(gap(&time_s).map(Notice::from));
    let of_file = |told: Notice| Notice::new(format!("{file}: {told}"), told.hint);
    Ok(Motion { warnings: warnings.into_iter().map(of_file).collect(), time_s, path })
}

fn check_time(sheet: &dyn Sheet, time_s: &[f64]) -> Result<(), Fault> {
    let mut steps = time_s.windows(2);
    let Some(row) = steps.position(|pair| pair[1] - pair[0] < SHORTEST_S) else {
        return Ok(());
    };
    let problem = format!(
        "the tracker's time after {} s is {} s; it must increase on every row by a nanosecond or more; remove repeated rows",
        time_s[row],
        time_s[row + 1]
    );
    Err(ReadProblem::Invalid(problem).at_place(sheet.place(row + 1)))
}

/// Returns a warning about the longest gap, if it is too long.
fn gap(time_s: &[f64]) -> Option<String> {
    let steps = time_s.windows(2).map(|pair| (pair[1] - pair[0], pair[0]));
    let (gap_s, begin_s) = steps.max_by(|a, b| a.0.total_cmp(&b.0))?;
    (gap_s > GAP_S).then(|| {
        format!("The longest gap of the tracker is {gap_s:.3} s, from {begin_s:.3} s on; the motion is interpolated there.")
    })
}

/// The motion that a tracker recorded.
struct Motion {
    /// Times in seconds, strictly ascending, at least two.
    time_s: Vec<f64>,
    path: Path,
    warnings: Vec<Notice>,
}

enum Path {
    /// One or two coordinates, mm.
    Position(Vec<Vec<f64>>),
    /// mm/s.
    Speed(Vec<f64>),
}

impl Path {
    fn rows(&self) -> usize {
        match self {
            Self::Position(coordinates) => coordinates.first().map_or(0, Vec::len),
            Self::Speed(speed) => speed.len(),
        }
    }
}

impl Motion {
    fn first_s(&self) -> f64 {
        self.time_s.first().copied().unwrap_or(0.0)
    }

    fn last_s(&self) -> f64 {
        self.time_s.last().copied().unwrap_or(0.0)
    }

    /// Returns the range of samples, at ascending times, that the tracker covers. Refuses a range
    /// of fewer than two samples.
    fn covered(
        &self,
        samples: usize,
        second: impl Fn(usize) -> f64,
    ) -> Result<(usize, usize), ReadProblem> {
        let (first_s, last_s) = (self.first_s(), self.last_s());
        let all = 0..samples;
        let from = all.clone().position(|sample| second(sample) >= first_s).unwrap_or(samples);
        let to = all.rev().find(|sample| second(*sample) <= last_s).map_or(0, |last| last + 1);
        if to >= from + 2 {
            return Ok((from, to));
        }
        Err(ReadProblem::Option {
            option: "tracker",
            problem: format!(
                "the tracker covers {first_s:.3} to {last_s:.3} s and the recording {:.3} to {:.3} s, so they do not overlap; both need \
                 times of one clock, in seconds (scale one by a map, as in time=COLUMN:0.001); a recording without times begins at 0 s",
                second(0),
                second(samples.saturating_sub(1))
            ),
        })
    }

    /// Returns the speed at ascending times, all of which the tracker must cover.
    fn speed_mm_s(&self, at_s: impl Iterator<Item = f64> + Clone) -> Vec<f64> {
        let coordinates = match &self.path {
            Path::Speed(speed) => return interpolated(&self.time_s, speed, at_s),
            Path::Position(coordinates) => coordinates,
        };
        let start_s = self.first_s();
        // A clock that counts from 1970 has such large numbers that their products would lose the
        // digits below a millisecond.
        let from_start: Vec<f64> = self.time_s.iter().map(|t| t - start_s).collect();
        let along = |position: &Vec<f64>| {
            let at_s = at_s.clone().map(|t| t - start_s);
            velocity(&from_start, position, at_s)
        };
        let mut velocities = coordinates.iter().map(along);
        let mut speed = velocities.next().unwrap_or_default();
        speed.iter_mut().for_each(|v| *v = v.abs());
        for other in velocities {
            for (speed, v) in speed.iter_mut().zip(other) {
                *speed = libm::hypot(*speed, v);
            }
        }
        speed
    }
}

/// Returns values at ascending times, interpolated linearly between rows.
fn interpolated(time_s: &[f64], values: &[f64], at_s: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut row = 0;
    let value = |t: f64| {
        while row + 2 < time_s.len() && time_s[row + 1] <= t {
            row += 1;
        }
        let weight = (t - time_s[row]) / (time_s[row + 1] - time_s[row]);
        values[row] + weight * (values[row + 1] - values[row])
    };
    at_s.map(value).collect()
}
