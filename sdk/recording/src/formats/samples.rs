//! Files of samples: WAV, FLAC and NPY.

use htex_format::Quantity;

use crate::Recording;
use crate::columns::assemble::{Assembled, assemble};
use crate::formats::{Kind, with_sheet};
use crate::formats::{flac, npy, wav};
use crate::input::Opened;
use crate::sheet::{Columns, Numbers, Sheet};
use crate::value_limit::ValueLimit;
use crate::{ReadError, ReadOptions};

/// An opened file of channels of equal lengths.
pub(crate) struct Samples<'a> {
    pub(crate) columns: Columns,
    /// The file's own rate, hertz.
    pub(crate) rate_hz: Option<f64>,
    /// Whether samples are integers, which are read as fractions of full scale.
    pub(crate) are_integers: bool,
    /// Samples of a channel by the header, if it says.
    pub(crate) frames: Option<u64>,
    pub(crate) limit: ValueLimit,
    pub(crate) order: Order,
    pub(crate) samples: Box<dyn Iterator<Item = Result<f64, ReadError>> + 'a>,
}

/// The order of samples in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Order {
    /// A sample of each channel in turn.
    Interleaved,
    /// Channel after channel, each of this length.
    Planar(u64),
}

impl Samples<'_> {
    pub(crate) fn file(&self) -> &str {
        &self.columns.file
    }

    /// Refuses a given rate that is not the file's own.
    pub(crate) fn check_rate(&self, given_hz: Option<f64>) -> Result<(), ReadError> {
        match (self.rate_hz, given_hz) {
            (Some(own), Some(given)) if own != given => Err(ReadError::Option {
                file: self.file().to_owned(),
                option: "rate_hz",
                problem: format!(
                    "the file has {own} Hz, the given sample rate is {given} Hz; leave it out or correct the file's header"
                ),
            }),
            _ => Ok(()),
        }
    }

    /// Reads the wanted channels; the samples of others are passed over.
    fn channels(&mut self, wanted: &[usize]) -> Result<Vec<Vec<f64>>, ReadError> {
        let file = self.columns.file.clone();
        if let Some(frames) = self.frames {
            let values = frames.saturating_mul(wanted.len() as u64);
            self.limit.check(&file, values)?;
        }
        let width = self.columns.width();
        let mut place_of = vec![None; width];
        for (place, column) in wanted.iter().enumerate() {
            place_of[*column] = Some(place);
        }
        let mut channels = vec![Vec::new(); wanted.len()];
        let (mut column, mut row, mut kept) = (0, 0, 0);
        for sample in &mut self.samples {
            let sample = sample?;
            if let Some(place) = place_of.get(column).copied().flatten() {
                kept += 1;
                self.limit.check(&file, kept)?;
                channels[place].push(sample);
            }
            match self.order {
                Order::Interleaved => column = if column + 1 == width { 0 } else { column + 1 },
                Order::Planar(rows) => {
                    row += 1;
                    if row == rows {
                        (column, row) = (column + 1, 0);
                    }
                }
            }
        }
        Ok(channels)
    }
}

impl Sheet for Samples<'_> {
    fn columns(&self) -> &Columns {
        &self.columns
    }

    fn rate_hz(&self, _: &[usize]) -> Result<Option<f64>, ReadError> {
        Ok(self.rate_hz)
    }

    fn numbers(&mut self, wanted: &[usize]) -> Result<Numbers, ReadError> {
        Ok(Numbers {
            columns: self.channels(wanted)?,
            ..Numbers::default()
        })
    }
}

/// Returns the names of channels: `ch1` and so on.
pub(crate) fn channel_names(file: &str, count: usize) -> Columns {
    let names = (1..=count).map(|number| format!("ch{number}"));
    Columns::new(file, names, None)
}

/// Reads a recording without a map: files of samples by the order of their channels, others by the names of columns.
pub(crate) fn read(opened: Opened<'_>, options: &ReadOptions) -> Result<Assembled, ReadError> {
    let limit = options.value_limit();
    let samples = match Kind::of(&opened.path, &opened.front) {
        Kind::Wav => wav::open(opened, limit)?,
        Kind::Flac => flac::open(opened, limit)?,
        Kind::Npy => npy::open(opened, limit)?,
        _ => return with_sheet(opened, options, |sheet| assemble(sheet, options)),
    };
    Ok(Assembled {
        recording: from_samples(samples, options)?,
        time_s: None,
    })
}

/// Assigns channels. Of a force: one is lateral, two are lateral x and y, three are x, y and normal. Of other
/// quantities the channels are axes. Scales to the quantity's unit.
fn from_samples(mut samples: Samples<'_>, options: &ReadOptions) -> Result<Recording, ReadError> {
    let width = samples.columns.width();
    let file = samples.file().to_owned();
    if !(1..=3).contains(&width) {
        return Err(ReadError::Columns {
            file,
            problem: format!(
                "{width} channels; without a column map they are 1 (lateral), 2 (lateral x, y), 3 (x, y, normal), or up to 3 axes \
                 of a motion; map those of the recording, as in lateral=#1:SCALE"
            ),
            columns: samples.columns.list(),
        });
    }
    samples.check_rate(options.rate_hz)?;
    let Some(rate_hz) = samples.rate_hz.or(options.rate_hz) else {
        return Err(ReadError::NoRate { file });
    };
    let all: Vec<usize> = (0..width).collect();
    let mut channels = samples.channels(&all)?;
    let scale = options.scale.unwrap_or(1.0);
    if scale != 1.0 {
        channels
            .iter_mut()
            .flatten()
            .for_each(|value| *value *= scale);
    }
    let normal = match (options.quantity, &channels[..]) {
        (Quantity::LateralForce, [_, _, _]) => channels.pop(),
        (Quantity::NormalForce, [axis]) => Some(axis.clone()),
        _ => None,
    };
    let recording = Recording::of(options.quantity, &file, rate_hz, channels);
    let mut recording = match normal {
        None => recording,
        Some(normal) => recording.and_then(|recording| recording.with_normal(normal)),
    }
    .map_err(|source| ReadError::Recording { file, source })?;
    if options.scale.is_none() {
        let warning = assumption(samples.are_integers, options.quantity);
        recording.warnings.push(warning);
    }
    Ok(recording)
}

/// Returns the warning about samples without a scale.
fn assumption(are_integers: bool, quantity: Quantity) -> String {
    let unit = quantity.unit();
    if are_integers {
        format!("Integer full scale is assumed to be 1 {unit}; give the scale if it is not.")
    } else {
        format!("Samples are assumed to be in {unit}; give the scale if they are not.")
    }
}
