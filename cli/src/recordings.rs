//! Arguments for reading recordings, shared by the commands that read them.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use htex_author::recording::{MOST_VALUES, read_recording};
use htex_author::settings::ReadingSettings;
use htex_author::{
    Averaging, Exploration, SegmentChoice, SpectrumOptions, Take, validate_recording,
};
use htex_format::{Quantity, Report};
#[cfg(feature = "lab")]
use htex_lab::record::take_settings;

use crate::failure::Failure;
use crate::located;
use crate::output::note;
use crate::shown::shown;

/// Options of reading recordings.
#[derive(Args)]
#[command(next_help_heading = "Reading recordings")]
pub(crate) struct RecordingArgs {
    /// Sampling rate; needed where the file does not say (NPY, CSV without a time column)
    #[arg(long, value_name = "HZ")]
    rate: Option<f64>,

    /// Names and scales other people's columns and channels: ROLE=COLUMN, ROLE=COLUMN:SCALE or ROLE=EXPRESSION, e.g.
    /// lateral=lateral_V:0.4444,normal=-(fz1+fz2)*0.31. Roles: lateral, lateral_x, lateral_y (of other quantities:
    /// signal, signal_x, signal_y, signal_z), normal, speed, time, x, y; columns by name, number (#3) or path (/run1/fx),
    /// in quotes if the name has an operator; the values are in N, the quantity's unit, mm/s, s, mm
    #[arg(long, value_name = "MAP")]
    map: Option<String>,

    /// The finger's motion from a tracker at its own rate: a file with the columns time and x, y (or speed), in times of the
    /// recording's clock; a recording without times begins at 0 s. One for each recording, or one for all
    #[arg(long, value_name = "FILE")]
    tracker: Vec<PathBuf>,

    /// Names and scales the tracker's columns, as --map does: time=stamp_ms:0.001,x=#2,y=#3
    #[arg(long, value_name = "MAP", requires = "tracker")]
    tracker_map: Option<String>,

    /// What the texture's signal is: a force in N, an acceleration in m/s2 (tool tips), a velocity in m/s, a
    /// displacement in m
    #[arg(long, value_enum, default_value = "lateral-force")]
    quantity: QuantityArg,

    /// What a full-scale sample in WAV, FLAC and NPY files is, in the quantity's unit
    #[arg(long, value_name = "UNITS")]
    scale: Option<f64>,

    /// Response of the recording setup to divide out: CSV with columns frequency_hz,
    /// magnitude and, if known, phase_rad
    #[arg(long, value_name = "CSV", value_parser = located::RECORDING)]
    frf: Option<PathBuf>,

    /// Reads the recording from this time on, s
    #[arg(long, value_name = "S")]
    from: Option<f64>,

    /// Reads the recording up to this time, s
    #[arg(long, value_name = "S")]
    to: Option<f64>,

    /// Most numbers of a recording that are kept in memory, where each takes 8 to 40 bytes; columns that are not used
    /// do not count
    #[arg(long, value_name = "N", default_value_t = MOST_VALUES)]
    most_numbers: usize,

    /// Where the texture is read: in the middles of whole sweeps, in evenly spaced windows, or (auto) in sweeps if
    /// there are any that speak for at least half of the sliding, a sweep for 2 s at most
    #[arg(long, value_enum, default_value = "auto")]
    segments: SegmentsArg,

    /// How segments are averaged; `rms` reads noise at its level, `magnitude` is the mean that the paper is
    /// taken to use and reads noise 1.05 dB lower, `complex` keeps only what is in phase in all segments
    #[arg(long, value_enum, default_value = "rms")]
    averaging: AveragingArg,

    /// Scanning speed, mm/s, where the recording does not say, or instead of what it says
    #[arg(long, value_name = "MM_S")]
    speed: Option<f64>,

    /// Normal force, N, where the recording does not say, or instead of what it says
    #[arg(long, value_name = "N")]
    force: Option<f64>,

