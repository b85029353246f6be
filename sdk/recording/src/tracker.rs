//! The motion of the finger from a tracker at its own rate, in a second file.

use std::path::PathBuf;

use crate::Recording;
use crate::columns::assemble::{Assembled, Signals};
use crate::columns::map::{ColumnMap, Role};
use crate::columns::select::select_motion;
use crate::formats::with_sheet;
use crate::input::Opened;
use crate::sheet::Sheet;
use crate::velocity::velocity;
use crate::{ReadError, ReadOptions};

/// Shortest time between two rows, seconds.
const SHORTEST_S: f64 = 1e-9;
/// Longest time between two rows without a warning, seconds: the position is interpolated over it.
const GAP_S: f64 = 0.2;

/// A file with the finger's position or speed over time, of any kind that recordings have.
///
/// Both files have times of one clock. A recording without times begins at 0 s, and so does a tracker whose file has only a
/// rate. The recording is cut to the time that the tracker covers.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Tracker {
    /// The file.
    pub path: PathBuf,
    /// Roles of its columns: time, x, y, speed; columns that it leaves out are assigned by their names.
    pub map: Option<ColumnMap>,
}

impl Tracker {
    /// Names a tracker's file; its columns are assigned by their names.
    #[must_use]
    pub fn new(path: impl Into<PathBuf>) -> Self {
        Self {
            path: path.into(),
            map: None,
        }
    }

    /// Sets the roles of its columns.
    #[must_use]
    pub fn with_map(mut self, map: impl Into<Option<ColumnMap>>) -> Self {
        self.map = map.into();
        self
    }

    /// Adds the tracked speed to a recording, which is cut to the time that both cover.
    pub(crate) fn follow(
        &self,
        assembled: Assembled,
        options: &ReadOptions,
    ) -> Result<Recording, ReadError> {
        let own = ReadOptions::default().with_most_values(options.most_values);
        let motion = with_sheet(Opened::file(&self.path)?, &own, |sheet| self.motion(sheet))?;
        let (mut recording, time_s) = (assembled.recording, assembled.time_s);
        let rate_hz = recording.rate_hz;
        // Times that a given rate replaces need not ascend.
        let second = |sample: usize| match (&time_s, options.rate_hz) {
            (Some(time_s), None) => time_s[sample],
            (Some(time_s), Some(_)) => time_s[0] + sample as f64 / rate_hz,
            (None, _) => sample as f64 / rate_hz,
        };
        let samples = recording.samples();
        let (from, to) = motion.covered(samples, second)?;
        let speed = motion.speed_mm_s((from..to).map(second));
        if (from, to) != (0, samples) {
            recording.warnings.push(format!(
                "The tracker covers {:.3} to {:.3} s of its clock, the recording {:.3} to {:.3} s; only the common part is read.",
                motion.first_s(),
                motion.last_s(),
                second(0),
                second(samples - 1)
            ));
        }
        if recording.speed_mm_s.is_some() {
            let warning = "The speed is that of the tracker instead of the recording's own.";
            recording.warnings.push(warning.to_owned());
        }
        recording.warnings.extend(motion.warnings);
        recording.keep(from, to);
        let file = recording.source.clone();
        recording
            .with_speed(speed)
            .map_err(|source| ReadError::Recording { file, source })
    }

    fn motion(&self, sheet: &mut dyn Sheet) -> Result<Motion, ReadError> {
        let selection = select_motion(sheet.columns(), self.map.as_ref())?;
        let mut signals = Signals::read(sheet, &selection)?;
        let file = sheet.columns().file.clone();
        let path = match signals.take(Role::Speed) {
            Some(speed) => Path::Speed(speed.into_iter().map(f64::abs).collect()),
            None => Path::Position(signals.take_all(&[Role::X, Role::Y])),
        };
        let time_s = match signals.take(Role::Time) {
            Some(time_s) => time_s,
            None => {
                let Some(rate_hz) = sheet.rate_hz(signals.wanted())? else {
                    return Err(ReadError::Columns {
                        file,
                        problem: "the tracker has no time; map its column, as in time=COLUMN"
                            .into(),
                        columns: sheet.columns().list(),
                    });
                };
                (0..path.rows()).map(|row| row as f64 / rate_hz).collect()
            }
        };
        check_time(sheet, &time_s)?;
        let mut warnings = selection.warnings;
        warnings.append(&mut signals.warnings());
        warnings.extend(gap(&time_s));
        Ok(Motion {
            warnings: warnings
                .into_iter()
                .map(|text| format!("{file}: {text}"))
                .collect(),
            file,
            time_s,
            path,
        })
    }
}

fn check_time(sheet: &dyn Sheet, time_s: &[f64]) -> Result<(), ReadError> {
    let mut steps = time_s.windows(2);
    match steps.position(|pair| pair[1] - pair[0] < SHORTEST_S) {
        None => Ok(()),
        Some(row) => Err(ReadError::Damaged {
            file: sheet.columns().file.clone(),
            place: sheet.place(row + 1).to_string(),
            problem: format!(
                "the tracker's time after {} s is {} s; it must increase on every row by a nanosecond or more; remove repeated rows",
                time_s[row],
                time_s[row + 1]
            ),
        }),
    }
}

/// Returns a warning about the longest gap.
fn gap(time_s: &[f64]) -> Option<String> {
    let steps = time_s.windows(2).map(|pair| (pair[1] - pair[0], pair[0]));
    let (gap_s, begin_s) = steps.max_by(|a, b| a.0.total_cmp(&b.0))?;
    (gap_s > GAP_S).then(|| {
        format!("The longest gap of the tracker is {gap_s:.3} s, from {begin_s:.3} s on; the motion is interpolated there.")
    })
}

/// The motion that a tracker recorded.
struct Motion {
    file: String,
    /// Seconds, strictly ascending, at least two.
    time_s: Vec<f64>,
    path: Path,
    warnings: Vec<String>,
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

    /// Returns the samples, at ascending times, that the tracker covers, as a range; refuses fewer than two.
    fn covered(
        &self,
        samples: usize,
        second: impl Fn(usize) -> f64,
    ) -> Result<(usize, usize), ReadError> {
        let (first_s, last_s) = (self.first_s(), self.last_s());
        let all = 0..samples;
        let from = all
            .clone()
            .position(|sample| second(sample) >= first_s)
            .unwrap_or(samples);
        let to = all
            .rev()
            .find(|sample| second(*sample) <= last_s)
            .map_or(0, |last| last + 1);
        if to >= from + 2 {
            return Ok((from, to));
        }
        Err(ReadError::Option {
            file: self.file.clone(),
            option: "tracker",
            problem: format!(
                "the tracker covers {first_s:.3} to {last_s:.3} s and the recording {:.3} to {:.3} s, so they do not overlap; both need \
                 times of one clock, in seconds (scale one by a map, as in time=COLUMN:0.001); a recording without times begins at 0 s",
                second(0),
                second(samples.saturating_sub(1))
            ),
        })
    }

    /// Returns the speed at ascending times that the tracker covers.
    fn speed_mm_s(&self, at_s: impl Iterator<Item = f64> + Clone) -> Vec<f64> {
        let coordinates = match &self.path {
            Path::Speed(speed) => return interpolated(&self.time_s, speed, at_s),
            Path::Position(coordinates) => coordinates,
        };
        let start_s = self.first_s();
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

/// Returns values at ascending times, linear between rows.
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
