//! Arguments for the channels of a source and for a tracker, shared by the commands that record.

use std::collections::BTreeMap;
use std::io::{BufReader, IsTerminal};
use std::path::PathBuf;

use clap::Args;
use htex_author::recording::ColumnMap;
use htex_base::files::AtFile;
use htex_device::Input;
use htex_format::{Quantity, UnknownName};
use htex_lab::record::{Calibration, Format, LineTracker, Signals, TableTracker, TrackerRows};

use crate::failure::{Failure, Result};

/// Options for the signals of a source, and for a separate tracker of the finger's motion.
#[derive(Args)]
#[command(next_help_heading = "Source")]
pub(crate) struct InputArgs {
    /// What each channel measures, and its scale, written as for `htex fit`, e.g.
    /// lateral_x=fx1+fx2,normal=-fz*0.31. By default, htex recognises the channels by their names
    #[arg(long, value_name = "MAP")]
    pub(crate) map: Option<String>,

    /// File with the calibration of a six-axis force sensor on the first six channels. The channels
    /// are then called fx, fy, fz, tx, ty, tz. The file has six rows of six numbers (N and N m per
    /// volt), as CSV or as `matrix` in TOML. Give a second file for a second sensor on the next six
    /// channels. The channels are then called fx1, …, tz1 and fx2, …, tz2
    #[arg(long, value_name = "FILE")]
    calibration: Vec<PathBuf>,

    /// Quantity of the texture's signal: lateral-force, normal-force, acceleration, velocity,
    /// displacement [default: lateral-force]
    #[arg(long, value_name = "NAME", value_parser = quantity)]
    quantity: Option<Quantity>,

    /// Source of the finger's motion: a file to replay (file:track.csv), or lines `x_mm y_mm` from
    /// a pipe or port (lines:/dev/ttyACM0) or from standard input (lines:-)
    #[arg(long, value_name = "NAME:TARGET")]
    tracker: Option<String>,

    /// Roles of the columns in the tracker's file, as ROLE=COLUMN or ROLE=COLUMN:SCALE, e.g.
    /// time=stamp_ms:0.001,x=#2. COLUMN is a name or a number (#2)
    #[arg(long, value_name = "MAP", requires = "tracker")]
    tracker_map: Option<String>,

    /// Format in which to store the recordings [default: csv; for the trials of a study npy, which
    /// takes a third of the space of csv]
    #[arg(long, value_enum)]
    pub(crate) format: Option<Format>,
}

/// Returns the settings of a source. With `is_fast`, files are replayed without waiting.
pub(crate) fn paced(
    source: &str,
    mut given: BTreeMap<String, String>,
    is_fast: bool,
) -> BTreeMap<String, String> {
    if is_fast && source.starts_with("file:") {
        given.insert("pace".to_owned(), "fast".to_owned());
    }
    given
}

impl InputArgs {
    pub(crate) fn quantity(&self) -> Quantity {
        self.quantity.unwrap_or_default()
    }

    /// Whether any of these arguments was given.
    pub(crate) fn is_given(&self) -> bool {
        self.map.is_some()
            || !self.calibration.is_empty()
            || self.quantity.is_some()
            || self.tracker.is_some()
            || self.format.is_some()
    }

    /// Whether the lines of a tracker come from standard input.
    pub(crate) fn tracks_stdin(&self) -> bool {
        self.tracker.as_deref() == Some("lines:-")
    }

    pub(crate) fn signals(&self, name: &str, source: &dyn Input) -> Result<Signals> {
        let map = parsed(self.map.as_deref())?;
        let calibrations = self
            .calibration
            .iter()
            .map(|path| Calibration::read(path))
            .collect::<Result<_, _>>()?;
        let channels = &source.stream().channels;
        Ok(Signals::new(name, channels, calibrations, map.as_ref(), self.quantity())?)
    }

    pub(crate) fn tracker(&self) -> Result<Option<Box<dyn TrackerRows>>> {
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
                // Waits for the writer of a named pipe, which `open_regular` would refuse.
                let file = std::fs::File::open(path).reading(path)?;
                Box::new(LineTracker::new(path, BufReader::new(file)))
            }
            _ => {
                let sentence = format!("--tracker {text}: it is file:PATH, lines:PATH or lines:-");
                return Err(Failure::Usage(sentence));
            }
        }))
    }
}

fn parsed(map: Option<&str>) -> Result<Option<ColumnMap>> {
    Ok(map.map(str::parse).transpose()?)
}

/// Parses a quantity that can be recorded, by its name on the command line.
fn quantity(name: &str) -> Result<Quantity, String> {
    name.replace('-', "_").parse().map_err(|unknown: UnknownName| {
        format!("the quantities are {}", unknown.known.join(", ").replace('_', "-"))
    })
}
