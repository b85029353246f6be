//! Reads files in which each channel has the same number of samples, in a fixed order: WAV, FLAC
//! and NPY.

use crate::error::Fault;
use crate::sheet::{Columns, Layout, Numbers, Sheet};
use crate::value_limit::ValueLimit;

/// An opened file with channels of equal lengths.
pub(crate) struct Samples<'a> {
    pub(crate) columns: Columns,
    /// The file's own sample rate, hertz.
    pub(crate) rate_hz: Option<f64>,
    pub(crate) layout: Layout,
    /// Number of samples in a channel according to the header, if it states one.
    pub(crate) frames: Option<u64>,
    pub(crate) limit: ValueLimit,
    pub(crate) order: Order,
    pub(crate) samples: Box<dyn Iterator<Item = Result<f64, Fault>> + 'a>,
}

/// The order of samples in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Order {
    /// The first sample of every channel, then the second sample of every channel, and so on.
    Interleaved,
    /// All samples of the first channel, then all samples of the second channel, and so on. The
    /// number is the length of each channel.
    Planar(u64),
}

impl Samples<'_> {
    /// Reads the wanted channels and skips the samples of all others.
    fn channels(&mut self, wanted: &[usize]) -> Result<Vec<Vec<f64>>, Fault> {
        if let Some(frames) = self.frames {
            let values = frames.saturating_mul(wanted.len() as u64);
            self.limit.check(values)?;
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
                self.limit.check(kept)?;
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

    fn layout(&self) -> Layout {
        self.layout
    }

    fn rate_hz(&self, _: &[usize]) -> Result<Option<f64>, Fault> {
        Ok(self.rate_hz)
    }

    fn numbers(&mut self, wanted: &[usize]) -> Result<Numbers, Fault> {
        Ok(Numbers { columns: self.channels(wanted)?, ..Numbers::default() })
    }
}

/// Returns channel names: `ch1` and so on.
pub(crate) fn channel_names(count: usize) -> Columns {
    let names = (1..=count).map(|number| format!("ch{number}"));
    Columns::new(names, None)
}