    /// Exploration condition of each recording, in their order, or one for all: speed=80,force=0.4. Where the
    /// recording has the motion too, segments that leave this by more than 10 % are left out
    #[arg(long, value_name = "CONDITION")]
    at: Vec<String>,

    /// Refuse a recording with findings that are errors or warnings (`htex validate` lists them): clipping, spikes,
    /// a stuck sensor, a speed or force that leaves its target by more than 10 %, …
    #[arg(long)]
    strict: bool,
}

#[derive(Clone, Copy, ValueEnum)]
enum QuantityArg {
    #[value(alias = "lateral_force")]
    LateralForce,
    #[value(alias = "normal_force")]
    NormalForce,
    Acceleration,
    Velocity,
    Displacement,
}

#[derive(Clone, Copy, ValueEnum)]
enum SegmentsArg {
    Auto,
    Sweeps,
    Windows,
}

#[derive(Clone, Copy, ValueEnum)]
enum AveragingArg {
    Magnitude,
    Rms,
    Complex,
}

impl RecordingArgs {
    /// The files that are read with the recordings: a response, trackers.
    pub(crate) fn inputs(&self) -> impl Iterator<Item = &Path> {
        self.frf.iter().chain(&self.tracker).map(PathBuf::as_path)
    }

    pub(crate) fn strict(&self) -> bool {
        self.strict
    }

    /// What was given, as settings.
    pub(crate) fn settings(&self) -> ReadingSettings {
        ReadingSettings {
            rate_hz: self.rate,
            map: self.map.clone(),
            trackers: self.tracker.clone(),
            tracker_map: self.tracker_map.clone(),
            quantity: Some(match self.quantity {
                QuantityArg::LateralForce => Quantity::LateralForce,
                QuantityArg::NormalForce => Quantity::NormalForce,
                QuantityArg::Acceleration => Quantity::Acceleration,
                QuantityArg::Velocity => Quantity::Velocity,
                QuantityArg::Displacement => Quantity::Displacement,
            }),
            scale: self.scale,
            response: self.frf.clone(),
            from_s: self.from,
            to_s: self.to,
            most_values: Some(self.most_numbers),
            segments: Some(match self.segments {
                SegmentsArg::Auto => SegmentChoice::Auto,
                SegmentsArg::Sweeps => SegmentChoice::Sweeps,
                SegmentsArg::Windows => SegmentChoice::Windows,
            }),
            averaging: Some(match self.averaging {
                AveragingArg::Magnitude => Averaging::Magnitude,
                AveragingArg::Rms => Averaging::Rms,
                AveragingArg::Complex => Averaging::Complex,
            }),
        }
    }

    /// Reads recordings, each with the condition that was given for it.
    pub(crate) fn read(&self, files: &[PathBuf]) -> Result<Vec<Take>, Failure> {
        self.read_with(files, &self.settings())
    }

    fn read_with(
        &self,
        files: &[PathBuf],
        settings: &ReadingSettings,
    ) -> Result<Vec<Take>, Failure> {
        let options = settings.read_options(files.len())?;
        let given = self.conditions(files.len())?;
        let given = options.iter().zip(given);
        files
            .iter()
            .zip(given)
            .map(|(file, (options, given))| {
                let recording = read_recording(file, options)?;
                Ok(Take { recording, given })
            })
            .collect()
    }

    /// Reads one recording, with its condition. A recording of `htex record` or of a study is read as the JSON beside it says, unless
    /// flags say what its columns are.
    pub(crate) fn read_one(&self, file: &Path) -> Result<Take, Failure> {
        let own = take_settings(file).filter(|_| !self.says_columns());
        self.read_as(file, own)
    }

    /// Reads one of several recordings, with its condition. One of `htex record` or of a study is read as the JSON beside it says, also
    /// if flags say what the columns of the others are.
    pub(crate) fn read_among(&self, file: &Path) -> Result<Take, Failure> {
        let own = take_settings(file);
        if own.is_some() && self.says_columns() {
            note(&[format!(
                "{}: its columns, rate, quantity and motion are those that the JSON beside it says",
                shown(file)
            )]);
        }
        self.read_as(file, own)
    }

