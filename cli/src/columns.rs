//! Columns for measures in text tables.

use htex_author::FeltError;
use htex_format::{By, Measure, Quality};

/// Minimum width of a column, characters; a correlation with its sign fits in it.
const WIDTH: usize = 6;

/// A column: a measure of the model's magnitudes or of rendered samples.
#[derive(Clone, Copy)]
pub(crate) struct Column {
    measure: Measure,
    by: By,
}

/// Returns the measures that have a column, in this order: measures of magnitudes, measures of
/// rendered samples, and measures that no asset stores.
pub(crate) fn columns(measures: impl IntoIterator<Item = Measure>) -> Vec<Column> {
    let all: Vec<Measure> = measures.into_iter().collect();
    let (stored, others): (Vec<_>, Vec<_>) = all.into_iter().partition(|m| m.row().stored);
    let played = stored.iter().map(|m| Column::new(*m, By::Samples));
    let own = |m: &Measure| Column::new(*m, By::Magnitude);
    let columns = stored.iter().map(own).chain(played).chain(others.iter().map(own));
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
    pub(crate) fn new(measure: Measure, by: By) -> Self {
        Self { measure, by }
    }

    /// Returns the value of this column for a fit.
    pub(crate) fn value(self, quality: Option<&Quality>, felt: Option<&FeltError>) -> Option<f64> {
        match (self.measure, self.by) {
            (Measure::Felt, _) => felt.map(|felt| felt.error_rms_db),
            (measure, By::Magnitude) => quality?.get(measure),
            (measure, By::Samples) => quality?.samples(measure),
        }
    }

    pub(crate) fn measure(self) -> Measure {
        self.measure
    }

    fn heading(self) -> &'static str {
        let row = self.measure.row();
        let heading = match self.by {
            By::Magnitude => row.column,
            By::Samples => row.played,
        };
        heading.unwrap_or_default()
    }

    fn width(self) -> usize {
        self.heading().len().max(WIDTH)
    }

    fn decimals(self) -> usize {
        self.measure.row().decimals
    }
}
