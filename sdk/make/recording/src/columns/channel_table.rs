//! All channels of a file with their names, but without roles.

use std::path::Path;

use htex_format::Quantity;

use crate::columns::clock::{self, ReadNotices};
use crate::columns::map::Role;
use crate::columns::names::{Unit, recognise};
use crate::error::{Fault, ReadError};
use crate::formats;
use crate::input::{InputFile, file_name};
use crate::options::ReadOptions;
use crate::sheet::{Sheet, even_numbers};

/// The channels of a recording, with the same values as in the file. Channels in this table have no
/// roles and are not scaled.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ChannelTable {
    /// Sample rate, hertz.
    pub rate_hz: f64,
    /// Times of the samples, seconds, ascending. `None` if the file has no time column.
    pub time_s: Option<Vec<f64>>,
    /// Names of the channels. A channel without a name is called by its number, such as `#3`.
    pub names: Vec<String>,
    /// The samples of each channel. All channels have the same number of samples, at least two. All
    /// samples are finite.
    pub channels: Vec<Vec<f64>>,
}

/// Reads all channels of a file. The sample rate is taken from the options. If the options have no
/// rate, it is computed from the time column. If there is also no time column, the rate that the
/// file states is used. The time column is not among the channels.
///
/// # Errors
/// Returns the errors of [`read_recording`](crate::read_recording).
pub fn read_channels(path: &Path, options: &ReadOptions) -> Result<ChannelTable, ReadError> {
    let file = file_name(path);
    let read = || {
        options.check()?;
        let mut sheet = formats::open(InputFile::file(path)?, options)?;
        table(&file, &mut *sheet, options)
    };
    read().map_err(|fault: Fault| fault.in_file(&file))
}

fn table(file: &str, sheet: &mut dyn Sheet, options: &ReadOptions) -> Result<ChannelTable, Fault> {
    let width = sheet.columns().width();
    let time = time_column(sheet);
    let all: Vec<usize> = (0..width).collect();
    let mut columns = even_numbers(sheet, &all)?.columns;
    let mut names: Vec<String> = all.iter().map(|c| sheet.columns().name(*c)).collect();
    let time_s = time.map(|(column, scale)| {
        names.remove(column);
        let times = columns.remove(column);
        times.iter().map(|t| t * scale).collect::<Vec<f64>>()
    });
    let own_hz = match &time_s {
        Some(_) => None,
        None => sheet.rate_hz(&all)?,
    };
    let mut noticed = ReadNotices::default();
    let given_hz = clock::given(own_hz, options.rate_hz, &mut noticed);
    let rate_hz = clock::rate(file, sheet, time_s.as_deref(), given_hz, &mut noticed)?;
    if names.is_empty() {
        let problem = "there is no channel beside the time".to_owned();
        return Err(sheet.columns().refuse(problem).into());
    }
    Ok(ChannelTable { rate_hz, time_s, names, channels: columns })
}

/// Returns the first column with the name of a time, and its factor to seconds.
fn time_column(sheet: &dyn Sheet) -> Option<(usize, f64)> {
    let columns = sheet.columns();
    (0..columns.width()).find_map(|column| {
        match recognise(columns.last_part(column), Quantity::LateralForce)? {
            (Role::Time, Unit::Scale(scale)) => Some((column, scale)),
            (Role::Time, _) => Some((column, 1.0)),
            _ => None,
        }
    })
}