    fn read_as(&self, file: &Path, own: Option<ReadingSettings>) -> Result<Take, Failure> {
        let given = self.settings();
        let settings = match own {
            Some(own) => of_take(own, given),
            None => given,
        };
        self.read_with(&[file.to_owned()], &settings)?
            .pop()
            .ok_or_else(|| Failure::Usage("a recording is missing".to_owned()))
    }

    /// Whether a flag says what the columns of recordings are.
    fn says_columns(&self) -> bool {
        let is_other = !matches!(self.quantity, QuantityArg::LateralForce);
        let scaled = self.rate.or(self.scale).is_some();
        scaled || self.map.is_some() || !self.tracker.is_empty() || is_other
    }

    /// The findings in one recording.
    pub(crate) fn validate(&self, file: &Path) -> Result<Report, Failure> {
        let given = self.conditions(1)?.pop().unwrap_or_default();
        let settings = self.settings();
        let read = settings.read_options(1)?.pop().unwrap_or_default();
        Ok(validate_recording(
            file,
            &read,
            given,
            &settings.spectrum_options()?,
        )?)
    }

    /// Whether any option of reading recordings was given.
    pub(crate) fn is_given(&self) -> bool {
        let condition = self.speed.is_some() || self.force.is_some() || !self.at.is_empty();
        let bounded = self.most_numbers != MOST_VALUES;
        condition || self.strict || bounded || !self.settings().recorded().is_empty()
    }

    pub(crate) fn spectrum_options(&self) -> Result<SpectrumOptions, Failure> {
        Ok(self.settings().spectrum_options()?)
    }

    /// A condition for each of `count` recordings.
    fn conditions(&self, count: usize) -> Result<Vec<Exploration>, Failure> {
        let common = Exploration {
            speed_mm_s: self.speed,
            force_n: self.force,
        };
        let given: Vec<Exploration> = self
            .at
            .iter()
            .map(|text| parse_condition(text, common))
            .collect::<Result<_, _>>()?;
        match given.len() {
            0 => Ok(vec![common; count]),
            1 => Ok(vec![given[0]; count]),
            n if n == count => Ok(given),
            n => Err(Failure::Usage(format!(
                "{n} conditions (--at) for {count} recordings; give one for each, or one for all"
            ))),
        }
    }
}

/// The settings of a take, and of those that were given what is not about its columns.
fn of_take(own: ReadingSettings, given: ReadingSettings) -> ReadingSettings {
    ReadingSettings {
        response: given.response,
        from_s: given.from_s,
        to_s: given.to_s,
        most_values: given.most_values,
        segments: given.segments,
        averaging: given.averaging,
        ..own
    }
}

#[cfg(not(feature = "lab"))]
fn take_settings(_: &Path) -> Option<ReadingSettings> {
    None
}

/// Reads `speed=80,force=0.4`; a quantity that is left out stays as it was.
pub(crate) fn parse_condition(
    text: &str,
    mut condition: Exploration,
) -> Result<Exploration, Failure> {
    let wrong = |what: &str| {
        Failure::Usage(format!(
            "--at {text}: {what}; it looks like speed=80,force=0.4 (mm/s, N)"
        ))
    };
    for part in text.split(',') {
        let (key, value) = part
            .split_once('=')
            .ok_or_else(|| wrong("`=` is missing"))?;
        let value: f64 = value
            .trim()
            .parse()
            .map_err(|_| wrong("a value is not a number"))?;
        match key.trim() {
            "speed" | "speed_mm_s" => condition.speed_mm_s = Some(value),
            "force" | "force_n" => condition.force_n = Some(value),
            other => return Err(wrong(&format!("`{other}` is neither speed nor force"))),
        }
    }
    Ok(condition)
}
