//! Reads named arrays of one or two dimensions as columns. The readers of MATLAB and HDF5 files use
//! this module.

use crate::error::{Fault, ReadProblem};
use crate::sheet::Columns;
use crate::value_limit::ValueLimit;

/// Largest number of channels in an array; a picture or a table of results has more.
pub(crate) const MOST_CHANNELS: u64 = 256;
/// Largest number of columns in a file.
pub(crate) const MOST_COLUMNS: usize = 65_536;
/// Names (in lower case) of scalars and attributes that state the sample rate in hertz.
const RATES: [&str; 9] = [
    "fs",
    "fs_hz",
    "rate",
    "rate_hz",
    "sample_rate",
    "sample_rate_hz",
    "samplerate",
    "sampling_rate",
    "sampling_rate_hz",
];

/// Whether a scalar or attribute with this name states the sample rate.
pub(crate) fn is_rate_name(name: &str) -> bool {
    RATES.contains(&name.to_ascii_lowercase().as_str())
}

/// The shape of an array that is read as columns. The longer side is time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Shape {
    pub(crate) samples: u64,
    pub(crate) channels: u64,
    /// Whether a channel's samples are next to each other in the file.
    pub(crate) is_planar: bool,
}

impl Shape {
    /// Returns the shape of an array of `outer` blocks, each with `inner` values that are next to
    /// each other in the file. `None` for an empty array, a single value, or more than
    /// [`MOST_CHANNELS`] channels.
    pub(crate) fn of_array(outer: u64, inner: u64) -> Option<Self> {
        let is_planar = inner >= outer;
        let (channels, samples) = if is_planar { (outer, inner) } else { (inner, outer) };
        let is_signal = samples > 1 && (1..=MOST_CHANNELS).contains(&channels);
        is_signal.then_some(Self { samples, channels, is_planar })
    }

    /// Returns the channel and the sample of a value, given its index in the file.
    pub(crate) fn place(self, index: u64) -> (u64, u64) {
        if self.is_planar {
            (index / self.samples, index % self.samples)
        } else {
            (index % self.channels, index / self.channels)
        }
    }
}

/// The arrays of a file, each with one or more columns.
#[derive(Debug)]
pub(crate) struct Arrays<T> {
    arrays: Vec<(Shape, T)>,
    /// For each column, its array and its channel there.
    columns: Vec<(usize, u64)>,
    names: Vec<String>,
    /// Names and values of the scalars that state a rate.
    rates: Vec<(String, f64)>,
    separator: char,
}

impl<T> Arrays<T> {
    pub(crate) fn new(separator: char) -> Self {
        Self {
            arrays: Vec::new(),
            columns: Vec::new(),
            names: Vec::new(),
            rates: Vec::new(),
            separator,
        }
    }

    /// Adds an array. A single channel gets the array's name; several channels get `name#1` and so
    /// on. Returns false if there are too many columns.
    #[must_use]
    pub(crate) fn add(&mut self, name: &str, shape: Shape, array: T) -> bool {
        for channel in 0..shape.channels {
            self.columns.push((self.arrays.len(), channel));
            self.names.push(match shape.channels {
                1 => name.to_owned(),
                _ => format!("{name}#{}", channel + 1),
            });
        }
        self.arrays.push((shape, array));
        self.columns.len() <= MOST_COLUMNS
    }

    /// Adds a scalar, if it has one of the names for a sample rate.
    pub(crate) fn add_scalar(&mut self, name: &str, value: f64) {
        let last = name.rsplit(self.separator).next().unwrap_or(name);
        if is_rate_name(last) && value.is_finite() && value > 0.0 && self.rates.len() < MOST_COLUMNS
        {
            self.rates.push((name.to_owned(), value));
        }
    }

    pub(crate) fn columns(&self) -> Columns {
        Columns::new(self.names.iter().cloned(), Some(self.separator))
    }

    /// Returns the rate that is stated nearest to the wanted columns: in their own group or array
    /// or, if there is none, in an enclosing one. Different rates at the same distance are an
    /// error.
    pub(crate) fn rate_hz(
        &self,
        columns: &Columns,
        wanted: &[usize],
    ) -> Result<Option<f64>, Fault> {
        let Some(first) = wanted.first() else {
            return Ok(None);
        };
        let mut around = array_name(&columns.name(*first)).to_owned();
        loop {
            let group =
                |name: &str| name.rfind(self.separator).map_or("", |at| &name[..at]).to_owned();
            let mut here = self.rates.iter().filter(|(name, _)| group(name) == around);
            if let Some((name, rate_hz)) = here.next() {
                return match here.find(|(_, other)| other != rate_hz) {
                    None => Ok(Some(*rate_hz)),
                    Some((other, _)) => Err(ReadProblem::Invalid(format!(
                        "it states another sample rate than {}; give the rate of the recording",
                        htex_base::finding::plain(name)
                    ))
                    .at_place(htex_base::finding::plain(other))),
                };
            }
            if around.is_empty() {
                return Ok(None);
            }
            around = group(&around);
        }
    }

    /// Reads the wanted columns, each array once. `read` reads an array and passes on each value
    /// with its index in the file.
    pub(crate) fn numbers(
        &self,
        limit: ValueLimit,
        wanted: &[usize],
        mut read: impl FnMut(&T, Shape, &mut dyn FnMut(u64, f64)) -> Result<(), Fault>,
    ) -> Result<Vec<Vec<f64>>, Fault> {
        let of = |column: &usize| self.columns.get(*column).copied().unwrap_or((0, 0));
        let samples = |column| self.arrays.get(of(column).0).map_or(0, |(shape, _)| shape.samples);
        limit.check(wanted.iter().map(samples).fold(0, u64::saturating_add))?;
        let mut numbers = vec![Vec::new(); wanted.len()];
        for (index, (shape, array)) in self.arrays.iter().enumerate() {
            let mut slots = vec![None; shape.channels as usize];
            for (slot, (own, channel)) in wanted.iter().map(of).enumerate() {
                if own == index {
                    slots[channel as usize] = Some(slot);
                }
            }
            if slots.iter().all(Option::is_none) {
                continue;
            }
            read(array, *shape, &mut |at, value| {
                let (channel, _) = shape.place(at);
                if let Some(slot) = slots[channel as usize] {
                    numbers[slot].push(value);
                }
            })?;
        }
        Ok(numbers)
    }
}

/// Returns the name of the array that a column belongs to: `data` for `data#2`.
fn array_name(column: &str) -> &str {
    match column.rsplit_once('#') {
        Some((name, number)) if number.bytes().all(|byte| byte.is_ascii_digit()) => name,
        _ => column,
    }
}
