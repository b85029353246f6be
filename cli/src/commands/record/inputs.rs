//! Arguments about the source, its channels and the tracker.

use std::io::{BufReader, IsTerminal};
use std::path::PathBuf;

use clap::Args;
use htex_author::read::ColumnMap;
use htex_device::Source;
use htex_format::Quantity;
use htex_lab::record::{Calibration, LineTracker, Signals, TableTracker, TrackerRows};

use crate::devices::SettingArgs;
use crate::failure::Failure;
use crate::sources::SourceArgs;

/// What is recorded from.
#[derive(Args)]
#[command(next_help_heading = "Source")]
pub(super) struct InputArgs {
    /// Where the signals come from: a recording that is replayed (file:rec.csv), analog inputs of a National Instruments card
    /// (daq:Dev1/ai0:5), or another source of `htex device list`
    #[arg(long, value_name = "NAME:TARGET")]
    pub(super) source: String,

    #[command(flatten)]
    sources: SourceArgs,

    #[command(flatten)]
    settings: SettingArgs,

    /// Roles and scales of the channels, as in `htex fit`: lateral_x=fx1+fx2,normal=-fz*0.31. Without it channels are
    /// known by their names
    #[arg(long, value_name = "MAP")]
    pub(super) map: Option<String>,

    /// Calibration of a six-axis sensor on the first six channels, whose names become fx, fy, fz, tx, ty, tz: six rows of six
    /// numbers (N and N m for a volt) as CSV, or `matrix` in TOML. A second one is that of the next six; axes are then fx1, fx2, …
    #[arg(long, value_name = "FILE")]
    calibration: Vec<PathBuf>,

    /// What the texture's signal is: lateral-force, normal-force, acceleration, velocity, displacement
    #[arg(long, value_name = "NAME", default_value = "lateral-force", value_parser = super::quantity)]
    quantity: Quantity,

    /// The finger's motion: a file to replay (file:track.csv), or lines `x_mm y_mm` from a pipe or port (lines:/dev/ttyACM0) or
    /// from standard input (lines:-)
    #[arg(long, value_name = "NAME:TARGET")]
    tracker: Option<String>,

    /// Roles and scales of the columns of a tracker's file: time=stamp_ms:0.001,x=#2
    #[arg(long, value_name = "MAP", requires = "tracker")]
    tracker_map: Option<String>,

    /// Replay files without waiting
    #[arg(long)]
    pub(super) fast: bool,
}

impl InputArgs {
    pub(super) fn quantity(&self) -> Quantity {
        self.quantity
    }

    pub(super) fn open(&self) -> Result<Box<dyn Source>, Failure> {
        let mut given = self.settings.given()?;
        if self.fast {
            if !self.source.starts_with("file:") {
                let sentence = "--fast replays files; other sources come at their own pace";
                return Err(Failure::Usage(sentence.to_owned()));
            }
            given.insert("pace".to_owned(), "fast".to_owned());
        }
        self.sources.open(&self.source, &self.settings, &given)
    }

    pub(super) fn signals(&self, source: &dyn Source) -> Result<Signals, Failure> {
        let map = parsed(self.map.as_deref())?;
        let calibrations = self.calibration.iter().map(|path| Calibration::read(path));
        let calibrations = calibrations.collect::<Result<_, _>>()?;
        let signals = Signals::new(
            &self.source,
            source.channels(),
            calibrations,
            map.as_ref(),
            self.quantity,
        )?;
        Ok(signals)
    }

    pub(super) fn tracker(&self) -> Result<Option<Box<dyn TrackerRows>>, Failure> {
        let Some(text) = &self.tracker else {
            return Ok(None);
        };
        let map = parsed(self.tracker_map.as_deref())?;
        Ok(Some(match text.split_once(':') {
            Some(("file", path)) => Box::new(TableTracker::open(path.as_ref(), map.as_ref())?),
            Some(("lines", "-")) if std::io::stdin().is_terminal() => {
                let sentence = "--tracker lines:-: standard input is a terminal; pipe the tracker's lines into it";
                return Err(Failure::Usage(sentence.to_owned()));
            }
            Some(("lines", "-")) => {
                let input = BufReader::new(std::io::stdin());
                Box::new(LineTracker::new("standard input", input))
            }
            Some(("lines", path)) => {
                let file = std::fs::File::open(path);
                let file = file.map_err(|error| Failure::read(path.as_ref(), error))?;
                Box::new(LineTracker::new(path, BufReader::new(file)))
            }
            _ => {
                let sentence = format!("--tracker {text}: it is file:PATH, lines:PATH or lines:-");
                return Err(Failure::Usage(sentence));
            }
        }))
    }
}

fn parsed(map: Option<&str>) -> Result<Option<ColumnMap>, Failure> {
    Ok(map.map(str::parse).transpose()?)
}
