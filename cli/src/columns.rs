//! Columns for measures in text tables.

use htex_author::FeltError;
use htex_format::{By, HeldOut, Measure, Quality};

/// Minimum width of a column, characters; a correlation with its sign fits in it.
const WIDTH: usize = 6;

/// A column of a table of errors.
#[derive(Clone, Copy)]
pub(crate) enum Column {
    /// The held-out error in units of the difference between two recordings.
    HeldOut,
    /// The held-out error in decibels.
    HeldOutDb,
    /// A measure of the model's magnitudes or of rendered samples.
    InSample(Measure, By),
}

/// What is known of a fit at a condition.
#[derive(Clone, Copy, Default)]
pub(crate) struct Errors<'a> {
    pub(crate) held_out: Option<HeldOut>,
    pub(crate) quality: Option<&'a Quality>,
    pub(crate) felt: Option<&'a FeltError>,
}

/// Returns the columns in this order: the held-out error, measures of magnitudes, measures of
/// rendered samples, and measures that no asset stores. Measures without a heading have no column.
pub(crate) fn columns(measures: impl IntoIterator<Item = Measure>) -> Vec<Column> {
    let all: Vec<Measure> = measures.into_iter().collect();
    let (stored, others): (Vec<_>, Vec<_>) = all.into_iter().partition(|m| m.row().stored);
    let played = stored.iter().map(|m| Column::InSample(*m, By::Samples));
    let own = |m: &Measure| Column::InSample(*m, By::Magnitude);
    let columns = [Column::HeldOut, Column::HeldOutDb].into_iter().chain(stored.iter().map(own));
    let columns = columns.chain(played).chain(others.iter().map(own));
    columns.filter(|column| !column.heading().is_empty()).collect()
}

/// Returns the headings, each after two spaces.
pub(crate) fn headings(columns: &[Column]) -> String {
    let heading = |column: &Column| format!("  {:>1$}", column.heading(), column.width());
    columns.iter().map(heading).collect()
}

/// Returns the cells of a row, each after two spaces.
pub(crate) fn cells(columns: &[Column], value: impl Fn(Column) -> Option<f64>) -> String {
    let cell = |column: &Column| {
        let value = value(*column);
        let text = value.map_or("-".to_owned(), |x| format!("{x:.*}", column.decimals()));
        format!("  {text:>0$}", column.width())
    };
    columns.iter().map(cell).collect()
}

impl Column {
    /// Returns the value of this column for a fit.
    pub(crate) fn value(self, errors: Errors<'_>) -> Option<f64> {
        match self {
            Self::HeldOut => errors.held_out?.held_out_error,
            Self::HeldOutDb => Some(errors.held_out?.held_out_error_db),
            Self::InSample(Measure::Felt, _) => errors.felt.map(|felt| felt.error_rms_db),
            Self::InSample(measure, By::Magnitude) => errors.quality?.get(measure),
            Self::InSample(measure, By::Samples) => errors.quality?.samples(measure),
        }
    }

    fn heading(self) -> &'static str {
        let heading = match self {
            Self::HeldOut => Some("held out"),
            Self::HeldOutDb => Some("held-out/dB"),
            Self::InSample(measure, By::Magnitude) => measure.row().column,
            Self::InSample(measure, By::Samples) => measure.row().played,
        };
        heading.unwrap_or_default()
    }

    fn width(self) -> usize {
        self.heading().len().max(WIDTH)
    }

    fn decimals(self) -> usize {
        match self {
            Self::HeldOut | Self::HeldOutDb => 2,
            Self::InSample(measure, _) => measure.row().decimals,
        }
    }
}
